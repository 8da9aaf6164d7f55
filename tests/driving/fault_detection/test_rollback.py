"""Rollback: the last seconds computed again without what has turned out to be wrong."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from drawbar.driving.fault_detection.rollback import SPAN, Rollback
from drawbar.signals import Measurement
from drawbar.simulation import Simulation
from drawbar.step.autopilot import Autopilot

KEPT = 10


def deaf(measurement: Measurement) -> Measurement:
    return replace(measurement, hitch_angle=math.nan)


@pytest.fixture
def driven(build: Callable[..., Simulation]) -> tuple[Rollback, Autopilot, list[Measurement]]:
    """Return the rollback of an autopilot that has driven for 6 s, the autopilot, and what it was given."""
    simulation = build("articulated", "path.radii=[5.0]")
    autopilot, given = simulation.autopilot, []
    rollback = Rollback(autopilot, SPAN / KEPT)
    autopilot.begin(simulation.path)
    for _ in range(30):
        measurement = simulation.machine.read()
        rollback.keep(measurement)
        _, command = autopilot.feedback(measurement)
        simulation.machine.write(command)
        autopilot.prepare()
        given.append(measurement)
    return rollback, autopilot, given


def test_the_same_again_is_the_same(driven) -> None:
    rollback, autopilot, given = driven
    before = autopilot.record()
    rollback.recompute(lambda measurement: measurement)
    after = autopilot.record()
    assert (after.estimate, after.command) == (before.estimate, before.command)
    assert autopilot.feedback(given[-1]) is not None


def test_after_a_rollback_it_is_as_if_it_had_never_been_given_what_is_excluded(driven) -> None:
    rollback, autopilot, given = driven
    remembered, _ = rollback._samples[0]
    bent = autopilot.record().estimate
    rollback.recompute(deaf)
    found = autopilot.record()
    autopilot.recall(remembered)
    for measurement in given[-KEPT:]:
        autopilot.feedback(deaf(measurement))
        autopilot.prepare()
    assert autopilot.record().estimate == found.estimate
    assert found.estimate != bent
    assert found.estimate.time == bent.time


def test_what_is_forgotten_is_not_computed_again(driven) -> None:
    rollback, autopilot, _ = driven
    before = autopilot.record().estimate
    rollback.clear()
    rollback.recompute(deaf)
    assert autopilot.record().estimate == before
