"""The record of a tick: every field of it, for states that were set by hand."""

import math
from dataclasses import replace

import pytest

from drawbar.messages import SupervisorState
from drawbar.protocols.actuator import Readiness, SteeringReport
from drawbar.protocols.speed_actuator import SpeedReport
from drawbar.safety.causes import BY_READINESS, Cause
from drawbar.safety.engagement import ACTIVE, ENGAGING, ESTOP, FAULT, READY, STEERING, STOPPED, STOPPING, Engagement
from drawbar.safety.gate_report import Actuation, Counts, Tick, gate_state
from drawbar.safety.operator_requests import OperatorRequests
from drawbar.safety.settings import SafetySettings

SETTINGS = SafetySettings()
ACTUATION = Actuation(
    tractor=SteeringReport(angle=0.1, angle_time=99.9, engaged=True),
    trailer=SteeringReport(angle=-0.2, angle_time=99.8),
    speed=SpeedReport(engaged=True),
)
TICK = Tick(now=100.0, causes=(), actuation=ACTUATION, angles=(0.11, -0.21), speed_limit=1.5)
DRIVING, BEFORE = Cause.COMMAND_LIMITED, Cause.UNPROVED  # the one counts while driving alone, the other before it


def report(state, tick=TICK, counts=None, *, since=98.0, cause=None, concerned=0, **requested):
    """Return the record of a tick in a state."""
    engagement = Engagement(SETTINGS)
    engagement.state, engagement.since, engagement.cause, engagement.concerned = state, since, cause, concerned
    requests = OperatorRequests(SETTINGS, engagement)
    for name, value in requested.items():
        setattr(requests, name, value)
    return gate_state(tick, engagement, requests, counts or Counts(), valid=0.5)


def test_it_says_when_it_was_made_and_how_long_it_counts_and_what_the_gate_does():
    shown = report(ACTIVE, counts=Counts(states=4, clips=3, rejects=2, dropped=1), cause=Cause.OPERATOR_STOPS)
    assert (shown.time, shown.valid_until, shown.since) == (100 * 10**9, 100_500_000_000, 98 * 10**9)
    assert (shown.sequence, shown.clips, shown.rejects, shown.dropped) == (4, 3, 2, 1)
    assert (shown.state, shown.steers, shown.cause, shown.speed_limit) == (ACTIVE, 1, Cause.OPERATOR_STOPS.value, 1.5)
    assert report(READY).cause == 0
    assert (report(READY).concerned, report(FAULT, concerned=6).concerned) == (0, 6)


def test_its_counts_are_of_32_bits_and_begin_again():
    highest = 2**32 - 1
    given = [Counts(), *(Counts(*(highest + beyond,) * 4) for beyond in (0, 1, 2**32 + 6))]
    for counts, shown in zip(given, (0, highest, 0, 5), strict=True):
        state = report(ACTIVE, counts=counts)
        assert (state.sequence, state.clips, state.rejects, state.dropped) == (shown,) * 4


@pytest.mark.parametrize("state", list(SupervisorState))
def test_set_points_are_given_where_it_steers_and_angles_always(state):
    shown = report(state)
    assert (shown.tractor_angle, shown.tractor_angle_time) == (0.1, 99_900_000_000)
    assert (shown.trailer_angle, shown.trailer_angle_time) == (-0.2, 99_800_000_000)
    assert shown.steers == (state in STEERING)
    given = (shown.tractor_set_point, shown.trailer_set_point)
    assert given == ((0.11, -0.21) if state in STEERING else pytest.approx((math.nan, math.nan), nan_ok=True))


@pytest.mark.parametrize("missing", ["tractor", "trailer"])
def test_without_an_actuator_nothing_of_it_is_known_or_given(missing):
    shown = report(ACTIVE, replace(TICK, actuation=replace(ACTUATION, **{missing: None})))
    assert math.isnan(getattr(shown, f"{missing}_angle"))
    assert math.isnan(getattr(shown, f"{missing}_set_point"))
    assert getattr(shown, f"{missing}_angle_time") == 0
    (other,) = {"tractor", "trailer"} - {missing}
    assert getattr(shown, f"{other}_set_point") == TICK.angles[("tractor", "trailer").index(other)]


def test_an_actuator_that_has_measured_nothing_is_unknown_and_not_straight():
    actuation = replace(ACTUATION, tractor=SteeringReport())
    shown = report(ACTIVE, replace(TICK, actuation=actuation))
    assert math.isnan(shown.tractor_angle)
    assert shown.tractor_angle_time == 0
    assert math.isnan(actuation.angles[0])
    assert replace(actuation, trailer=None).angles[1] == 0.0


def test_actuators_are_listed_as_far_as_there_are_any():
    tractor, trailer, speed = ACTUATION.tractor, ACTUATION.trailer, ACTUATION.speed
    assert ACTUATION.bodies == (tractor, trailer)
    assert ACTUATION.angles == (0.1, -0.2)
    assert ACTUATION.reports == [tractor, trailer, speed]
    assert replace(ACTUATION, speed=None).reports == [tractor, trailer]
    alone = replace(ACTUATION, tractor=None)
    assert (alone.steering, alone.reports) == ([trailer], [trailer, speed])


