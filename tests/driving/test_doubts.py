"""Doubts: sensors that contradict the motion are left out until the vehicle has been let go of."""

import math
from types import SimpleNamespace

import pytest

from drawbar.driving.doubts import DOUBTED, Doubts
from drawbar.safety.sanity import SanitySettings
from drawbar.signals import FixStatus, Measurement, SolverStatus

SEEN = Measurement(
    time=0.0,
    tractor_x=1.0,
    tractor_y=2.0,
    trailer_x=3.0,
    trailer_y=4.0,
    hitch_angle=0.1,
    speed=1.0,
    tractor_steering=0.0,
    trailer_steering=0.0,
)


def step(hitch=0.1, fixes=(FixStatus.ACCEPTED, FixStatus.ACCEPTED), status=SolverStatus.SOLVED):
    estimate = SimpleNamespace(hitch_angle=hitch, tractor_fix=fixes[0], trailer_fix=fixes[1], status=status)
    return SimpleNamespace(measurement=SEEN, estimate=estimate)


def doubts(record, times=DOUBTED, *, engaged=True):
    found = Doubts(SanitySettings())
    for _ in range(times):
        found.look(record, engaged=engaged)
    return found


REJECTED = (FixStatus.REJECTED, FixStatus.REJECTED)


def test_positions_that_both_antennas_contradict_are_left_out_while_engaged():
    assert not doubts(step(fixes=REJECTED), DOUBTED - 1).exist
    assert not doubts(step(fixes=(FixStatus.REJECTED, FixStatus.ACCEPTED))).exist
    found = doubts(step(fixes=REJECTED))
    without = found.without(SEEN)
    assert all(map(math.isnan, (without.tractor_x, without.tractor_y, without.trailer_x, without.trailer_y)))
    assert without.hitch_angle == 0.1
    found.look(step(), engaged=True)
    assert found.exist
    found.look(step(), engaged=False)
    assert not found.exist
    assert found.without(SEEN) == SEEN


def test_positions_that_drift_are_left_out_while_engaged():
    found = Doubts(SanitySettings())
    found.look(step(), engaged=True, drifts=True)
    assert math.isnan(found.without(SEEN).tractor_x)
    found.look(step(), engaged=True)
    assert found.exist
    found.look(step(), engaged=False)
    assert not found.exist


def test_a_hitch_angle_that_contradicts_is_left_out_and_what_it_did_to_the_positions_is_forgiven():
    found = doubts(step(hitch=0.3, fixes=REJECTED))
    without = found.without(SEEN)
    assert math.isnan(without.hitch_angle)
    assert without.tractor_x == 1.0
    found.look(step(fixes=REJECTED), engaged=True)
    assert found.without(SEEN).tractor_x == 1.0
    found.look(step(), engaged=False)
    assert not found.exist


@pytest.mark.parametrize(
    "record", [step(hitch=0.2), step(hitch=math.nan), step(hitch=0.5, status=SolverStatus.NOT_FINITE)]
)
def test_what_is_near_missing_or_not_estimated_is_no_contradiction(record):
    assert not doubts(record).exist
