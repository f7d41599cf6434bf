"""The program that the package brings along.

Source: the program itself. Goal: the command and the module are the same program, whole outputs and exit codes come through, Ctrl-C stops it with code 130, and a module in the
working folder is not taken for it. Exact.
"""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import railspring

SCRIPT = [str(Path(sys.executable).with_name("railspring"))]
MODULE = [sys.executable, "-m", "railspring"]


def said(command: list[str], folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    """What a command says."""
    return subprocess.run(command, capture_output=True, cwd=folder, encoding="utf-8")


@pytest.mark.parametrize("program", [SCRIPT, MODULE])
def test_outputs_and_codes_come_through(program: list[str]) -> None:
    schema = said([*program, "schema"])
    assert schema.returncode == 0 and json.loads(schema.stdout)["type"] == "object"
    refused = said([*program, "calibrate", "absent.toml"])
    assert refused.returncode == 2 and "absent.toml" in refused.stderr and not refused.stdout
    assert said([*program, "no-such-command"]).returncode == 2


def test_command_and_module_are_the_same_program() -> None:
    found = [json.loads(said([*program, "work", "--check"]).stdout) for program in (SCRIPT, MODULE)]
    assert found[0] == found[1] and len(found[0]["program"]) == 64


def test_a_stop_is_code_130(tmp_path: Path) -> None:
    command = [*SCRIPT, "fit", "S1002", "60E1", "-o", str(tmp_path / "out"), "--cache", str(tmp_path / "cache")]
    with subprocess.Popen(command, stderr=subprocess.PIPE, encoding="utf-8") as process:
        assert process.stderr is not None
        for line in process.stderr:
            if "0 of" in line:
                process.send_signal(signal.SIGINT)
                break
        heard = process.stderr.read()
        assert process.wait(timeout=120) == 130, heard


def test_a_module_of_the_working_folder_is_not_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "railspring.py").write_text("raise SystemExit(77)\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(railspring.ProgramError) as refused:
        railspring.run("absent.toml", tmp_path / "out")
    assert refused.value.code == 2 and "absent.toml" in str(refused.value)
