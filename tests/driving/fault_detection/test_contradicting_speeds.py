"""Wheels whose encoder reports standing while the vehicle drives: the steering does not rest."""

import math

import pytest
from fixes import fixes_of
from rehearsals import rehearse

from drawbar.driving.fault_detection.contradicting_speeds import ContradictingSpeeds
from drawbar.machine.stand_in.faults import FAULTS
from drawbar.messages import SupervisorState
from drawbar.safety.causes import Cause


def epoch(wheels, ground, time=0.0):
    return fixes_of(wheel_speed=wheels, tractor_speed=ground, wheel_speed_time=round(time * 1e9))


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


@pytest.mark.parametrize(
    ("speed_at", "ground", "found"),
    [
        (lambda t: 2.0 if t < 1.0 else 0.0, math.nan, True),
        (lambda t: 2.0 if t < 1.0 else 0.2 if t < 1.5 else 0.0, math.nan, True),
        (lambda t: 2.0 if t < 1.0 else math.nan if t < 1.2 else 0.0, math.nan, True),
        (lambda t: max(2.0 - 2.5 * max(t - 1.0, 0.0), 0.0), math.nan, False),
        (lambda t: 2.0 if t < 1.0 else 0.5, math.nan, False),
        (lambda t: 0.4 if t < 1.0 else 0.0, math.nan, False),
        (lambda t: 2.0 if t < 1.0 else math.nan if t < 1.8 else 0.0, math.nan, False),
        (lambda t: 2.0 if t < 1.0 else 0.0, 0.1, False),
    ],
)
def test_wheels_that_stop_at_once_while_no_receiver_tells_a_speed_are_not_believed(speed_at, ground, found):
    speeds = ContradictingSpeeds()
    for tick in range(40):
        speeds.receive_fixes(epoch(speed_at(0.05 * tick), ground, 0.05 * tick))
    assert speeds.found is found


def farthest(begin, ends):
    """Return the largest distance of the tractor from the line, m, from a fault before the curve to a state."""
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
    far.clear()
    begin(rehearsal, advance)
    while rehearsal.gate_state.state is not ends:
        advance()
    return max(far), rehearsal.gate_state.cause


def test_wheels_that_report_standing_in_a_curve_cost_little_and_the_gate_stops():
    far, cause = farthest(
        lambda rehearsal, advance: FAULTS["wheel-speed-zero"].begin(rehearsal.machine), SupervisorState.STOPPED
    )
    assert cause == Cause.SPEEDS_CONTRADICT.value
    assert far < 0.12


def test_wheels_that_report_standing_while_no_receiver_is_heard_cost_little():
    """Up to 1.3 m beside the line before, for as long as it may be driven degraded."""

    def begin(rehearsal, advance):
        FAULTS["receivers-silent"].begin(rehearsal.machine)
        since = rehearsal.time
        while rehearsal.time < since + 1.0:
            advance()
        FAULTS["wheel-speed-zero"].begin(rehearsal.machine)

    far, cause = farthest(begin, SupervisorState.STOPPING)
    assert cause == Cause.POSITION_LOST.value
    assert far < 0.12
