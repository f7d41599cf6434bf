"""The program, started from Python: it makes what `results` reads.

It is that of this package, unless `RAILSPRING` or `program=` names another one. Keys of a study are given as `keys={"contact.friction": 0.3}`.
"""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ._native import Element
from .results import AnyPath, Calibration, Study, Table


class ProgramError(RuntimeError):
    """The program has refused its input (`code` 2), its numerics did not converge (3), or it was stopped (130)."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__(message)
        self.code = code


def _program(program: AnyPath | None) -> list[str]:
    wanted = os.fspath(program or os.environ.get("RAILSPRING") or "")
    if not wanted:
        return [sys.executable, "-P", "-m", "railspring"]  # -P: not one of the working folder
    found = shutil.which(wanted)
    if found is None:
        raise FileNotFoundError(f"{wanted} is not there: leave RAILSPRING and program= out, and the program is that of this package")
    return [found]


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else json.dumps(value)


def _started(
    arguments: list[str], program: AnyPath | None, keys: Mapping[str, Any] | None, cache: AnyPath | None
) -> dict[str, Any]:
    """Runs the program; what it says as JSON. A limit of the study or of a table that does not hold (code 1) is a result."""
    command = [*_program(program), *arguments, "--json"]
    for key, value in (keys or {}).items():
        command += ["--set", f"{key}={_value(value)}"]
    if cache is not None:
        command += ["--cache", os.fspath(cache)]
    done = subprocess.run(command, capture_output=True, stdin=subprocess.DEVNULL, encoding="utf-8", errors="replace")
    if done.returncode not in (0, 1):
        raise ProgramError(done.returncode, _errors(done.stderr) or _errors(done.stdout) or f"exit code {done.returncode}")
    return dict(json.loads(done.stdout))


def _errors(text: str) -> str:
    said = [line for line in text.splitlines() if line.strip()]
    first = next((number for number, line in enumerate(said) if line.startswith("error")), max(len(said) - 1, 0))
    return "\n".join(said[first:])


def _study(study: Study | AnyPath) -> str:
    return os.fspath(study.path if isinstance(study, Study) else study)


def fit(
    wheel: AnyPath,
    rail: AnyPath,
    output: AnyPath,
    *,
    keys: Mapping[str, Any] | None = None,
    cache: AnyPath | None = None,
    program: AnyPath | None = None,
) -> Calibration:
    """The springs of a wheel on a rail: names of standards, or files of measured profiles. Their report and their study are left in `output`."""
    _started(["fit", os.fspath(wheel), os.fspath(rail), "-o", os.fspath(output)], program, keys, cache)
    return Calibration.read(output)


def calibrate(
    study: Study | AnyPath,
    output: AnyPath,
    *,
    keys: Mapping[str, Any] | None = None,
    cache: AnyPath | None = None,
    program: AnyPath | None = None,
) -> Calibration:
    """The springs of a study."""
    _started(["calibrate", _study(study), "-o", os.fspath(output)], program, keys, cache)
    return Calibration.read(output)


def element(
    study: Study | AnyPath,
    output: AnyPath,
    *,
    results: AnyPath | None = None,
    fmu: AnyPath | None = None,
    keys: Mapping[str, Any] | None = None,
    cache: AnyPath | None = None,
    program: AnyPath | None = None,
) -> Element:
    """The contact element of a study, which is left in the file `output`; `results` is the folder of its springs, `fmu` a file for a functional mock-up unit."""
    arguments = ["element", _study(study), "-o", os.fspath(output)]
    for option, path in [("--results", results), ("--fmu", fmu)]:
        if path is not None:
            arguments += [option, os.fspath(path)]
    _started(arguments, program, keys, cache)
    return Element(output)


def run(
    study: Study | AnyPath,
    output: AnyPath,
    *,
    keys: Mapping[str, Any] | None = None,
    cache: AnyPath | None = None,
    program: AnyPath | None = None,
) -> Calibration:
    """All of a study: springs, histories of both models, and the verdict, whose failure is a result as well (`verification.json`)."""
    _started(["run", _study(study), "-o", os.fspath(output)], program, keys, cache)
    return Calibration.read(output)


def make_table(
    table: AnyPath,
    output: AnyPath,
    *,
    scheduler: str | None = None,
    python: AnyPath | None = None,
    cache: AnyPath | None = None,
    program: AnyPath | None = None,
) -> Table:
    """A table of springs: on this machine, or with the address of its scheduler on a running Dask cluster (`client.scheduler.address`).

    Rows without a law have their reason in the column `reason`. `python` is an interpreter with `distributed` for the client of the cluster; left out, the
    program makes an environment.
    """
    arguments = ["table", os.fspath(table), "-o", os.fspath(output)]
    if scheduler is not None:
        arguments += ["--executor", "dask", "--scheduler", scheduler]
    if python is not None:
        arguments += ["--python", os.fspath(python)]
    _started(arguments, program, None, cache)
    return Table.read(Path(output))
