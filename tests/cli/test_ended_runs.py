"""`drawbar run` that is interrupted, killed, broken or without a disk: exit code, one message, and what is kept."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import sleep
from typing import Any

import pytest
from short_run import FILES, SHORT, Drawbar

from drawbar.machine.simulated import SimulatedMachine
from drawbar.recording.log import read_log
from drawbar.report import folder as report_folder
from drawbar.signals import Command


@pytest.fixture
def break_after(monkeypatch: pytest.MonkeyPatch) -> Callable[[int, BaseException], None]:
    """Return a function that lets the machine raise when it is given its n-th command."""

    def break_after(steps: int, error: BaseException) -> None:
        whole, count = SimulatedMachine.write, iter(range(steps))

        def write(machine: SimulatedMachine, command: Command) -> None:
            if next(count, None) is None:
                raise error
            whole(machine, command)

        monkeypatch.setattr(SimulatedMachine, "write", write)

    return break_after


@pytest.mark.parametrize("steps", [0, 1, 40])
def test_ctrl_c_ends_a_run_with_its_report(
    drawbar: Drawbar, tmp_path: Path, break_after: Callable[..., None], steps: int
) -> None:
    break_after(steps, KeyboardInterrupt())
    code, _ = drawbar("run", *SHORT, "--out", "out")
    assert code == 130
    assert {file.name for file in (tmp_path / "out").iterdir()} == FILES
    assert len(read_log(tmp_path / "out" / "log.mcap").records) == steps


@pytest.fixture
def at_step(monkeypatch: pytest.MonkeyPatch) -> Callable[[int, Callable[[], None]], None]:
    """Return a function that lets something happen when the machine is given its n-th command."""

    def at_step(step: int, happens: Callable[[], None]) -> None:
        whole, count = SimulatedMachine.write, iter(range(10**6))

        def write(machine: SimulatedMachine, command: Command) -> None:
            if next(count) == step:
                happens()
            whole(machine, command)

        monkeypatch.setattr(SimulatedMachine, "write", write)

    return at_step


def hammer() -> None:
    """Hit Ctrl-C many times."""
    for _ in range(5):
        os.kill(os.getpid(), signal.SIGINT)
        sleep(0.001)


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_many_interrupts_end_a_run_after_its_step_with_its_report(
    drawbar: Drawbar, tmp_path: Path, at_step: Callable[..., None]
) -> None:
    at_step(40, hammer)
    code, said = drawbar("run", *SHORT, "--out", "out")
    assert code == 130
    assert "interrupted at the keyboard" in said
    assert {file.name for file in (tmp_path / "out").iterdir()} == FILES
    assert len(read_log(tmp_path / "out" / "log.mcap").records) == 41


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_interrupts_while_the_report_is_made_lose_nothing(
    drawbar: Drawbar, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, before = report_folder.render_page, signal.getsignal(signal.SIGINT)
    monkeypatch.setattr(report_folder, "render_page", lambda *given: (hammer(), whole(*given))[1])
    code, said = drawbar("run", *SHORT, "--out", "out")
    assert code == 0
    assert "report.html" in said
    assert {file.name for file in (tmp_path / "out").iterdir()} == FILES
    assert signal.getsignal(signal.SIGINT) is before


_TELLS = """
class Tell:  # that the command line is about to load
    def find_spec(self, name, path=None, target=None):
        if name == "drawbar.cli.main":
            print("loads", flush=True)
sys.meta_path.insert(0, Tell())
"""
_DROPPED = """
class Ends:  # what is raised in a destructor is dropped
    def __del__(self):
        signal.raise_signal(signal.SIGINT)
class Drop:
    def find_spec(self, name, path=None, target=None):
        if name == "drawbar.cli.main":
            print("loads", flush=True)
            Ends()
sys.meta_path.insert(0, Drop())
"""
_DROPPED_LATER = _DROPPED.replace("drawbar.cli.main", "drawbar.simulation")
_IN_CASADI = """
import casadi
def interrupt(*given, whole=casadi.DM_from_array):  # casadi drops what is raised here
    casadi.DM_from_array = whole
    print("builds", flush=True)
    signal.raise_signal(signal.SIGINT)
    return whole(*given)
casadi.DM_from_array = interrupt
"""


_ENDS = """
import atexit, drawbar.cli.main
def interrupted():
    drawbar.cli.main.typer.echo("interrupted", err=True)
    sys.exit(130)
