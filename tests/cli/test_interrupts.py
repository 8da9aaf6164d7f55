"""Signals that end what moves something: in order, each of them, and once."""

import os
import signal
import sys

import pytest

from drawbar.cli import interrupts
from drawbar.cli.interrupts import ended_by_signals
from drawbar.driving.preparation import check, push_calibration, wiggle

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP] if sys.platform != "win32" else []


@pytest.fixture(autouse=True)
def as_started_from_a_terminal():
    before = {each: signal.signal(each, signal.default_int_handler) for each in SIGNALS}  # none is ignored, as by nohup
    yield
    for each, handler in before.items():
        signal.signal(each, handler)


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_ends_it_and_further_ones_do_not_disturb_the_end(number, monkeypatch):
    monkeypatch.setattr(interrupts, "leave_a_terminal_that_is_gone", lambda: False)
    ended = []
    with pytest.raises(KeyboardInterrupt), ended_by_signals():  # noqa: PT012
        try:
            os.kill(os.getpid(), number)
        finally:
            for each in SIGNALS:
                os.kill(os.getpid(), each)
            ended.append(True)
    assert ended == [True]
    assert {signal.getsignal(each) for each in SIGNALS} == {signal.default_int_handler}


def test_a_hang_up_that_is_ignored_stays_so():
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with ended_by_signals():
        os.kill(os.getpid(), signal.SIGHUP)
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN


@pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
@pytest.mark.usefixtures("at_a_terminal")
@pytest.mark.parametrize(
    "command", [["calibrate", "{}", "--push"], ["check", "{}", "--wiggle"]], ids=lambda each: each[0]
)
def test_what_is_moved_is_ended_in_order_where_the_terminal_hangs_up(command, tmp_path, monkeypatch):
    from typer.testing import CliRunner

    from drawbar.cli.main import app
    from drawbar.config import load_configuration
    from drawbar.driving.preparation.finding import Finding
    from drawbar.driving.stand_in.demonstration import with_stand_ins

    machine, ended = with_stand_ins(load_configuration("articulated", ["machine.attitude.tractor.present=true"])), []
    (tmp_path / "my.toml").write_text(machine.to_toml(), "utf-8")

    def moved(*arguments):
        try:
            os.kill(os.getpid(), signal.SIGHUP)
            pytest.fail("it continues")
        finally:
            os.kill(os.getpid(), signal.SIGHUP)
            ended.append(True)

    class Closing:
        def __init__(self, *arguments):
            pass

        def close(self):
            pass

    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setattr(check, "check", lambda *arguments, **names: [Finding(device="all", received=True)])
    monkeypatch.setattr(wiggle, "wiggle_both", moved)
    monkeypatch.setattr(push_calibration, "ReceiverMotion", Closing)
    monkeypatch.setattr(push_calibration, "open_bare_valve", Closing)
    monkeypatch.setattr(push_calibration.PushCalibration, "run", moved)
    file = str(tmp_path / "my.toml")
    result = CliRunner().invoke(app, [each.format(file) for each in command], input="y\ny\n")
    assert (ended, result.exit_code) == ([True], 130), result.output
