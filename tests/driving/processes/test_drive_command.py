"""`drawbar drive` as a program at a terminal: however it is ended, in order, and with a report."""

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import termios
import time
from pathlib import Path

import pytest
from patience import ENGAGE, PATIENT

from drawbar.cli.drive import NO_KEYS
from drawbar.config import load_configuration
from drawbar.driving.messaging.process_options import RECEIVERS
from drawbar.driving.operator.terminal import TAKE_OVER
from drawbar.driving.processes.drive_processes import LOSSES
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.messages import SupervisorState
from drawbar.recording.drive_events import Became, drive_events
from drawbar.recording.log import read_log
from drawbar.safety.causes import Cause

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
BY_HAND = ("--by-hand",)


def _at_a_terminal():
    """Make standard input the terminal that hangs up, and let that be heard, though the tests run under nohup."""
    os.close(os.open(os.ttyname(0), os.O_RDWR))
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


class Terminal:
    """A drive of stand-ins at a terminal of its own, and what it has shown."""

    def __init__(self, folder, options):
        self.shown, self._ours = "", None
        self._ours, self.theirs = os.openpty()
        self.before = termios.tcgetattr(self.theirs)
        self.temporary = Path(tempfile.mkdtemp())  # names of sockets must be short, those of tests' folders are long
        self.process = subprocess.Popen(
            [sys.executable, "-m", "drawbar", "drive", "--set", "path.radii=[8.0]", "--out", "run", *options],
            stdin=self.theirs,
            stdout=self.theirs,
            stderr=self.theirs,
            cwd=folder,
            env={**os.environ, "TMPDIR": str(self.temporary), "COLUMNS": "200", "TERM": "xterm"},
            start_new_session=True,
            preexec_fn=_at_a_terminal,
        )
        os.set_blocking(self._ours, False)

    def await_words(self, words):
        end = time.monotonic() + ENGAGE
        while words not in self.shown:
            assert self.process.poll() is None, self.shown
            assert time.monotonic() < end, self.shown
            try:
                self.shown += os.read(self._ours, 1 << 16).decode(errors="replace")
            except BlockingIOError:
                time.sleep(0.05)

    def drain(self):
        """Read on until the program has ended; return its exit code."""
        end = time.monotonic() + ENGAGE
        while self.process.poll() is None:
            assert time.monotonic() < end, self.shown
            try:
                self.shown += os.read(self._ours, 1 << 16).decode(errors="replace")
            except OSError:
                time.sleep(0.05)
        return self.process.returncode

    def child(self, module):
        """Return the process of the drive that runs a module."""
        children = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        (found,) = (int(each) for each in children if module in Path(f"/proc/{each}/cmdline").read_text())
        return found

    def hang_up(self):
        os.close(self.theirs)
        os.close(self._ours)
        self._ours = -1

    def close(self):
        self.process.kill()
        self.process.wait()
        shutil.rmtree(self.temporary)


@pytest.fixture
def terminal(tmp_path, request):
    terminal = Terminal(tmp_path, getattr(request, "param", BY_HAND))
    yield terminal
    terminal.close()


def test_every_signal_ends_a_drive_in_order_and_further_ones_do_no_harm(terminal, tmp_path):
    terminal.await_words("not ready to engage")
    terminal.process.send_signal(signal.SIGTERM)
    terminal.await_words("interrupted")
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        terminal.process.send_signal(number)
    assert terminal.drain() == 0, terminal.shown
    assert (tmp_path / "run" / "report.html").is_file()
    assert not list(terminal.temporary.glob("drawbar-*"))
    assert termios.tcgetattr(terminal.theirs) == terminal.before


def test_a_terminal_that_is_closed_ends_a_drive_in_order(terminal, tmp_path):
    terminal.await_words("not ready to engage")
    terminal.hang_up()
    assert terminal.drain() == 0
    assert (tmp_path / "run" / "report.html").is_file()
    assert not list(terminal.temporary.glob("drawbar-*"))


@pytest.mark.parametrize(("option", "told"), [("--by-hand", True), ("--pace=1", False)])
def test_a_drive_that_reads_no_keys_says_so_where_they_are_needed(tmp_path, option, told):
    command = [sys.executable, "-m", "drawbar", "drive", option, "--seconds", "1"]
    ended = subprocess.run(command, input="e", capture_output=True, text=True, cwd=tmp_path, timeout=ENGAGE)
    assert (NO_KEYS in ended.stdout) is told, ended.stdout


def test_a_folder_with_umlauts_and_blanks_is_recorded_into_where_text_is_not_utf_8(tmp_path):
    """The processes were told what to do in UTF-8, and read it as what the terminal has."""
    command = [sys.executable, "-m", "drawbar", "drive", "--by-hand", "--seconds", "1", "--out", "Feld für heute/ö 1"]
    surroundings = {**os.environ, "PYTHONIOENCODING": "latin-1"}
    ended = subprocess.run(command, capture_output=True, cwd=tmp_path, timeout=ENGAGE, env=surroundings, check=False)
    assert ended.returncode == 0, ended.stdout
    assert read_log(tmp_path / "Feld für heute" / "ö 1" / "log.mcap").records


