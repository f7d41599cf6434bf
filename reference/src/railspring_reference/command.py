"""What both commands of this package share: progress, where a result comes from, and how they end."""

import datetime
import hashlib
import platform
import sys
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from . import __version__
from .factor import solver
from .iteration import BeyondCandidates, NotConverged

PACKAGES = ("scikit-fem", "meshio", "numpy", "scipy")
"""Packages whose versions belong to a result."""


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
