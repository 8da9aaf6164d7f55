"""A drive's processes end with whoever started them."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from drawbar.config import load_configuration
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.driving.processes.shutdown import run_program
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.errors import HardwareError

pytestmark = pytest.mark.skipif(not hasattr(os, "getppid") or sys.platform == "win32", reason="drives are for Linux")
CHILD = """
import pathlib, sys, time
from drawbar.driving.processes.shutdown import ShutdownRequest
shutdown = ShutdownRequest()
print("ready", flush=True)
while not shutdown.asked:
    time.sleep(0.01)
pathlib.Path(sys.argv[1]).touch()
"""
LATE_CHILD = f"""
import os, time
while os.getppid() == int(os.environ["DRAWBAR_STARTER"]):
    time.sleep(0.01)
{CHILD}
"""
HASTY_STARTER = """
import subprocess, sys
from drawbar.driving.processes.shutdown import environment
subprocess.Popen([sys.executable, "-c", *sys.argv[1:]], env=environment())
"""
STARTER = "import subprocess, sys; subprocess.run([sys.executable, '-c', *sys.argv[1:]])"


@pytest.fixture
def ended(tmp_path: Path) -> Path:
    return tmp_path / "ended"


def wait_for(file: Path) -> None:
    deadline = time.monotonic() + 120.0
    while not file.exists():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_a_signal_ends_it(ended: Path) -> None:
    with subprocess.Popen([sys.executable, "-c", CHILD, str(ended)], stdout=subprocess.PIPE) as child:
        assert child.stdout is not None
        child.stdout.readline()
        child.send_signal(signal.SIGTERM)
        wait_for(ended)


def test_it_ends_where_its_starter_was_killed(ended: Path) -> None:
    command = [sys.executable, "-c", STARTER, CHILD, str(ended)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as starter:
        assert starter.stdout is not None
        starter.stdout.readline()
        starter.kill()
        wait_for(ended)


def test_it_ends_where_its_starter_ended_while_it_still_started(ended: Path) -> None:
    subprocess.run([sys.executable, "-c", HASTY_STARTER, LATE_CHILD, str(ended)], check=True, timeout=120.0)
    wait_for(ended)
    assert ended.exists()


def test_a_processs_expected_error_is_its_message_alone(capsys: pytest.CaptureFixture[str]) -> None:
    def main() -> int:
        raise HardwareError("the port is taken; give another")

    assert run_program(main) == 2
    assert capsys.readouterr().err == "the port is taken; give another\n"


def test_a_temporary_folder_with_too_long_a_name_for_sockets_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    long = tmp_path / ("a" * 110)
    long.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(long))
    with pytest.raises(HardwareError, match="set TMPDIR to a shorter one"):
        DriveProcesses(with_stand_ins(load_configuration("articulated")), tmp_path, stand_ins=True)
    assert not list(long.iterdir())
