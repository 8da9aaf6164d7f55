"""What ends a drive at a terminal, where the moment matters: without processes."""

import errno
import json
import os
import socket
import sys
import threading
import time
from types import SimpleNamespace

import pytest

from drawbar.cli.drive import _drive, _report, _run
from drawbar.cli.interrupts import Interrupts
from drawbar.errors import HardwareError, StorageError

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")


class FrontEnd:
    """Nobody at the keys, and nothing heard."""

    def __init__(self, processes, *, demonstrates):
        self.state, self.is_over, self.closed = None, False, False
        processes.front = self

    def wait(self, seconds):
        pass

    def close(self):
        self.closed = True


class Terminal:
    """A terminal that cannot be written to."""

    def __init__(self, console, processes, front):
        pass

    def __enter__(self):
        return self

    def __exit__(self, *what):
        pass

    def show(self):
        raise OSError(errno.EIO, "cannot be written to")


TWO_LINES = json.dumps(
    {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "properties": {"name": name},
                "geometry": {"type": "LineString", "coordinates": [[4.7, latitude], [4.701, latitude]]},
            }
            for name, latitude in (("left", 50.871), ("right", 50.87))
        ],
    }
)
WITH_CORRECTIONS = """
extends = "articulated"
name = "my"
[devices.tractor_receiver]
transport = "udp://127.0.0.1:1"
[devices.trailer_receiver]
transport = "udp://127.0.0.1:2"
[devices.corrections]
host = "rtk.example.org"
mount = "VRS"
credentials = "environment:NTRIP_LOGIN"
[devices.tractor_board]
address = "127.0.0.5"
max_angle = 0.52
[devices.trailer_board]
address = "127.0.0.6"
max_angle = 0.35
"""


@pytest.fixture
def processes(monkeypatch):
    monkeypatch.setattr("drawbar.driving.operator.front_end.FrontEnd", FrontEnd)
    monkeypatch.setattr("drawbar.driving.operator.terminal.Terminal", Terminal)
    return SimpleNamespace(options=SimpleNamespace(clock=lambda: 0.0))


def test_a_terminal_that_is_gone_before_its_signal_is_heard_ends_a_drive_in_order(processes, monkeypatch):
    ours, theirs = os.openpty()
    with open(theirs, "w", encoding="utf-8") as gone:
        monkeypatch.setattr("sys.stdout", gone)
        os.close(ours)
        assert not _drive(processes, Interrupts(), demonstrates=False, seconds=1.0)
        print("what follows goes nowhere", flush=True)
    assert processes.front.closed


def test_a_terminal_that_is_gone_ends_a_drive_though_its_signal_is_ignored(processes, monkeypatch):
    class Silent(Terminal):
        def show(self):
            pass

        def tell_losses(self):
            return True

    monkeypatch.setattr("drawbar.driving.operator.terminal.Terminal", Silent)
    ours, theirs = os.openpty()
    with open(theirs, encoding="utf-8") as gone:
        monkeypatch.setattr("sys.stdin", gone)
        processes.options = SimpleNamespace(clock=time.monotonic)
        hang_up = threading.Timer(0.2, os.close, [ours])
        hang_up.start()
        begin = time.monotonic()
        assert not _drive(processes, Interrupts(), demonstrates=False, seconds=20.0)
        assert time.monotonic() - begin < 10.0
        hang_up.join()
    assert processes.front.closed


def test_output_that_fails_while_the_terminal_is_there_is_reported(processes):
    with pytest.raises(OSError, match="cannot be written to"):
        _drive(processes, Interrupts(), demonstrates=False, seconds=1.0)
    assert processes.front.closed


class Ended:
    """Processes of a drive that is over, and what they have said."""

    def __init__(self, said, killed=()):
        self.said, self.killed, self.messages_lost = said, killed, ""

    def __enter__(self):
        return self

    def __exit__(self, *what):
        pass

    def output(self):
        return self.said

    def close(self):
        pass


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ([], ""),
        (["gate: not scheduled"], "gate: not scheduled\n"),
        (["gate: not scheduled", "receivers: not", "recorder: not"], "gate: not scheduled (2 more in messages.txt"),
    ],
)
def test_what_the_processes_could_not_have_is_reported_at_the_start(monkeypatch, capsys, tmp_path, said, told):
    monkeypatch.setattr("drawbar.cli.drive._drive", lambda *arguments, **options: False)
    assert not _run(Ended(said), tmp_path, None, Interrupts(), demonstrates=True, seconds=0.0)
    shown = capsys.readouterr().out
    assert shown.endswith(told) if len(said) < 2 else told in shown
    assert bool(said) == bool(shown.strip())


