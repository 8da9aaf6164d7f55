"""The operator at a terminal: what is shown of a drive, keys, and speeds that are asked for."""

import dataclasses
import math
import os
import signal
import termios
from io import StringIO
from types import SimpleNamespace

import pytest
from drive_messages import controller_of, gate_of, ready_gate
from rich.console import Console

from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.process_options import FRONT_END, GATE
from drawbar.driving.operator.display import KEYS, picture, refusals
from drawbar.driving.operator.front_end import REFUSED, FrontEnd, Keyboard
from drawbar.driving.operator.requests import changed_speed
from drawbar.driving.operator.terminal import Terminal
from drawbar.messages import OperatorMessage, SupervisorState
from drawbar.messages.records import decode, encode
from drawbar.safety.causes import Cause
from drawbar.safety.conditions import Observation, present
from drawbar.safety.settings import SafetySettings
from drawbar.signals import FixQuality, Status

NAN = math.nan


class Said:
    """Processes that have written some lines."""

    by_name = ("receivers", "recorder")

    def __init__(self, *lines):
        self.lines = list(lines)

    def output(self):
        return self.lines


def test_the_display_fits_sixty_columns_without_a_machine():
    console = Console(width=60, file=None, record=True, force_terminal=False)
    with console.capture() as capture:
        console.print(picture(None, None))
    assert all(len(line) <= 60 for line in capture.get().splitlines())
    assert KEYS.splitlines()[0] in capture.get()


def test_the_numbers_of_a_drive_fit_sixty_columns():
    known = {
        "tractor_lateral_error": -1.23,
        "trailer_lateral_error": 1.23,
        "wheel_speed": 12.5,
        "correction_age": 120.0,
    }
    worst = {"tractor_quality": FixQuality.DIFFERENTIAL, "trailer_quality": FixQuality.DIFFERENTIAL}
    heard = dataclasses.replace(controller_of(Status.OK), **known, **worst)
    assert all(len(line) <= 60 for line in picture(gate_of(SupervisorState.ACTIVE), heard).plain.splitlines())


def test_the_driver_is_told_to_stop_until_the_vehicle_stands():
    stopping = dataclasses.replace(gate_of(SupervisorState.FAULT), stop=1)
    for wheels, receiver, told in ((1.0, 0.0, True), (0.0, 1.0, False), (NAN, 0.0, False), (NAN, NAN, True)):
        speeds = {"wheel_speed": wheels, "receiver_speed": receiver}
        heard = dataclasses.replace(controller_of(Status.OK), correction_age=NAN, **speeds)
        assert ("STOP THE VEHICLE" in picture(stopping, heard).plain) == told
    assert "STOP THE VEHICLE" in picture(stopping, None).plain


def test_past_the_end_of_the_line_no_old_distance_is_shown():
    ended = dataclasses.replace(controller_of(Status.FINISHED), tractor_lateral_error=0.03)
    assert "tractor not known" in picture(gate_of(SupervisorState.STANDBY), ended).plain
    assert "tractor 3 cm left" in picture(gate_of(SupervisorState.STOPPING), ended).plain


def test_a_refusal_is_shown_for_some_seconds_only(tmp_path):
    now = 10**12
    clock = SimpleNamespace(nanoseconds=lambda: now, wait=lambda endpoints, duration: None)
    options = SimpleNamespace(socket=lambda name: str(tmp_path / name), clock=clock)
    drive = SimpleNamespace(options=options, configuration=SimpleNamespace(speed=1.0))
    gate, front = Endpoint(options.socket(GATE)), FrontEnd(drive, demonstrates=False)
    front.press(" ")
    (stop,) = (decode(data, OperatorMessage) for data in gate.receive())
    answer = dataclasses.replace(ready_gate(1), answered=stop.nonce, answer=Cause.TOO_SLOW.value)
    gate.send(options.socket(FRONT_END), encode(answer))
    for later, shown in ((0, Cause.TOO_SLOW), (REFUSED, Cause.TOO_SLOW), (REFUSED + 1, None)):
        now = 10**12 + later
        front.wait(0.0)
        assert front.refusal is shown
    front.close()
    gate.close()


