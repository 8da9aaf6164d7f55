"""The gate at the edge of its own limits."""

import math

import pytest
from gate_bench import driving

from drawbar.messages import Action
from drawbar.safety import machine_gate
from drawbar.safety.causes import Cause
from drawbar.safety.engagement import ACTIVE, DEGRADED, ENGAGING, SELFTEST, STANDBY
from drawbar.safety.settings import SafetySettings

SETTINGS = SafetySettings()


def test_a_command_is_limited_five_times_in_a_row_before_it_counts():
    bench = driving()
    for wanted in (0.5, 0.5, 0.5, 0.5, None, 0.5, 0.5, 0.5, 0.5):
        bench.command = {"tractor_angle": bench.tractor.requests[-1][1].angle if wanted is None else wanted}
        bench.run()
        assert bench.state is ACTIVE
    bench.run()
    assert (bench.state is ACTIVE, bench.cause) == (False, Cause.COMMAND_LIMITED)


def test_the_speed_that_is_shared_while_degraded_is_that_of_the_command_of_the_same_tick():
    bench = driving()
    bench.controller, speed = {"tractor_quality": 4}, 2.0
    while bench.state is ACTIVE:
        speed += 0.0625
        bench.command = {"speed": speed}
        bench.run()
    assert (bench.state, bench.gate.speed_limit) == (DEGRADED, 0.5 * speed)


@pytest.mark.parametrize(("late", "state"), [(SETTINGS.timing.late, True), (SETTINGS.timing.late + 1e-9, False)])
def test_a_tick_may_come_as_late_as_is_set(late, state):
    bench = driving()
    bench.late = late
    assert (bench.run().state is ACTIVE) is state


@pytest.mark.parametrize(("further", "state"), [(0.0, True), (0.25, False)])
def test_the_computer_may_have_been_suspended_for_as_long_as_is_set(monkeypatch, further, state):
    monkeypatch.setattr(machine_gate, "suspended_time", lambda: 8.0)
    bench = driving()
    monkeypatch.setattr(machine_gate, "suspended_time", lambda: 8.0 + SETTINGS.timing.suspended + further)
    assert (bench.run().state is ACTIVE) is state


def limited(bench):
    bench.command = {"tractor_angle": 0.6}
    bench.run(0.5)
    assert bench.cause is Cause.COMMAND_LIMITED


def stuck(bench):
    bench.tractor.takes, bench.tractor.changes["engaged"] = False, True
    bench.command = {"tractor_angle": 0.1}
    bench.run(1.0)
    assert bench.cause is Cause.STEERING_STUCK


@pytest.mark.parametrize("end", [limited, stuck])
def test_what_ended_a_drive_does_not_end_the_next_one(end):
    bench = driving()
    end(bench)
    bench.speed = 0.0
    bench.run(1.5)
    bench.tractor.takes, bench.tractor.changes, bench.tractor.angle, bench.command = True, {}, 0.0, {}
    bench.ask(Action.ACKNOWLEDGE)
    bench.run()
    assert bench.state in (STANDBY, SELFTEST)
    bench.speed, bench.follows = 1.0, False
    bench.run(12.0).engage().run()
    assert (bench.state, bench.cause) == (ENGAGING, None)
    bench.follows = True
    assert bench.run(2.0).state is ACTIVE


def test_a_steering_is_judged_from_the_slowest_speed_on_at_which_it_engages():
    def sees(speed):
        bench = driving()
        bench.speed = speed
        bench.run(1.0)
        bench.tractor.takes, bench.tractor.changes["engaged"] = False, True
        bench.command = {"tractor_angle": 0.1}
        bench.run(1.0)
        return bench.cause is Cause.STEERING_STUCK

    assert sees(SETTINGS.engage.speed)
    assert not sees(math.nextafter(SETTINGS.engage.speed, 0.0))
