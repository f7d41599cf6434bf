"""The whole reference run: exchange folder in, ``reference.json`` and fields out."""

import datetime
import hashlib
import json
import platform
import sys
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from . import __version__
from .body import Body
from .contact import Carrier, Contact
from .exchange import Exchange
from .factor import solver
from .iteration import BeyondCandidates, NotConverged

FIRST_REACH = 0.08e-3
"""First guess of the largest gap of a candidate at touching, m."""
PACKAGES = ("scikit-fem", "meshio", "numpy", "scipy")
BODIES = ("rail", "wheel")


def progress(stage: str, done: int, total: int) -> None:
    """One line for the tool: stage, pieces done, pieces in all."""
    print(f"PROGRESS\t{stage}\t{done}\t{total}", flush=True)


def input_hash(folder: Path) -> str:
    """SHA-256 of the exchange's input files, in the order of their names."""
    digest = hashlib.sha256()
    for path in sorted([*folder.glob("*.vtu"), folder / "exchange.json"]):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


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
    exchange: Exchange, bodies: dict[str, Body], case: str, tangential: bool = False, carrier: Carrier = "rail"
) -> Contact:
    """The contact problem with enough candidates for the largest load."""
    variant = "second_order" if case == "second_order" else "bodies"
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


def provenance(folder: Path, begun: float) -> dict[str, Any]:
    """Where a result comes from; ``begun``: when it began, s of the performance counter."""
    return {
        "package": f"railspring-reference {__version__}",
        "python": platform.python_version(),
        "packages": {name: version(name) for name in PACKAGES},
        "solver": solver(),
        "input_sha256": input_hash(folder),
        "date_utc": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "seconds": time.perf_counter() - begun,
    }


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
        rows = load_curve(exchange, contact, label)
        result["contact"][case] = {
            "rows": rows,
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
    if "second_order" in cases:
        started = time.perf_counter()
        higher = {name: exchange.body(name, "second_order") for name in BODIES}
        contact = condense(exchange, higher, "second_order", exchange.friction > 0.0)
        sticking = contact.with_friction(exchange.friction) if exchange.friction > 0.0 else None
        answer("second_order", contact, started, higher, sticking)
    result["provenance"] = provenance(folder, begun)
    (folder / "reference.json").write_text(json.dumps(result, indent=1), encoding="utf-8")
    return result


def main(arguments: list[str] | None = None) -> int:
    """Entry point with the exchange folder."""
    return ended("railspring_reference", run, sys.argv[1:] if arguments is None else arguments)


def ended(module: str, answer: Callable[[Path], object], arguments: list[str]) -> int:
    """Answers an exchange folder, and the exit code: 2 for input that cannot be used and 3 where the numerics do not
    reach an answer. An iteration that stops has a line for the tool: what, iterations, residual, points."""
    if len(arguments) != 1:
        print(f"usage: python -m {module} EXCHANGE_FOLDER", file=sys.stderr)
        return 2
    try:
        answer(Path(arguments[0]))
    except NotConverged as stop:
        print(f"STOPPED\t{stop.what}\t{stop.iterations}\t{stop.residual}\t{stop.points}", flush=True)
        cause, code = f"{stop}", 3
    except (BeyondCandidates, np.linalg.LinAlgError, RuntimeError, ArithmeticError, MemoryError) as stop:
        cause, code = f"{type(stop).__name__}: {stop}", 3
    except (ValueError, OSError, KeyError) as stop:
        cause, code = f"{type(stop).__name__}: {stop}", 2
    else:
        return 0
    print(f"error: {cause}", file=sys.stderr)
    return code