@pytest.mark.parametrize("heard", [None, controller_of(Status.FINISHED)])
def test_of_a_silent_controller_only_that_is_said(heard):
    codes = [cause.value for cause in present(Observation(operator_age=0.0), SafetySettings())][:8]
    assert Cause.CONTROLLER_SILENT.value in codes
    state = dataclasses.replace(ready_gate(1), state=SupervisorState.STANDBY, refusals=tuple(codes), time=5 * 10**9)
    assert refusals(state, heard) == [Cause.CONTROLLER_SILENT]
    newer = dataclasses.replace(state, since=state.time - 19 * 10**8)
    assert refusals(newer, heard) == ([Cause.CONTROLLER_SILENT] if heard else []), "it cannot have reported yet"
    older = dataclasses.replace(state, since=state.time - 2 * 10**9)
    assert refusals(older, heard) == [Cause.CONTROLLER_SILENT]
    codes.remove(Cause.CONTROLLER_SILENT.value)
    assert Cause.CORRECTIONS_OLD in refusals(dataclasses.replace(state, refusals=(*codes, 0)), None)


@pytest.mark.parametrize("state", [SupervisorState.BOOT, SupervisorState.SELFTEST])
def test_nothing_stands_against_engaging_while_the_gate_tests_itself(state):
    codes = (Cause.CONTROLLER_SILENT.value, Cause.NO_OPERATOR.value, *[0] * 6)
    assert refusals(dataclasses.replace(ready_gate(1), state=state, refusals=codes, time=5 * 10**9), None) == []


@pytest.mark.parametrize("lacking", [Cause.RECEIVER_SILENT, Cause.RECEIVER_TIMES])
def test_of_a_receiver_that_is_lacking_only_that_is_said(lacking):
    follows = (Cause.OFF_LINE, Cause.FIX_LOST, Cause.FIX_TOO_NEW, Cause.CORRECTIONS_OLD, Cause.UNSOLVED)
    codes = (*(cause.value for cause in follows), Cause.WIGGLE_UNTRIED.value, 0, 0)
    state = dataclasses.replace(ready_gate(1), state=SupervisorState.STANDBY, refusals=codes)
    heard = dataclasses.replace(controller_of(Status.OK), notices=(lacking.value, *[0] * 7))
    assert refusals(state, heard) == [Cause.WIGGLE_UNTRIED]
    assert set(follows) <= set(refusals(state, controller_of(Status.OK)))


def test_who_only_looks_on_is_told_of_no_trial_before_steering_and_of_no_cable_where_boards_report_no_angle():
    angles = (Cause.STEERING_OLD, Cause.STEERING_LOST, Cause.STEERING_APART)
    causes = (*angles, Cause.SHADOW, Cause.EMERGENCY_UNTRIED, Cause.WIGGLE_UNTRIED)
    refused = (*(cause.value for cause in causes), 0, 0)
    reported = dataclasses.replace(
        ready_gate(1), state=SupervisorState.STANDBY, refusals=refused, tractor_angle_time=7, trailer_angle_time=7
    )
    never = dataclasses.replace(reported, trailer_angle_time=0)
    steers = dataclasses.replace(never, refusals=tuple(0 if code == Cause.SHADOW.value else code for code in refused))
    heard = controller_of(Status.OK)
    assert refusals(never, heard) == [Cause.SHADOW]
    assert refusals(reported, heard) == [*angles, Cause.SHADOW]
    assert refusals(steers, heard) == [cause for cause in causes if cause is not Cause.SHADOW]


def test_the_display_says_why_a_key_was_refused():
    assert Cause.OUT_OF_RANGE.sentence in picture(None, None, Cause.OUT_OF_RANGE).plain


def test_what_the_controller_tells_of_sensors_is_shown_with_what_to_do():
    cause = Cause.YAW_REJECTED
    heard = dataclasses.replace(controller_of(Status.OK), notices=(cause.value, *[0] * 7))
    line = f"- {cause.sentence}: {cause.advice}"
    for state in (SupervisorState.READY, SupervisorState.ACTIVE, SupervisorState.STOPPED):
        assert line in picture(gate_of(state), heard).plain
        front = SimpleNamespace(state=gate_of(state), controller=heard, refusal=None)
        console = Console(file=StringIO(), width=60)
        terminal = Terminal(console, Said(), front)
        terminal.show()
        terminal.show()
        assert console.file.getvalue().count(line) == 1


