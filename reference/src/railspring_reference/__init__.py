"""An independent solution of railspring's solids and contact on scikit-fem.

Shares no code with the tool. Meshes, materials, supports, loads and the two
profile curves come in through an exchange folder (:mod:`.exchange`); results
go back through it. Units are SI throughout.

Modules in the order of use: ``ordering``, ``factor``, ``body``, ``exchange``,
``surface``, ``contact``, ``run``; and ``mesh_in``, which reads mesh files for the tool.
"""

__version__ = "0.2.0"
