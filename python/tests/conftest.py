"""The program under RAILSPRING, and what it makes of a coarse study."""

from pathlib import Path

import pytest

import railspring

ROOT = Path(__file__).resolve().parents[2]
COARSE = ROOT / "tests" / "studies" / "coarse.toml"


@pytest.fixture(scope="session")
def work(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for all tests."""
    return tmp_path_factory.mktemp("work")


@pytest.fixture(scope="session")
def calibration(work: Path) -> railspring.Calibration:
    """The springs of the coarse study, with the wheel at 2 mm."""
    keys = {"track.lateral_shift_mm": 2}
    return railspring.calibrate(railspring.Study.read(COARSE), work / "out", keys=keys, cache=work / "cache")


@pytest.fixture(scope="session")
def table_file(work: Path) -> Path:
    """A table of a wheel at two shifts, of which it is off the rail at the second."""
    path = work / "table.toml"
    path.write_text(
        f'name = "fleet"\nbase = "{COARSE.as_posix()}"\nshifts_mm = [2, 29]\nstiffness_at_kn = [20, 60]\n'
        '[[wheel]]\nprofile = "S1002"\n[[rail]]\nprofile = "60E1"\n',
        encoding="utf-8",
    )
    return path