@pytest.mark.parametrize("bits", range(8))
def test_each_actuator_that_does_as_asked_has_its_bit(bits):
    steering = [SteeringReport(engaged=bool(bits & bit)) for bit in (1, 2)]
    actuation = Actuation(tractor=steering[0], trailer=steering[1], speed=SpeedReport(engaged=bool(bits & 4)))
    assert actuation.engaged == report(ACTIVE, replace(TICK, actuation=actuation)).engaged == bits
    assert replace(actuation, trailer=None).engaged == bits & 5
    assert Actuation(tractor=None, trailer=None, speed=None).engaged == 0


READY_REPORT = {"readiness": Readiness.READY, "engaged": True}


def concerned(cause, changes):
    """Return the bits of actuators that report a cause, tractor, trailer, speed and all of them."""
    good, bad = (SteeringReport(**READY_REPORT), SteeringReport(**READY_REPORT | changes))
    fine, ill = (SpeedReport(**READY_REPORT), SpeedReport(**READY_REPORT | changes))
    which = ((bad, good, fine), (good, bad, fine), (good, good, ill), (bad, bad, ill))
    each = (Actuation(tractor=first, trailer=second, speed=third) for first, second, third in which)
    return [actuation.concerned(cause) for actuation in each]


@pytest.mark.parametrize("readiness", [each for each in Readiness if each is not Readiness.READY])
def test_an_actuator_reports_the_cause_that_is_its_readiness(readiness):
    changes = {"readiness": readiness}
    assert concerned(BY_READINESS[readiness], changes) == (
        [0] * 4 if readiness is Readiness.OVERRIDDEN else [1, 2, 4, 7]  # of that it has a word of its own
    )
    others = set(BY_READINESS.values()) - {BY_READINESS[readiness]}
    assert all(concerned(cause, changes) == [0] * 4 for cause in (*others, None, Cause.ACTUATOR_RELEASED))


def test_an_actuator_reports_that_the_operator_took_over_and_that_it_has_released():
    for cause in (Cause.OPERATOR_STEERS, Cause.OVERRIDDEN):
        assert concerned(cause, {"overridden": True}) == [1, 2, 4, 7]
        assert concerned(cause, {"engaged": False}) == [0] * 4
    assert concerned(Cause.ACTUATOR_RELEASED, {"engaged": False}) == [1, 2, 4, 7]
    assert concerned(Cause.ACTUATOR_RELEASED, {"overridden": True}) == [0] * 4
    nothing = Actuation(tractor=None, trailer=None, speed=None)
    assert nothing.concerned(Cause.ACTUATOR_RELEASED) == 0


@pytest.mark.parametrize(
    ("state", "cause", "since", "stop"),
    [
        (ACTIVE, None, 98.0, 0),
        (STOPPING, None, 98.0, 1),
        (STOPPING, None, 100.0 - SETTINGS.drive.comfort, 2),
        (STOPPED, None, 98.0, 0),
        (STOPPED, Cause.STOP_IGNORED, 98.0, 2),
        (FAULT, None, 98.0, 2),
        (ESTOP, None, 98.0, 2),
    ],
)
def test_it_asks_to_stop_and_to_hurry(state, cause, since, stop):
    assert report(state, cause=cause, since=since).stop == stop


def test_what_an_operator_asked_for_and_was_answered_is_shown():
    wishes = {"answered": 8, "lease": 9, "set_speed": 1.25, "nudge": -0.05, "line": -3}
    shown = report(READY, answer=Cause.NOT_ARMED, **wishes)
    assert {name: getattr(shown, name) for name in wishes} == wishes
    assert shown.answer == Cause.NOT_ARMED.value
    assert report(READY).answer == 0
    assert math.isnan(report(READY).set_speed)


def test_it_shows_whether_it_is_armed_and_when_a_state_ends_by_itself():
    engagement = Engagement(SETTINGS)
    engagement.state, engagement.since = READY, 98.0
    requests = OperatorRequests(SETTINGS, engagement)
    assert gate_state(TICK, engagement, requests, Counts(), valid=1.0).armed == 0
    engagement.arm(100.0)
    assert gate_state(TICK, engagement, requests, Counts(), valid=1.0).armed == 1
    assert report(ENGAGING).remaining == SETTINGS.drive.engaging - 2.0
    assert math.isnan(report(READY).remaining)


@pytest.mark.parametrize(("state", "shown"), [(READY, BEFORE), (ENGAGING, BEFORE), (ACTIVE, DRIVING)])
def test_it_shows_what_refuses_until_it_has_engaged_and_then_what_it_responds_to(state, shown):
    codes = report(state, replace(TICK, causes=(DRIVING, BEFORE))).refusals
    assert codes == (shown.value, *(0,) * 7)


def test_it_shows_the_first_eight_causes():
    causes = tuple(cause for cause in Cause if cause.refuses)
    assert report(READY, replace(TICK, causes=causes)).refusals == tuple(cause.value for cause in causes[:8])
    assert report(READY, replace(TICK, causes=causes[:8])).refusals == tuple(cause.value for cause in causes[:8])
