"""The guard: when the boards are to be released because the gate is not heard."""

import math
from dataclasses import fields

import pytest

from drawbar.driving.processes.guard_main import Guard
from drawbar.messages import GateState, SupervisorState
from drawbar.safety.settings import TimingSettings

TIMING = TimingSettings()


def state(*, steers):
    values = dict.fromkeys((field.name for field in fields(GateState)), 0)
    return GateState(**(values | {"steers": int(steers), "state": SupervisorState.ACTIVE, "refusals": (0,) * 8}))


def off_frames(guard, begin, end):
    return [time for time in (begin + 0.01 * k for k in range(round((end - begin) / 0.01))) if guard.says_off(time)]


def test_a_gate_that_is_heard_or_does_not_steer_is_left_alone():
    guard = Guard(TIMING)
    assert guard.due == math.inf
    assert off_frames(guard, 0.0, 5.0) == []
    for tick in range(100):
        guard.receive_state(0.05 * tick, state(steers=True))
        assert not guard.says_off(0.05 * tick + 0.18)
        assert not guard.rests(0.05 * tick)
    guard.receive_state(5.0, state(steers=False))
    assert guard.rests(5.0)
    assert off_frames(guard, 5.0, 9.0) == []


def test_a_gate_that_steers_and_falls_silent_is_spoken_for_for_a_second():
    guard = Guard(TIMING)
    guard.receive_state(10.0, state(steers=True))
    assert guard.due == pytest.approx(10.19)
    frames = off_frames(guard, 10.0, 14.0)
    assert frames[0] == pytest.approx(10.19, abs=0.011)
    assert 9 <= len(frames) <= 11
    assert frames[-1] <= 11.2
    assert not guard.rests(11.15)
    assert guard.rests(11.25)
    assert guard.due == math.inf


def test_a_gate_that_comes_back_speaks_for_itself():
    guard = Guard(TIMING)
    guard.receive_state(10.0, state(steers=True))
    assert guard.says_off(10.2)
    guard.receive_state(10.21, state(steers=True))
    assert off_frames(guard, 10.21, 10.39) == []
    assert guard.says_off(10.41)
    assert not guard.says_off(math.nan)
