"""A disk that is full, or can no longer be written, while drawbar steers: a real one, which only root can mount."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from patience import ENGAGE, PATIENT

from drawbar.recording.log import read_log

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
CHANGES = [f"--set={change}" for change in ("path.radii=[8.0]", *PATIENT)]
SIZE = 64_000_000
"""of the disk: less than an hour of a log, bytes"""


def mounted(*arguments):
    done = subprocess.run(["mount", *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"no file system can be mounted here: {done.stderr.strip()}")


@pytest.fixture
def disk(tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    mounted("-t", "tmpfs", "-o", f"size={SIZE}", "none", str(disk))
    yield disk
    subprocess.run(["umount", "--recursive", "--lazy", str(disk)], check=True)


class Drive:
    """A drive of stand-ins into a folder; what it says goes elsewhere."""

    def __init__(self, folder, said):
        self._said = said
        command = [sys.executable, "-m", "drawbar", "drive", *CHANGES, "--out", str(folder)]
        with said.open("w") as stream:
            self.process = subprocess.Popen(command, stdout=stream, stderr=stream, stdin=subprocess.DEVNULL)

    @property
    def said(self):
        return self._said.read_text("utf-8")

    def await_words(self, words):
        end = time.monotonic() + ENGAGE
        while words not in self.said:
            assert self.process.poll() is None, self.said
            assert time.monotonic() < end, self.said
            time.sleep(0.05)

    def end(self):
        """End it by Ctrl-C; return its exit code."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(ENGAGE)


@pytest.fixture
def drive(disk, tmp_path):
    drive = Drive(disk / "run", tmp_path / "said.txt")
    yield drive
    drive.process.kill()
    drive.process.wait()


def fill(disk: Path):
    """Leave not a byte on a disk."""
    with (disk / "ballast").open("wb", buffering=0) as ballast:
        for size in (1 << 16, 1 << 12, 1):
            try:
                while True:
                    ballast.write(bytes(size))
            except OSError:
                continue


def test_a_disk_that_is_really_full_costs_the_record_and_the_figures_are_shown_at_the_end(drive, disk):
    drive.await_words("ACTIVE: steering")
    assert "the log of an hour's drive takes 37 MB: enough for 1.7 h" in drive.said
    time.sleep(3.0)
    fill(disk)
    drive.await_words("the log cannot be written any further")
    drive.await_words("- nothing is recorded: the disk is full")
    time.sleep(1.0)
    states = [line for line in drive.said.splitlines() if re.match("[A-Z]+: ", line)]
    assert states[-1].startswith("ACTIVE: steering")
    assert drive.end() == 2
    figures, _, error = drive.said.partition("error: ")
    assert "solver, µs" in figures
    assert "report.html, map.svg cannot be written (No space left on device)" in error
    assert "free space, then `drawbar report" in error
    assert f"{disk / 'run' / 'messages.txt'}: not written to its end (No space left on device)" in figures
    assert os.statvfs(disk).f_bavail == 0
    assert read_log(disk / "run").records


def test_a_folder_that_can_no_longer_be_written_costs_the_report_and_the_figures_are_shown(drive, disk):
    drive.await_words("ACTIVE: steering")
    run = str(disk / "run")
    mounted("--bind", run, run)
    mounted("-o", "remount,bind,ro", run)
    time.sleep(3.0)
    assert drive.end() == 2
    figures, _, error = drive.said.partition("error: ")
    assert "solver, µs" in figures
    assert "metrics.json, report.html, map.svg cannot be written (Read-only file system)" in error
    assert "free space" not in error
    assert read_log(disk / "run").records