def test_a_recorder_that_could_not_write_all_is_reported(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr("drawbar.cli.drive._drive", lambda *arguments, **options: False)
    assert not _run(Ended([], killed=["recorder"]), tmp_path, None, Interrupts(), demonstrates=False, seconds=0.0)
    assert "the end of the drive is lost" in capsys.readouterr().out


def test_a_drive_that_does_not_start_leaves_no_folder(tmp_path):
    class Refused(Ended):
        def __enter__(self):
            raise HardwareError("the receivers process did not start")

    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "config.toml").write_text("", "utf-8")
    with pytest.raises(HardwareError):
        _run(Refused([]), tmp_path / "run", None, Interrupts(), demonstrates=True, seconds=0.0)
    assert not any(tmp_path.iterdir())


def test_what_is_wrong_with_a_folder_or_a_port_is_told_before_anything_is_compiled(tmp_path, drawbar, monkeypatch):
    monkeypatch.setattr("drawbar.driving.loop.controller.Controller", lambda *arguments: pytest.fail("it is built"))
    (tmp_path / "here").mkdir()
    code, said = drawbar("drive", "--out", "here")
    assert code == 2
    assert "here is there already" in " ".join(said.split())
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        code, said = drawbar("drive", "--console", "--port", str(taken.getsockname()[1]), "--out", "new")
    assert code == 2
    assert "cannot listen at 127.0.0.1" in " ".join(said.split())
    assert not (tmp_path / "new").exists()


def test_a_line_that_cannot_be_driven_leaves_no_folder(tmp_path, drawbar):
    code, said = drawbar("drive", "--set", "speed=3.0", "--set", "path.radii=[8.0]", "--out", "new")
    assert code == 2
    assert said
    assert not (tmp_path / "new").exists()


def test_a_disk_without_room_for_an_hour_is_told_before_anything_is_compiled(tmp_path, drawbar, monkeypatch):
    monkeypatch.setattr("drawbar.driving.loop.controller.Controller", lambda *arguments: pytest.fail("it is built"))
    monkeypatch.setattr("shutil.disk_usage", lambda folder: SimpleNamespace(total=10**9, free=30_000_000))
    code, said = drawbar("drive", "--out", "new")
    assert code == 2
    assert "the disk of new has 30 MB left; the log of an hour's drive takes 37 MB" in " ".join(said.split())
    assert not (tmp_path / "new").exists()


def test_a_run_whose_folder_went_away_is_reported(tmp_path):
    with pytest.raises(
        StorageError, match="not there any more: the folder was moved or removed, or its disk unmounted"
    ):
        _report(tmp_path, None)


def test_a_folder_whose_name_no_process_could_be_told_is_refused(tmp_path, drawbar):
    code, told = drawbar("drive", "--pace", "10", "--out", os.fsdecode(os.fsencode(tmp_path) + b"/\xc4cker"))
    assert code in (1, 2)
    assert "is no name in UTF-8; choose another --out folder" in " ".join(told.split())
    assert not any(tmp_path.glob("*cker"))


def test_a_login_that_is_missing_is_told_before_anything_starts(tmp_path, drawbar, monkeypatch):
    monkeypatch.delenv("NTRIP_LOGIN", raising=False)
    (tmp_path / "my.toml").write_text(WITH_CORRECTIONS, "utf-8")
    code, said = drawbar("drive", "my.toml")
    assert code == 2
    assert said.count("the environment variable NTRIP_LOGIN is not set; set it to user:password") == 1
    assert not (tmp_path / "runs").exists()


def test_another_line_is_chosen_as_for_a_run(tmp_path, drawbar):
    (tmp_path / "lines.geojson").write_text(TWO_LINES, "utf-8")
    code, said = drawbar("drive", "--path", "lines.geojson", "--track", "middle")
    assert code == 2
    assert "has no line 'middle'" in " ".join(said.split())
    assert drawbar("drive", "--path", "")[1].startswith("error: --path is empty")
