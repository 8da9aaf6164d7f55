"""Faults of a machine in real time: the command of experiments/faults drives, keeps, goes on and can be interrupted."""

import csv
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="drives are for Linux")
COMMAND = [sys.executable, str(Path(__file__).parents[3] / "experiments" / "faults" / "real_time.py")]
FAULT = "2 m/s, curve: C5 C11 C14 controller's process ends"


def started(folder, *options):
    """Start the command with a folder of its own, by which all of its processes are known."""
    return subprocess.Popen(
        [*COMMAND, "--out", str(folder / "kept.csv"), *options],
        env={**os.environ, "TMPDIR": str(folder)},
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def alive(folder):
    """Return the processes of a command that there are."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        try:
            found += [place.name] if f"TMPDIR={folder}".encode() in (place / "environ").read_bytes() else []
        except OSError:
            continue
    return found


def test_a_fault_is_driven_once_and_kept(tmp_path):
    with started(tmp_path, "--only", FAULT) as first:
        told = first.communicate()[0]
    assert first.returncode == 0
    assert f"1 of 1: {FAULT}: releases; CONTROLLER_GONE" in told
    with (tmp_path / "kept.csv").open(encoding="utf-8") as lines:
        (row,) = csv.DictReader(lines)
    assert (row["expected"], row["as expected"]) == ("releases", "yes")
    assert 0.0 < float(row["released"]) < float(row["stood"])
    assert "1 faults driven, 1 as expected" in (tmp_path / "kept.md").read_text("utf-8")
    with started(tmp_path, "--only", FAULT) as again:
        assert (again.communicate()[0], again.returncode) == ("", 0)


def test_a_fault_that_no_such_drive_can_have_is_told_with_its_reason(tmp_path):
    with started(tmp_path, "--only", "curve: C20 computer suspended") as command:
        command.communicate()
    assert (
        "| 2 m/s, curve | C20 computer suspended | releases | not driven |  | it changes the inside of the gate, "
        in (tmp_path / "kept.md").read_text("utf-8")
    )


def test_an_interrupt_ends_all_processes(tmp_path):
    with started(tmp_path, "--jobs", "2") as command:
        end = time.monotonic() + 120.0
        while len(alive(tmp_path)) < 8 and time.monotonic() < end:
            time.sleep(0.05)
        os.killpg(command.pid, signal.SIGINT)
        command.communicate()
    assert command.returncode == 128 + signal.SIGINT
    assert not alive(tmp_path)
    assert not list(tmp_path.glob("drawbar-*"))