drawbar.cli.main.main = interrupted
atexit.register(signal.raise_signal, signal.SIGINT)
"""


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_a_second_interrupt_while_python_ends_says_nothing_more() -> None:
    program = f"import signal, sys, drawbar.__main__ as program\n{_ENDS}\nprogram.main()"
    heed = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    ended = subprocess.run(
        [sys.executable, "-c", program], check=False, capture_output=True, text=True, preexec_fn=heed
    )
    assert (ended.returncode, ended.stderr) == (130, "interrupted\n")


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
@pytest.mark.parametrize(
    ("prepare", "seconds"),
    [(_TELLS, 0.0), (_TELLS, 0.2), (_TELLS, 0.8), (_DROPPED, None), (_DROPPED_LATER, None), (_IN_CASADI, None)],
    ids=["at once", "0.2 s", "0.8 s", "dropped", "dropped later", "in casadi"],
)
def test_an_interrupt_while_the_program_loads_is_one_line(tmp_path: Path, prepare: str, seconds: float | None) -> None:
    program = f"import signal, sys, drawbar.__main__ as program\n{prepare}\nprogram.main()"
    command = [sys.executable, "-c", program, "run", "--set=speed=0.05", "--out=out"]
    heed = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    environment = {**os.environ, "DRAWBAR_CACHE": str(tmp_path / "cache")}  # it has to compile: the run has not begun
    with subprocess.Popen(command, cwd=tmp_path, env=environment, preexec_fn=heed, **pipes) as process:
        assert process.stdout is not None
        process.stdout.readline()  # before, it is Python's own start
        if seconds is not None:
            sleep(seconds)
            process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=300)
    assert process.returncode in (130, -signal.SIGINT)  # a shell shows 130 for both
    assert "Traceback" not in said
    assert [line for line in said.splitlines() if "interrupted" in line]
    assert len(said.splitlines()) <= 2, said
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(os.name == "nt", reason="POSIX limits")
@pytest.mark.parametrize("held_back", [0, 20_000_000])
def test_a_full_disk_is_one_message_and_the_log_is_kept(
    drawbar: Drawbar, tmp_path: Path, at_step: Callable[..., None], monkeypatch: pytest.MonkeyPatch, held_back: int
) -> None:
    import resource

    monkeypatch.setattr("drawbar.recording.recorder._HELD_BACK", held_back)

    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    log = tmp_path / "out" / "log.mcap"
    # no file may grow beyond what the log is now: what a full disk does, with another text
    at_step(40, lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (log.stat().st_size, hard)))
    try:
        code, said = drawbar("run", *SHORT, "--out", "out")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert code == 2
    message = " ".join(said.split("error:")[1].split())
    told = re.search(
        r"the log cannot be written any further \(File too large\); its first (\d+) steps or more", message
    )
    assert told, message
    kept, found = int(told[1]), len(read_log(log).records)
    assert 0 < kept <= found <= 40
    assert held_back or kept == found == 40
    assert "drawbar report" in message
    assert "Traceback" not in said


def test_the_figures_are_shown_though_the_report_cannot_be_written(drawbar: Drawbar, tmp_path: Path) -> None:
    assert drawbar("run", *SHORT, "--out", "out")[0] == 0
    (tmp_path / "taken").touch()
    code, said = drawbar("report", "out", "--out", "taken")
    assert code == 2
    figures, _, error = said.partition("error: ")
    assert "estimator, feedback" in figures
    assert "the report's metrics.json, report.html, map.svg cannot be written (File exists)" in " ".join(error.split())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
def test_a_disk_that_is_full_from_the_start_is_one_message(drawbar: Drawbar, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "log.mcap").symlink_to("/dev/full")
    code, said = drawbar("run", *SHORT, "--out", "out", "--force")
    assert code == 2
    assert "log.mcap: cannot be written (No space left on device)" in " ".join(said.split())


def test_a_crash_leaves_a_log_up_to_the_last_step(
    drawbar: Drawbar, tmp_path: Path, break_after: Callable[..., None]
) -> None:
    break_after(40, RuntimeError("broken"))
    with pytest.raises(RuntimeError, match="broken"):
        drawbar("run", *SHORT, "--out", "out")
    log = read_log(tmp_path / "out" / "log.mcap")
    assert len(log.records) == 40
    assert not log.outcome.finished
    assert log.outcome.reason == "RuntimeError: broken"


ENDINGS = [(signal.SIGINT, 130), (signal.SIGTERM, 130), (signal.SIGKILL, -signal.SIGKILL)]


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
@pytest.mark.parametrize(("sent", "code"), ENDINGS)
def test_a_process_that_is_stopped_leaves_a_readable_log(tmp_path: Path, sent: signal.Signals, code: int) -> None:
    # a tiny speed, so that the run would continue for hours
    command = [
        sys.executable,
        "-c",
        "from drawbar.cli.main import main; main()",
        "run",
        "--set=speed=0.05",
        "--out=out",
    ]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    # a shell's background job ignores the interrupt, and so would its children
    heed = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    with subprocess.Popen(command, cwd=tmp_path, preexec_fn=heed, **pipes) as process:
        log = tmp_path / "out" / "log.mcap"
        while process.poll() is None and not (log.exists() and log.stat().st_size > 500_000):
            sleep(0.02)
        process.send_signal(sent)
        process.communicate(timeout=300)
    assert process.returncode == code
    assert len(read_log(log).records) > 10
    assert (tmp_path / "out" / "report.html").exists() == (sent != signal.SIGKILL)
