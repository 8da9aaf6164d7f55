"""The folder of a drive's sockets: gone with its process, at the latest with the next drive."""

import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from drawbar.driving.messaging.socket_folder import SocketFolder
from drawbar.errors import HardwareError

KILLED = """
import os, signal
from drawbar.driving.messaging.socket_folder import SocketFolder
folder = SocketFolder()
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the temporary folder of this test."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    return tmp_path


def test_it_is_removed_when_it_is_left(temporary: Path) -> None:
    with SocketFolder() as name:
        assert Path(name).parent == temporary
    assert not list(temporary.iterdir())


def test_one_whose_process_was_killed_is_removed_by_the_next_and_no_other(temporary: Path) -> None:
    (temporary / "drawbar-of-another-program").mkdir()
    subprocess.run([sys.executable, "-c", KILLED], check=False)
    with SocketFolder() as living:
        assert {each.name for each in temporary.iterdir()} == {Path(living).name, "drawbar-of-another-program"}
        with SocketFolder():
            assert Path(living).is_dir()


def test_a_name_that_is_too_long_for_sockets_is_refused(temporary: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    long = temporary / ("a" * 100)
    long.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(long))
    with pytest.raises(HardwareError, match="too long a name for sockets"):
        SocketFolder()
    assert not list(long.iterdir())
