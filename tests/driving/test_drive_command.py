"""`drawbar drive` as a program at a terminal: however it is ended, in order, and with a report."""

import os
import signal
import subprocess
import sys
import termios
import time

import pytest
from patience import ENGAGE

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
ARGUMENTS = ("drive", "--by-hand", "--set", "path.radii=[8.0]", "--out", "run")


class Terminal:
    """A drive of stand-ins at a terminal of its own, and what it has shown."""

    def __init__(self, folder):
        self.shown, self._ours = "", None
        self._ours, self.theirs = os.openpty()
        self.before = termios.tcgetattr(self.theirs)
        (folder / "tmp").mkdir()
        self.process = subprocess.Popen(
            [sys.executable, "-m", "drawbar", *ARGUMENTS],
            stdin=self.theirs,
            stdout=self.theirs,
            stderr=self.theirs,
            cwd=folder,
            env={**os.environ, "TMPDIR": str(folder / "tmp"), "COLUMNS": "200", "TERM": "xterm"},
            start_new_session=True,
            preexec_fn=lambda: os.close(os.open(os.ttyname(0), os.O_RDWR)),  # makes it the one that hangs up
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

    def hang_up(self):
        os.close(self.theirs)
        os.close(self._ours)
        self._ours = -1

    def close(self):
        self.process.kill()
        self.process.wait()


@pytest.fixture
def terminal(tmp_path):
    terminal = Terminal(tmp_path)
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
    assert not list((tmp_path / "tmp").glob("drawbar-*"))
    assert termios.tcgetattr(terminal.theirs) == terminal.before


def test_a_terminal_that_is_closed_ends_a_drive_in_order(terminal, tmp_path):
    terminal.await_words("not ready to engage")
    terminal.hang_up()
    assert terminal.drain() == 0
    assert (tmp_path / "run" / "report.html").is_file()
    assert not list((tmp_path / "tmp").glob("drawbar-*"))