def test_where_there_is_no_terminal_each_reason_against_engaging_or_warning_is_printed_once():
    causes = (Cause.FIX_LOST, Cause.NO_OPERATOR)
    states = [
        dataclasses.replace(
            ready_gate(sequence),
            state=state,
            steers=int(state is SupervisorState.ACTIVE),
            refusals=tuple(cause.value for cause in found) + (0,) * (8 - len(found)),
        )
        for sequence, (state, found) in enumerate(
            [
                (SupervisorState.STANDBY, causes[:1]),
                (SupervisorState.STANDBY, causes),
                (SupervisorState.STANDBY, causes[1:]),
                (SupervisorState.READY, ()),
                (SupervisorState.STANDBY, causes[:1]),
                (SupervisorState.ACTIVE, ()),
                (SupervisorState.ACTIVE, (Cause.TOO_SLOW, causes[0])),  # too slow to engage is no warning then
                (SupervisorState.ACTIVE, causes[:1]),
                (SupervisorState.FAULT, causes),
            ]
        )
    ]
    console, front = Console(file=StringIO(), width=60), SimpleNamespace(state=None, controller=None, refusal=None)
    terminal = Terminal(console, Said(), front)
    for front.state in states:
        terminal.show()
    first, second = (f"- {cause.sentence}: {cause.advice}\n" for cause in causes)
    waiting, ready = "STANDBY: not ready to engage\n", "READY: ready to engage\n"
    steering, ended = "ACTIVE: steering\n", "FAULT: steering released; acknowledge to continue\n"
    told = [waiting, first, second, ready, waiting, first, steering, first, ended]
    assert console.file.getvalue() == "".join(told)


def test_what_processes_say_is_told_once():
    said = Said("receivers: not allowed: SCHED_FIFO")
    console, front = Console(file=StringIO(), width=60), SimpleNamespace(state=None, controller=None, refusal=None)
    terminal = Terminal(console, said, front)
    refusal = "receivers: the caster refuses the user name or the password (401); next attempt in 60 s [/]"
    said.lines += ["Traceback (most recent call last):", "KeyError: 3", refusal]
    terminal.show()
    terminal.show()
    assert console.file.getvalue() == f"{refusal}\n"


@pytest.mark.skipif(os.name == "nt", reason="POSIX terminals")
def test_no_key_waits_for_the_next_one(monkeypatch):
    far, near = os.openpty()
    with open(near, encoding="utf-8") as terminal, open(far, "wb", buffering=0) as keys:
        monkeypatch.setattr("sys.stdin", terminal)
        with Keyboard() as keyboard:
            assert keyboard.pressed() == ""
            keys.write(b"+x")
            assert keyboard.pressed() == "+x"
            assert keyboard.pressed() == ""


@pytest.mark.skipif(os.name == "nt", reason="POSIX terminals")
def test_keys_act_at_once_when_a_shell_has_stopped_the_drive_and_continues_it(monkeypatch):
    far, near = os.openpty()
    with open(near, encoding="utf-8") as terminal, open(far, "wb", buffering=0) as keys:
        before = termios.tcgetattr(terminal)
        monkeypatch.setattr("sys.stdin", terminal)
        with Keyboard() as keyboard:
            termios.tcsetattr(terminal, termios.TCSANOW, before)  # as the shell does at Ctrl-Z
            signal.raise_signal(signal.SIGCONT)
            keys.write(b"x")
            assert keyboard.pressed() == "x"
        assert termios.tcgetattr(terminal) == before
        assert signal.getsignal(signal.SIGCONT) is signal.SIG_DFL


@pytest.mark.skipif(os.name == "nt", reason="POSIX terminals")
def test_no_key_is_pressed_on_a_terminal_that_is_gone(monkeypatch):
    far, near = os.openpty()
    with open(near, encoding="utf-8") as terminal:
        monkeypatch.setattr("sys.stdin", terminal)
        with Keyboard() as keyboard:
            assert keyboard.pressed() == ""
            assert not keyboard.is_gone
            os.close(far)
            assert keyboard.pressed() == ""
            assert keyboard.is_gone


@pytest.mark.parametrize(
    ("wish", "change", "asked"),
    [(NAN, -0.1, 0.9), (NAN, 0.1, 1.0), (0.5, 0.1, 0.6), (0.15, -0.1, 0.1), (0.1, -0.1, 0.1), (0.95, 0.1, 1.0)],
)
def test_set_speed_changes_between_a_step_and_the_configured_one(wish, change, asked):
    state = dataclasses.replace(ready_gate(1), set_speed=wish)  # which allows 0 m/s: it does not steer
    assert changed_speed(state, change, 1.0) == pytest.approx(asked)
