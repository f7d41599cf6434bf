"""What the program writes, read back."""

import json
import tomllib
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ._native import Law, TableLaw, check_as_written

AnyPath = str | PathLike[str]


def _json(path: Path, made_by: str, keys: tuple[str, ...]) -> dict[str, Any]:
    """The content of a JSON file that the program has written."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as cause:
        raise FileNotFoundError(f"{path}: {cause.strerror}; run `railspring {made_by}` first, or name its folder") from None
    except ValueError as cause:
        raise ValueError(f"{path}: {cause}; write it again with `railspring {made_by}`") from None
    missing = [key for key in keys if not isinstance(content, dict) or key not in content]
    if missing:
        raise ValueError(f"{path}: no {', '.join(missing)}; expected a file as `railspring {made_by}` writes it")
    return dict(content)


def _law_of(constants: dict[str, Any]) -> Law:
    return Law.from_constants(*(constants[key] for key in ("a_kn_per_m", "b_kn_per_m", "c", "f0_kn")))


def _with(kind: str, wanted: str, entries: list[dict[str, Any]], where: str) -> dict[str, Any]:
    """The entry of a reference."""
    for entry in entries:
        if entry["reference"] == wanted:
            return entry
    there = ", ".join(repr(entry["reference"]) for entry in entries) or "none"
    raise KeyError(f"{where}: no {kind} against {wanted!r}; there are: {there}")


@dataclass(frozen=True)
class Study:
    """A study file as it is: sections of keys, with units in their names. The program checks it when it is run."""

    path: Path
    keys: dict[str, Any]

    @classmethod
    def read(cls, path: AnyPath) -> "Study":
        """Reads a TOML file."""
        path = Path(path)
        with path.open("rb") as file:
            try:
                return cls(path, tomllib.load(file))
            except tomllib.TOMLDecodeError as cause:
                raise ValueError(f"{path}: {cause}; expected a study, which is a TOML file") from None

    @property
    def name(self) -> str:
        """Its name, which names the output folder."""
        return str(self.keys.get("name", self.path.stem))


@dataclass(frozen=True)
class Calibration:
    """The springs of a pair, with all that `stiffness.json` has of them."""

    folder: Path
    record: dict[str, Any]

    @classmethod
    def read(cls, folder: AnyPath) -> "Calibration":
        """Reads the output folder of a calibration, or its `stiffness.json`; a file that was edited is refused."""
        path = Path(folder)
        path = path / "stiffness.json" if path.is_dir() else path
        record = _json(path, "calibrate", ("reference", "references", "pair"))
        check_as_written(path)
        return cls(path.parent, record)

    @property
    def pair(self) -> str:
        """Wheel and rail in words."""
        return str(self.record["pair"]["name"])

    @property
    def reference(self) -> str:
        """What the displacement of the law in use is measured against."""
        return str(self.record["reference"])

    @property
    def horizontal(self) -> float | None:
        """Horizontal stiffness of the sticking wheel, N/m; none where it was not found."""
        found = self.record.get("horizontal_kn_per_m")
        return None if found is None else 1e3 * float(found)

    def _entry(self, reference: str | None) -> dict[str, Any]:
        return _with("law", reference or self.reference, self.record["references"], str(self.folder / "stiffness.json"))

    def law(self, reference: str | None = None) -> Law:
        """The law against a reference: `beam`, `local` or `foot`; left out, the one in use."""
        return _law_of(self._entry(reference)["law"])

    def range(self, reference: str | None = None) -> tuple[float, float]:
        """Smallest and largest load (N) that the law was fitted to: beyond there is none."""
        low, high = self._entry(reference)["law"]["range_kn"]
        return 1e3 * low, 1e3 * high

    def points(self, reference: str | None = None) -> pd.DataFrame:
        """The solid model at its loads: force_kn, displacement_mm, tangent_kn_per_m."""
        return pd.DataFrame(self._entry(reference)["points"])

    def table_law(self, reference: str | None = None) -> TableLaw:
        """The law through these points, the alternative where one power does not follow the contact."""
        points = self.points(reference)
        forces, tangents = (1e3 * points[column].to_numpy(dtype=np.float64) for column in ("force_kn", "tangent_kn_per_m"))
        return TableLaw(list(forces), list(tangents))

    def load_curve(self) -> pd.DataFrame:
        """`load_curve.csv`: one row per load."""
        return pd.read_csv(self.folder / "load_curve.csv")

    def by_angle(self) -> pd.DataFrame:
        """`stiffness_by_angle.csv`: a row per shift, load and reference."""
        return pd.read_csv(self.folder / "stiffness_by_angle.csv")

    def history(self, name: str = "history") -> "History":
        """A history of the folder by the name of its file: `history`, `solid_history`, `history_published` and so on."""
        return read_history(self.folder / f"{name}.csv")


@dataclass(frozen=True)
class Table:
    """A table of springs: its rows, and all that `table.json` has of them."""

    folder: Path
    rows: pd.DataFrame
    record: dict[str, Any]

    @classmethod
    def read(cls, folder: AnyPath) -> "Table":
        """Reads the output folder of a table; files that were edited are refused."""
        folder = Path(folder)
        record = _json(folder / "table.json", "table", ("cases", "table"))
        path = folder / "table.csv"
        try:
            rows = pd.read_csv(path, keep_default_na=True, dtype={"reason": "str", "wheel": "str", "rail": "str"})
        except OSError as cause:
            raise FileNotFoundError(f"{path}: {cause.strerror}; run `railspring table` first") from None
        places = sum(len(case["places"]) for case in record["cases"])
        if places != len(rows):
            raise ValueError(f"{folder}: {len(rows)} rows in table.csv and {places} places in table.json; make the table again")
        check_as_written(path)
        return cls(folder, rows, record)

    def place(self, row: int) -> dict[str, Any]:
        """All that is known of the place of a row, by its number in `rows`: laws, loads, touch, reason."""
        if not 0 <= row < len(self.rows):
            raise IndexError(f"row {row}: expected 0 to {len(self.rows) - 1}")
        for case in self.record["cases"]:
            if row < len(case["places"]):
                return dict(case["places"][row])
            row -= len(case["places"])
        raise AssertionError

    def law(self, row: int, reference: str | None = None) -> Law:
        """The law of a row, by its number in `rows`, against a reference; left out, the one of its columns."""
        place = self.place(row)
        laws = place["at"]["laws"]
        if not laws:
            raise ValueError(f"row {row} has no law: {place['at'].get('reason')}")
        return _law_of(_with("law", reference or str(self.rows["reference"].iloc[row]), laws, f"row {row}")["law"])


@dataclass(frozen=True)
class History:
    """Forces, places and contacts of a run, one row per time step."""

    path: Path
    frame: pd.DataFrame

    def array(self, column: str) -> NDArray[np.float64]:
        """A column as an array."""
        if column not in self.frame:
            raise KeyError(f"{self.path}: no column {column!r}; there are: {', '.join(self.frame.columns)}")
        return self.frame[column].to_numpy(dtype=np.float64)


def read_history(path: AnyPath) -> History:
    """Reads `history.csv` or another history."""
    path = Path(path)
    try:
        frame = pd.read_csv(path)
    except OSError as cause:
        raise FileNotFoundError(f"{path}: {cause.strerror}; run `railspring run` first") from None
    if not {"time_s", "p_kn", "q_kn"} <= set(frame.columns):
        raise ValueError(f"{path}: expected the columns of a history, time_s, p_kn, q_kn and more")
    return History(path, frame)


def averaged_ratio(history: History, window_s: float = 0.024, least_kn: float = 1.0) -> NDArray[np.float64]:
    """Q averaged over a window of time that ends at each row, divided by P averaged over the same window.

    Before a whole window has passed, the average is over the time since the start. The averages are integrals of the straight lines between
    rows. Not a number where the averaged P is below `least_kn`.
    """
    time = history.array("time_s")
    begin = np.maximum(time - window_s, time[0])
    averages = []
    for column in ("p_kn", "q_kn"):
        value = history.array(column)
        integral = np.concatenate(([0.0], np.cumsum(0.5 * (value[1:] + value[:-1]) * np.diff(time))))
        # the integral up to a time between two rows, by the straight line between their values
        row = np.clip(np.searchsorted(time, begin, side="right") - 1, 0, len(time) - 2)
        into = begin - time[row]
        slope = (value[row + 1] - value[row]) / (time[row + 1] - time[row])
        before = integral[row] + into * (value[row] + 0.5 * slope * into)
        length = np.where(time > time[0], time - begin, 1.0)
        averages.append(np.where(time > time[0], (integral - before) / length, value))
    p, q = averages
    carried = p >= least_kn
    return np.where(carried, q / np.where(carried, p, 1.0), np.nan)
