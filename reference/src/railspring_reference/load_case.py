"""The load case of an exchange folder: ``exchange.json`` in, ``in_time.json`` out.

``exchange.json`` has under ``in_time`` the load case, the densities (kg/m3) and the damping of the bodies (s), and how
many steps of the bodies a time step has, in each of the runs that are asked for.
"""

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from .command import ended, progress, provenance
from .dynamics import Moving, Suspended
from .exchange import Exchange
from .in_time import Case, Harmonic, Row, run
from .moving_surfaces import Facing, Surface


def harmonic(asked: dict[str, float]) -> Harmonic:
    """A force of the exchange."""
    return Harmonic(asked["mean_n"], asked["amplitude_n"], asked["frequency_hz"], asked["phase_rad"])


def answer(folder: Path) -> dict[str, Any]:
    """Runs the load case with every number of steps that is asked for, and writes ``in_time.json``."""
    begun = time.perf_counter()
    exchange = Exchange(folder)
    asked = exchange.data["in_time"]
    case = Case(
        asked["steps"], asked["time_step_s"], asked["friction"], asked["gravity_m_per_s2"],
        harmonic(asked["vertical_force"]), harmonic(asked["lateral_force"]),
    )
    suspended = Suspended(
        asked["suspended_mass_kg"], asked["suspension_stiffness_n_per_m"], asked["suspension_damping_n_s_per_m"]
    )
    names = ("wheel", "rail")
    bodies = {name: exchange.body(name) for name in names}
    facing = Facing(*(Surface(bodies[name], exchange.side(name)) for name in names))
    runs, unknowns = [], 0
    for inner in asked["inner_steps"]:
        label = f"{inner} steps in each time step"
        progress(label, 0, case.steps)
        wheel, rail = (
            Moving(
                bodies[name], np.asarray(asked["densities_kg_per_m3"][name]), asked["damping_s"],
                facing.wheel.nodes if name == "wheel" else facing.rail.nodes, case.time_step / inner,
                suspended if name == "wheel" else None,
            )
            for name in names
        )
        rows = run((wheel, rail), facing, case, inner, lambda done, of=label: progress(of, done, case.steps))
        runs.append({"inner_steps": inner, **columns(rows)})
        unknowns = wheel.unknowns + rail.unknowns
    result = {
        "runs": runs,
        "degrees_of_freedom": unknowns,
        "provenance": provenance(folder, begun),
    }
    (folder / "in_time.json").write_text(json.dumps(result, indent=1), encoding="utf-8")
    return result


def columns(rows: list[Row]) -> dict[str, list[float]]:
    """Rows by quantity."""
    return {
        "time_s": [row.time for row in rows],
        "vertical_n": [row.vertical for row in rows],
        "lateral_n": [row.lateral for row in rows],
        "hub_y_m": [row.hub[0] for row in rows],
        "hub_z_m": [row.hub[1] for row in rows],
    }


if __name__ == "__main__":
    sys.exit(ended("railspring_reference.load_case", answer, sys.argv[1:]))
