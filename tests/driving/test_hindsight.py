"""Hindsight: the last seconds computed again without what has turned out to be wrong."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from drawbar.driving.hindsight import SPAN, Hindsight
from drawbar.signals import Measurement
from drawbar.simulation import Simulation
from drawbar.step.autopilot import Autopilot

KEPT = 10


def deaf(measurement: Measurement) -> Measurement:
    return replace(measurement, hitch_angle=math.nan)


@pytest.fixture
def driven(build: Callable[..., Simulation]) -> tuple[Hindsight, Autopilot, list[Measurement]]:
    """Return the hindsight of an autopilot that has driven for 6 s, the autopilot, and what it was given."""
    simulation = build("articulated", "path.radii=[5.0]")
    autopilot, given = simulation.autopilot, []
    hindsight = Hindsight(autopilot, SPAN / KEPT)
    autopilot.begin(simulation.path)
    for _ in range(30):
        measurement = simulation.machine.read()
        hindsight.keep(measurement)
        _, command = autopilot.feedback(measurement)
        simulation.machine.write(command)
        autopilot.prepare()
        given.append(measurement)
    return hindsight, autopilot, given


def test_the_same_again_is_the_same(driven) -> None:
    hindsight, autopilot, given = driven
    before = autopilot.record()
    hindsight.again(lambda measurement: measurement)
    after = autopilot.record()
    assert (after.estimate, after.command) == (before.estimate, before.command)
    assert autopilot.feedback(given[-1]) is not None


def test_with_hindsight_it_is_as_if_it_had_never_been_given_what_is_doubted(driven) -> None:
    hindsight, autopilot, given = driven
    remembered, _ = hindsight._samples[0]
    bent = autopilot.record().estimate
    hindsight.again(deaf)
    found = autopilot.record()
    autopilot.recall(remembered)
    for measurement in given[-KEPT:]:
        autopilot.feedback(deaf(measurement))
        autopilot.prepare()
    assert autopilot.record().estimate == found.estimate
    assert found.estimate != bent
    assert found.estimate.time == bent.time


def test_what_is_forgotten_is_not_computed_again(driven) -> None:
    hindsight, autopilot, _ = driven
    before = autopilot.record().estimate
    hindsight.forget()
    hindsight.again(deaf)
    assert autopilot.record().estimate == before
