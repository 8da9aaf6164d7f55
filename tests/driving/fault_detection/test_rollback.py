"""Rollback: the last seconds computed again without what has turned out to be wrong."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from drawbar.driving.fault_detection.rollback import SPAN, Rollback
from drawbar.signals import Command, Measurement, Status
from drawbar.simulation import Simulation
from drawbar.step.autopilot import Autopilot

KEPT = 10


def deaf(measurement: Measurement) -> Measurement:
    return replace(measurement, hitch_angle=math.nan)


@pytest.fixture
def driven(build: Callable[..., Simulation]) -> tuple[Rollback, Autopilot, list[tuple[Measurement, Command]]]:
    """Return the rollback of an autopilot that has driven for 6 s, the autopilot, what it was given and answered."""
    simulation = build("articulated", "path.radii=[5.0]")
    autopilot, given = simulation.autopilot, []
    rollback = Rollback(autopilot, SPAN / KEPT)
    autopilot.begin(simulation.path)
    for _ in range(30):
        measurement = simulation.machine.read()
        _, command = rollback.feedback(measurement)
        simulation.machine.write(command)
        autopilot.prepare()
        given.append((measurement, command))
    return rollback, autopilot, given


def test_the_same_again_is_the_same(driven) -> None:
    rollback, autopilot, given = driven
    before = autopilot.record()
    rollback.recompute(lambda measurement: measurement)
    after = autopilot.record()
    assert (after.estimate, after.command) == (before.estimate, before.command)
    assert after.step == before.step  # a log in which numbers are missing has lost steps
    assert autopilot.feedback(given[-1][0]) is not None


def test_after_a_rollback_it_is_as_if_it_had_never_been_given_what_is_excluded(driven) -> None:
    rollback, autopilot, given = driven
    remembered, *_ = rollback._samples[0]
    bent = autopilot.record().estimate
    rollback.recompute(deaf)
    found = autopilot.record()
    autopilot.recall(remembered)
    for measurement, sent in given[-KEPT:-1]:
        autopilot.feedback_again(deaf(measurement), sent)
        autopilot.prepare()
    autopilot.feedback(deaf(given[-1][0]))
    assert autopilot.record().estimate == found.estimate
    assert found.estimate != bent
    assert found.estimate.time == bent.time


def test_what_has_acted_are_the_commands_that_were_sent_not_those_of_the_other_estimate(driven) -> None:
    rollback, autopilot, given = driven
    *_, (measured, sent) = given

    def aside(measurement: Measurement) -> Measurement:
        return replace(measurement, tractor_y=measurement.tractor_y + 0.25, trailer_y=measurement.trailer_y + 0.25)

    status, command = rollback.recompute(aside)
    assert status is Status.OK
    assert command == autopilot.record().command
    assert abs(command.tractor_steering - sent.tractor_steering) > math.radians(2.0)
    steering = autopilot.record().estimate.tractor_steering
    assert steering == pytest.approx(measured.tractor_steering, abs=math.radians(0.5))


def test_what_is_forgotten_is_not_computed_again(driven) -> None:
    rollback, autopilot, _ = driven
    before = autopilot.record().estimate
    rollback.clear()
    assert rollback.recompute(deaf) is None
    assert autopilot.record().estimate == before
