"""Makes the places of a table on a Dask cluster.

The program starts this package, says on standard input what is missing, and reads on standard output how far it is. Modules in the order of
use: ``worker``, which runs on the workers, and ``client``, which sends the steps there and brings what they made into the store.
"""

__version__ = "0.1.0"