def test_a_shadow_drive_ends_with_what_drawbar_would_have_done(tmp_path):
    command = [sys.executable, "-m", "drawbar", "drive", "--shadow", "--pace", "2", "--seconds", "8", "--out", "run"]
    ended = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert ended.returncode == 0, ended.stderr
    assert "drawbar only looked on:" in ended.stdout
    assert json.loads((tmp_path / "run" / "metrics.json").read_text())["shadow"]["judged_s"] > 1.0
    assert read_log(tmp_path / "run").header.shadow


@pytest.mark.parametrize(
    "terminal", [[f"--set={change}" for change in (*PATIENT, "safety.timing.recorder=5.0")]], indirect=True
)
def test_a_recorder_that_is_killed_costs_the_record_only_and_that_is_reported(terminal, tmp_path):
    terminal.await_words("ACTIVE: steering")
    os.kill(terminal.child("recorder_main"), signal.SIGKILL)
    terminal.await_words("the recorder has ended: nothing more is recorded")
    terminal.shown = ""
    terminal.await_words("- nothing is recorded: the disk is full, too slow or gone, or the recorder has ended")
    assert "ACTIVE: steering" in terminal.shown
    assert "interrupted" not in terminal.shown
    terminal.process.send_signal(signal.SIGTERM)
    assert terminal.drain() == 0, terminal.shown
    assert (tmp_path / "run" / "report.html").is_file()
    log = read_log(tmp_path / "run" / "log.mcap")
    assert log.records
    assert not log.outcome.finished


def test_a_front_end_that_crashes_leaves_where_it_was(terminal, tmp_path):
    terminal.await_words("not ready to engage")
    terminal.process.send_signal(signal.SIGSEGV)
    assert terminal.drain() == -signal.SIGSEGV
    told = (tmp_path / "run" / "messages.txt").read_text()
    assert told.count("Fatal Python error: Segmentation fault") == 1
    assert re.search(r'File ".*drive.py", line \d+ in _drive', told)


@pytest.mark.parametrize("terminal", [[f"--set={change}" for change in PATIENT]], indirect=True)
def test_a_controller_that_is_killed_ends_the_drive_and_the_driver_is_told_to_stop(terminal, tmp_path):
    terminal.await_words("ACTIVE: steering")
    os.kill(terminal.child("controller_main"), signal.SIGKILL)
    assert terminal.drain() == 1, terminal.shown
    assert "controller (killed by SIGKILL): " in terminal.shown
    assert TAKE_OVER in terminal.shown
    assert Cause.CONTROLLER_GONE.sentence in read_log(tmp_path / "run" / "log.mcap").outcome.reason


@pytest.mark.parametrize("terminal", [[f"--set={change}" for change in PATIENT]], indirect=True)
def test_receivers_that_are_killed_stop_the_vehicle_before_the_steering_is_released(terminal, tmp_path):
    terminal.await_words("ACTIVE: steering")
    os.kill(terminal.child("receivers_main"), signal.SIGKILL)
    terminal.await_words(LOSSES[RECEIVERS])
    assert terminal.drain() == 1, terminal.shown
    assert "receivers (killed by SIGKILL)" in terminal.shown
    assert TAKE_OVER in terminal.shown  # nobody tells any more whether it stands
    states = [each.state for each in drive_events(tmp_path / "run" / "log.mcap") if isinstance(each, Became)]
    assert states[-3:] == [SupervisorState.STOPPING, SupervisorState.STOPPED, SupervisorState.FAULT]


@pytest.mark.parametrize(
    ("device", "key", "scheme", "process"),
    [("tractor_board", "listen", "", "gate"), ("trailer_receiver", "transport", "udp://", "receivers")],
)
def test_a_port_that_another_program_has_is_one_error_and_no_drive(tmp_path, device, key, scheme, process):
    """It was a drive of 0 s, with its report."""
    configuration = with_stand_ins(load_configuration("articulated"))
    devices, file = configuration.devices, tmp_path / "machine.toml"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("0.0.0.0", 0))
        port = other.getsockname()[1]
        place = getattr(devices, device).model_copy(update={key: f"{scheme}0.0.0.0:{port}"})
        changed = configuration.model_copy(update={"devices": devices.model_copy(update={device: place})})
        file.write_text(changed.to_toml(), "utf-8")
        command = [sys.executable, "-m", "drawbar", "drive", str(file), "--out", "run"]
        ended = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, cwd=tmp_path)
    assert ended.returncode == 2, ended.stdout
    said = " ".join(ended.stderr.split())
    assert said.startswith(f"error: the {process} process did not start: port {port} is taken: another program listens")
    assert not ended.stdout
    assert not (tmp_path / "run" / "report.html").exists()
