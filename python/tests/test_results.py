"""What the program makes, read back.

Source: the program itself, on a coarse study, and for averages the integral of a straight line. Accuracy: ROUNDOFF, the same numbers through other sums.
"""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import railspring
from railspring import Calibration, History, ProgramError, Study, Table

from .conftest import COARSE

ROUNDOFF = 1e-9


def test_a_calibration_is_its_files(calibration: Calibration) -> None:
    curve = calibration.load_curve()
    law = calibration.law()
    forces = 1e3 * curve["force_kn"].to_numpy()
    assert np.allclose(law.tangent(forces), 1e3 * curve["law_tangent_kn_per_m"], rtol=ROUNDOFF)
    assert np.allclose(law.displacement(forces), 1e-3 * curve["law_displacement_mm"], rtol=ROUNDOFF)
    points = calibration.points("local")
    assert list(points.columns) == ["force_kn", "displacement_mm", "tangent_kn_per_m"] and len(points) == len(curve)
    knots = calibration.table_law("local")
    assert np.allclose(knots.tangent(1e3 * points["force_kn"].to_numpy()), 1e3 * points["tangent_kn_per_m"], rtol=ROUNDOFF)
    assert calibration.range() == (5e3, 85e3) and calibration.reference == "beam"
    assert calibration.horizontal is not None and calibration.horizontal > 1e7 and "shift 2 mm" in calibration.pair
    with pytest.raises(KeyError, match="'foot'; there are: 'beam', 'local'"):
        calibration.law("foot")


def test_a_row_of_a_table_is_that_calibration(calibration: Calibration, table_file: Path, work: Path) -> None:
    table = railspring.make_table(table_file, work / "table", cache=work / "cache")
    row = table.rows.iloc[0]
    assert table.rows["status"].tolist() == ["complete", "failed"] and row["shift_mm"] == 2
    for reference in ("beam", "local"):
        ours, theirs = table.law(0, reference), calibration.law(reference)
        forces = np.linspace(5e3, 85e3, 20)
        # the loads of the columns are fitted, too
        assert np.allclose(ours.displacement(forces), theirs.displacement(forces), rtol=0.01)
    constants = [row[f"{name}_kn_per_m"] for name in "ab"]
    assert table.law(0).tangent(1e3) == pytest.approx(1e3 * sum(constants), rel=ROUNDOFF)
    assert table.place(1)["at"]["laws"] == []
    with pytest.raises(ValueError, match="row 1 has no law: .*leave this shift out"):
        table.law(1)
    with pytest.raises(IndexError, match="row 2: expected 0 to 1"):
        table.place(2)


def test_a_table_on_a_cluster_is_the_same(table_file: Path, work: Path) -> None:
    distributed = pytest.importorskip("distributed")
    import sys

    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        sent = railspring.make_table(
            table_file, work / "sent", scheduler=cluster.scheduler_address, python=sys.executable, cache=work / "sent-cache"
        )
    here = railspring.make_table(table_file, work / "here", cache=work / "here-cache")
    pd.testing.assert_frame_equal(sent.rows, here.rows, check_exact=True)


def test_a_fit_needs_no_study(work: Path) -> None:
    keys = {"mesh.contact_element_mm": 6, "calibration.error_band": False, "calibration.shifts_mm": []}
    made = railspring.fit("S1002", "60E1", work / "fit", keys=keys, cache=work / "cache")
    assert Study.read(work / "fit" / "study.toml").keys["rail"]["profile"] == "60E1"
    assert 5e8 < made.law().tangent(85e3) < 3e9


def test_what_is_wrong_is_said(work: Path) -> None:
    with pytest.raises(ProgramError, match="did you mean") as refused:
        railspring.calibrate(COARSE, work / "no", keys={"contact.frictoin": 0.3})
    assert refused.value.code == 2 and not (work / "no").exists()
    with pytest.raises(FileNotFoundError, match="run `railspring calibrate` first"):
        Calibration.read(work / "no")
    with pytest.raises(FileNotFoundError, match="leave RAILSPRING and program= out"):
        railspring.fit("S1002", "60E1", work / "no", program=work / "none")
    (work / "wrong").mkdir()
    (work / "wrong" / "stiffness.json").write_text("[1]", encoding="utf-8")
    with pytest.raises(ValueError, match="expected a file as `railspring calibrate` writes it"):
        Calibration.read(work / "wrong")
    with pytest.raises(FileNotFoundError, match="railspring table"):
        Table.read(work / "wrong")
    (work / "wrong" / "study.toml").write_text("name = ", encoding="utf-8")
    with pytest.raises(ValueError, match="expected a study"):
        Study.read(work / "wrong" / "study.toml")


def test_what_was_edited_is_refused(calibration: Calibration, table_file: Path, work: Path) -> None:
    # a constant, a row and a record, each changed in one digit
    edited = work / "edited"
    railspring.make_table(table_file, edited, cache=work / "cache")
    (edited / "stiffness.json").write_bytes((calibration.folder / "stiffness.json").read_bytes())
    Calibration.read(edited), Table.read(edited)
    for name, old, new in [
        ("stiffness.json", '"reference": "beam"', '"reference": "local"'),
        ("table.csv", "complete", "failed"),
        ("table.json", '"status": "complete"', '"status": "failed"'),
    ]:
        path = edited / name
        whole = path.read_text(encoding="utf-8")
        assert old in whole
        path.write_text(whole.replace(old, new, 1), encoding="utf-8")
        with pytest.raises(ValueError, match="edited after it was written|a file as it was written"):
            Calibration.read(edited) if name == "stiffness.json" else Table.read(edited)
        with pytest.raises(ValueError, match=name.replace(".", "[.]")):
            railspring.check_as_written(path)
        path.write_text(whole, encoding="utf-8")


def test_averages_are_integrals() -> None:
    # Q grows by 3 kN/s from 1 kN, P stays 10 kN; steps of different length
    time = np.array([0.0, 0.01, 0.015, 0.04, 0.05, 0.1])
    frame = pd.DataFrame({"time_s": time, "p_kn": 10.0, "q_kn": 1.0 + 3.0 * time})
    found = railspring.averaged_ratio(History(Path("made up"), frame), 0.024)
    begin = np.maximum(time - 0.024, 0.0)
    assert np.allclose(found, 0.1 * (1.0 + 1.5 * (time + begin)), rtol=1e-12)
    frame["p_kn"] = 0.0
    assert np.all(np.isnan(railspring.averaged_ratio(History(Path("made up"), frame))))
