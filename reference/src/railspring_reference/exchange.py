"""The exchange folder: what the tool hands over and what goes back.

``exchange.json`` names the bodies with their mesh files, materials and held
nodes, the contact surfaces and the load steps. The given forces are point data
of the VTU files. Lengths m, forces N, moduli Pa.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .body import Body, Floats, Ints, Material, read_mesh

FORCE = "force (N)"
"""Point data with the given nodal forces."""
FORMAT = 3
"""Version of the exchange that this package reads."""


@dataclass(frozen=True)
class Grid:
    """Tensor grid of the nodes of a contact surface: rows along the profile, columns along the track."""

    nodes: Ints
    """Mesh node of every grid point."""
    track: Floats
    """Position of the columns: x (rail, m) or angle from straight down (wheel, rad)."""


@dataclass(frozen=True)
class Side:
    """The contact surface of one body."""

    grid: Grid
    curve: Floats
    """Points (y, z) of the smooth profile curve, densely along it."""
    origin: Floats
    """World position (y, z) of the curve's frame when the bodies just touch."""
    radius: float
    """Radius of the surface of revolution at the curve's z = 0; 0 for the rail."""


class Exchange:
    """An exchange folder that the tool has written."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.data: dict[str, Any] = json.loads((folder / "exchange.json").read_text(encoding="utf-8"))
        if self.data.get("format") != FORMAT:
            raise ValueError(
                f"{folder / 'exchange.json'}: format {self.data.get('format')!r}: expected {FORMAT}; "
                "use the reference package that came with the tool"
            )

    def body(self, name: str, variant: str = "bodies") -> Body:
        """A body with its supports."""
        entry = self.data[variant][name]
        materials = [Material(constants["young_pa"], constants["poisson"]) for constants in entry["materials"]]
        mesh = read_mesh(self.folder / entry["mesh"])
        held, groups = (np.asarray(entry[name], dtype=np.int64) for name in ("held", "groups"))
        return Body(mesh, materials, held, entry["element"], groups)

    def given_forces(self, name: str) -> Floats:
        """The given nodal forces of a body, one row a node."""
        mesh = read_mesh(self.folder / self.data["bodies"][name]["mesh"])
        return np.asarray(mesh.point_data[FORCE], dtype=np.float64)

    def columns(self, name: str) -> list[tuple[int, int]]:
        """Node and direction of the unit forces whose displacements are asked for."""
        return [(int(node), int(axis)) for node, axis in self.data["bodies"][name]["compliance_columns"]]

    def side(self, name: str, variant: str = "bodies") -> Side:
        """The contact surface of a body."""
        entry = self.data[variant][name]["surface"]
        track = np.asarray(entry["along_track"])
        nodes = np.asarray(entry["nodes"], dtype=np.int64).reshape(-1, len(track))
        return Side(
            Grid(nodes, track), np.asarray(entry["curve"]), np.asarray(entry["origin"]), float(entry["radius"])
        )

    @property
    def loads(self) -> Floats:
        """Vertical loads in the order in which they are applied, N."""
        return np.asarray(self.data["contact"]["loads_n"])

    @property
    def preloads(self) -> Floats:
        """Vertical loads under which the horizontal stiffness is asked for, ascending, N."""
        return np.asarray(self.data["contact"]["preloads_n"])

    @property
    def friction(self) -> float:
        """Coulomb friction coefficient."""
        return float(self.data["contact"]["friction"])
