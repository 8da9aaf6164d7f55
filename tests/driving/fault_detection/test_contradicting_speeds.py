"""Wheels whose encoder reports standing while the vehicle drives: the steering does not rest."""

import math
from dataclasses import fields

import pytest
from rehearsals import rehearse

from drawbar.driving.fault_detection.contradicting_speeds import ContradictingSpeeds
from drawbar.machine.stand_in.faults import FAULTS
from drawbar.messages import Fixes, SupervisorState
from drawbar.safety.causes import Cause


def epoch(wheels, ground):
    values = dict.fromkeys((field.name for field in fields(Fixes)), 0)
    return Fixes(**values | {"wheel_speed": wheels, "tractor_speed": ground})


@pytest.mark.parametrize(
    ("wheels", "ground", "found"),
    [
        (0.0, 2.0, True),
        (2.0, 0.0, True),
        (2.0, 3.9, True),
        (0.0, 0.25, False),
        (2.0, 1.4, False),
        (-0.8, 0.8, False),
        (math.nan, 0.8, False),
    ],
)
def test_more_than_slip_is_a_contradiction(wheels, ground, found):
    speeds = ContradictingSpeeds()
    speeds.receive_fixes(epoch(wheels, ground))
    assert speeds.found is found


def test_an_epoch_without_the_antennas_speed_changes_nothing():
    speeds = ContradictingSpeeds()
    for wheels, ground, found in [(0.0, math.nan, False), (0.0, 2.0, True), (2.0, math.nan, True), (2.0, 2.0, False)]:
        speeds.receive_fixes(epoch(wheels, ground))
        assert speeds.found is found


def test_wheels_that_report_standing_in_a_curve_cost_little_and_the_gate_stops():
    rehearsal, path = rehearse("speed=2.0", "path.straight_length=30.0", "safety.engage.fixed=1.0")
    near, far = 0.0, [0.0]

    def advance():
        nonlocal near
        rehearsal.advance()
        truth = rehearsal.machine.world.truth.tractor
        near, aside = path.project(truth.x, truth.y, near - 2.0, near + 4.0)
        far.append(abs(aside))

    while near < 13.0:  # a metre before the curve
        advance()
    assert rehearsal.gate_state.state is SupervisorState.ACTIVE
    FAULTS["wheel-speed-zero"].begin(rehearsal.machine)
    far.clear()
    while rehearsal.gate_state.state is not SupervisorState.STOPPED:
        advance()
    assert rehearsal.gate_state.cause == Cause.SPEEDS_CONTRADICT.value
    assert max(far) < 0.12
