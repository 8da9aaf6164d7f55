"""Output that cannot be written is one message."""

import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from drawbar.cli.main import app

FULL = Path("/dev/full")


@pytest.mark.skipif(not FULL.exists(), reason="this system has no /dev/full")
@pytest.mark.parametrize("arguments", [("config", "articulated"), ("--version",)], ids=["long", "short"])
def test_a_full_disk_behind_standard_output_is_one_message(arguments):
    with FULL.open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "drawbar", *arguments], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert (done.returncode, done.stderr) == (2, "error: output cannot be written: No space left on device\n")


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "--out", ""),
        ("drive", "--out", ""),
        ("export", "articulated", "--out", ""),
        ("path", "articulated", "--out", ""),
        ("report", "run", "--out", ""),
        ("tube", "articulated", "--out", ""),
        ("tune", "paper", "--parameters", "speed=0.5..1.5", "--out", ""),
        ("bench", "--json", ""),
        ("log", "export", "run", "--csv", ""),
        ("log", "export", "run", "--ros2", ""),
        ("log", "export", "run", "--geojson", ""),
    ],
    ids=" ".join,
)
def test_an_empty_name_of_what_is_to_be_written_is_refused(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 2
    assert f"Invalid value for '{arguments[-2]}': is empty; name a file or folder" in done.output
    assert not list(tmp_path.iterdir())
