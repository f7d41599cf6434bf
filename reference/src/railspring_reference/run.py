"""The whole reference run: exchange folder in, ``reference.json`` and fields out."""

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from .body import Body
from .command import ended, progress, provenance
from .contact import Carrier, Contact
from .exchange import Exchange
from .iteration import BeyondCandidates

FIRST_REACH = 0.08e-3
"""First guess of the largest gap of a candidate at touching, m."""
BODIES = ("rail", "wheel")


def elastic(exchange: Exchange, name: str, body: Body) -> dict[str, Any]:
    """Displacements under the given forces (as raw little-endian doubles) and compliance columns."""
    columns = exchange.columns(name)
    rhs = np.zeros((body.degrees_of_freedom, 1 + len(columns)))
    rhs[:, 0] = body.from_nodes(exchange.given_forces(name))
    for j, (node, axis) in enumerate(columns):
        rhs[body.nodal_dofs[axis, node], 1 + j] = 1.0
    solution = body.solve(rhs, lambda done, of: progress(f"{name}, given forces", done, of))
    file = f"reference_{name}.f64"
    (exchange.folder / file).write_bytes(body.at_nodes(solution[:, 0]).astype("<f8").tobytes())
    nodes = np.asarray(exchange.data["bodies"][name]["surface"]["nodes"], dtype=np.int64)
    return {
        "displacement_file": file,
        "compliance_columns": [body.at_nodes(solution[:, 1 + j])[nodes].ravel().tolist() for j in range(len(columns))],
        "smallest_jacobian": body.smallest_jacobian,
        "degrees_of_freedom": body.degrees_of_freedom,
    }


def condense(
    exchange: Exchange,
    bodies: dict[str, Body],
    case: str,
    tangential: bool = False,
    carrier: Carrier = "rail",
    variant: str = "bodies",
) -> Contact:
    """The contact problem with enough candidates for the largest load."""
    sides = (exchange.side("wheel", variant), exchange.side("rail", variant))
    reach = FIRST_REACH
    for _ in range(3):
        contact = Contact(
            bodies["wheel"], bodies["rail"], sides, tangential, reach,
            lambda stage, done, of: progress(f"{case.replace('_', ' ')}: {stage}", done, of), carrier,
        )
        try:
            contact.press(float(exchange.loads[-1]), None)
        except BeyondCandidates:
            reach *= 1.5
        else:
            return contact
    raise BeyondCandidates(f"{case.replace('_', ' ')}: candidates up to a gap of {reach / 1.5:.2g} m are not enough")


def load_curve(exchange: Exchange, contact: Contact, label: str) -> list[dict[str, float]]:
    """Hub displacement, tangent and patch under all loads."""
    rows = []
    state = None
    for k, load in enumerate(exchange.loads):
        state = contact.press(float(load), state)
        rows.append(
            {
                "load_n": state.load,
                "hub_m": state.lowering,
                "tangent_n_per_m": contact.tangent(state),
                "area_m2": contact.contact_area(state),
                "peak_pressure_pa": float((state.normal / contact.area).max()),
            }
        )
        progress(f"{label}: loads", k + 1, len(exchange.loads))
    return rows


def horizontal(exchange: Exchange, contact: Contact, label: str) -> list[dict[str, float]]:
    """Horizontal stiffness under all preloads, with friction."""
    rows: list[dict[str, float]] = []
    state = None
    for k, load in enumerate(exchange.preloads):
        state = contact.press(float(load), state)
        rows.append({"load_n": state.load, "stiffness_n_per_m": contact.horizontal_stiffness(state)})
        progress(f"{label}: horizontal stiffness", k + 1, len(exchange.preloads))
    return rows


def run(folder: Path) -> dict[str, Any]:
    """Solves everything the exchange asks for and writes ``reference.json``."""
    begun = time.perf_counter()
    exchange = Exchange(folder)
    result: dict[str, Any] = {"format": 1, "elastic": {}, "contact": {}}
    bodies = {name: exchange.body(name) for name in BODIES}
    for name, body in bodies.items():
        progress(f"{name}, assembly", 0, 1)
        result["elastic"][name] = elastic(exchange, name, body)
    cases = exchange.data["contact"]["cases"]
    friction = exchange.friction if "same_mesh_friction" in cases else 0.0

    def answer(
        case: str, contact: Contact, begun: float, bodies: dict[str, Body], sticking: Contact | None = None
    ) -> None:
        label = case.replace("_", " ")
        result["contact"][case] = {
            "rows": load_curve(exchange, contact, label),
            "horizontal": horizontal(exchange, sticking, label) if sticking else [],
            "multipliers": contact.count,
            "degrees_of_freedom": sum(body.degrees_of_freedom for body in bodies.values()),
            "seconds": time.perf_counter() - begun,
        }

    if "same_mesh" in cases or friction > 0.0:
        contact = condense(exchange, bodies, "same_mesh", friction > 0.0)
        answer("same_mesh", contact, begun, bodies)
        if friction > 0.0:
            contact = contact.with_friction(friction)
            answer("same_mesh_friction", contact, begun, bodies, contact)
    if "other_surface" in cases:
        started = time.perf_counter()
        answer("other_surface", condense(exchange, bodies, "other_surface", carrier="wheel"), started, bodies)
    del bodies
    case = "second_order"
    if case in cases:
        started = time.perf_counter()
        higher = {name: exchange.body(name, case) for name in BODIES}
        sticks = len(exchange.preloads) > 0
        contact = condense(exchange, higher, case, sticks, variant=case)
        answer(case, contact, started, higher, contact.with_friction(exchange.friction) if sticks else None)
    result["provenance"] = provenance(folder, begun)
    (folder / "reference.json").write_text(json.dumps(result, indent=1), encoding="utf-8")
    return result


def main(arguments: list[str] | None = None) -> int:
    """Entry point with the exchange folder."""
    return ended("railspring_reference", run, sys.argv[1:] if arguments is None else arguments)
