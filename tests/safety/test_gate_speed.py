"""The gate and a speed actuator: what it is asked for, and what its release means."""

import pytest
from gate_bench import Bench, driving

from drawbar.messages import Mode
from drawbar.safety.causes import Cause
from drawbar.safety.engagement import ACTIVE, DEGRADED, ENGAGING, FAULT, STANDBY, STOPPING


def test_a_vehicle_with_a_speed_actuator_begins_standing():
    bench = Bench(speed_actuator=True)
    bench.speed = 0.0
    bench.drive()
    assert bench.state is ACTIVE
    assert next(r.speed for _, r in bench.speed_actuator.requests if r.drive) == 0.0
    assert Bench(speed_actuator=True).ready().speed_actuator.requests[-1][1].drive is False
    standing = Bench()
    standing.speed = 0.0
    standing.ready()
    assert standing.state is STANDBY
    assert Cause.TOO_SLOW.value in standing.shown.refusals


@pytest.mark.parametrize("speed", [1.7, -0.8])
def test_a_vehicle_that_is_engaged_while_it_drives_goes_on_as_fast_until_its_first_command(speed):
    bench = Bench(speed_actuator=True)
    bench.speed = speed
    bench.ready()
    bench.follows = False  # the controller has not yet heard of it
    bench.engage().run(0.5)
    assert bench.state is ENGAGING
    assert {r.speed for _, r in bench.speed_actuator.requests if r.drive} == {speed}


def test_a_reverse_command_is_slowed_in_its_direction():
    bench = driving(speed_actuator=True)
    bench.command, bench.speed = {"speed": -1.0}, -1.0
    bench.run(0.5)
    bench.controller = {"tractor_quality": 4}
    bench.run(0.6)
    assert bench.state is DEGRADED
    assert bench.speed_actuator.requests[-1][1].speed == -0.5


def test_a_degraded_vehicle_keeps_to_the_share_of_the_speed_that_it_had():
    bench = driving(speed_actuator=True)
    bench.command = {"speed": 2.0}
    bench.run(0.2)
    bench.controller = {"tractor_quality": 4}
    bench.run(0.6)
    assert (bench.state, bench.shown.speed_limit) == (DEGRADED, 1.0)
    bench.command = {"speed": 1.5}
    bench.run(0.2)
    assert bench.shown.speed_limit == 1.0
    assert bench.speed_actuator.requests[-1][1].speed == 1.0


@pytest.mark.parametrize("controller", [{}, {"tractor_quality": 4}])
def test_a_speed_actuator_that_releases_while_it_is_to_drive_is_a_fault(controller):
    bench = driving(speed_actuator=True)
    bench.controller = controller
    bench.run(0.6)
    bench.speed_actuator.changes = {"engaged": False}
    bench.run()
    assert (bench.state, bench.cause) == (FAULT, Cause.ACTUATOR_RELEASED)


def test_a_speed_actuator_that_has_stopped_the_vehicle_may_release():
    bench = driving(speed_actuator=True)
    bench.command = {"mode": Mode.STOP}
    bench.run(0.2)
    assert bench.state is STOPPING
    bench.speed_actuator.changes = {"engaged": False}
    bench.run(0.5)
    assert bench.state is STOPPING
