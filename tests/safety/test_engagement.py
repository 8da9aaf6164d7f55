"""The supervisor of a real machine: every state with every event, and what no sequence of them can bring about."""

import math
from itertools import product

import pytest
from engagements import SETTINGS, SEVERITY, SILENCE, brought_to

from drawbar.messages import Action, SupervisorState
from drawbar.safety.causes import Cause, Response
from drawbar.safety.engagement import (
    ACTIVE,
    BOOT,
    DEGRADED,
    ENGAGING,
    ESTOP,
    FATAL,
    FAULT,
    LATCHED,
    OVERRIDE,
    READY,
    SELFTEST,
    STANDBY,
    STEERING,
    STOPPED,
    STOPPING,
    TABLE,
    Engagement,
    Event,
    Situation,
    transition,
)

# written down independently of the table: which events end which states, and where
STEER_ENDS = {Event.OVERRIDE: OVERRIDE, Event.FAULT: FAULT, Event.EMERGENCY: ESTOP}
EXPECTED = {
    BOOT: {Event.BEGIN: SELFTEST, Event.FAULT: FAULT, Event.EMERGENCY: ESTOP},
    SELFTEST: {Event.PASSED: STANDBY, Event.FAULT: FAULT, Event.EMERGENCY: ESTOP},
    STANDBY: {Event.MET: READY, Event.FAULT: FAULT, Event.EMERGENCY: ESTOP},
    READY: {Event.LOST: STANDBY, Event.RELEASE: STANDBY, Event.STOP: STANDBY, Event.ENGAGE: ENGAGING}
    | {Event.FAULT: FAULT, Event.EMERGENCY: ESTOP},
    ENGAGING: {Event.TAKEN: ACTIVE, Event.STOP: STOPPING, Event.RELEASE: STANDBY} | STEER_ENDS,
    ACTIVE: {Event.DEGRADE: DEGRADED, Event.STOP: STOPPING, Event.RELEASE: STANDBY} | STEER_ENDS,
    DEGRADED: {Event.CALM: ACTIVE, Event.STOP: STOPPING, Event.RELEASE: STANDBY} | STEER_ENDS,
    STOPPING: {Event.STOOD: STOPPED, Event.RELEASE: STOPPED} | STEER_ENDS,
    STOPPED: {Event.ACKNOWLEDGE: STANDBY, Event.FAULT: FAULT, Event.EMERGENCY: ESTOP},
    OVERRIDE: {Event.ACKNOWLEDGE: STANDBY, Event.FAULT: FAULT, Event.EMERGENCY: ESTOP},
    FAULT: {Event.ACKNOWLEDGE: SELFTEST, Event.EMERGENCY: ESTOP},
    ESTOP: {Event.ACKNOWLEDGE: SELFTEST},
}
LONGEST = 10.0
"""after which no state may steer without a sound of anybody, s"""


@pytest.mark.parametrize(("state", "event"), list(product(SupervisorState, Event)), ids=lambda each: each.name)
def test_every_state_with_every_event(state, event):
    assert transition(state, event) is EXPECTED[state].get(event, state)


def test_the_emergency_stop_is_one_step_from_everywhere():
    assert all(transition(state, Event.EMERGENCY) is ESTOP for state in SupervisorState)


def test_only_the_operators_edge_leads_to_steering():
    entries = {
        (state, event)
        for state, event in product(SupervisorState, Event)
        if state not in STEERING and transition(state, event) in STEERING
    }
    assert entries == {(READY, Event.ENGAGE)}
    assert LATCHED.isdisjoint(STEERING)


def test_only_an_acknowledgement_makes_it_less_severe():
    for state, event in product(LATCHED, set(Event) - {Event.ACKNOWLEDGE}):
        after = transition(state, event)
        assert SEVERITY.get(after, -1) >= SEVERITY[state]
    assert set(TABLE) == set(SupervisorState)


@pytest.mark.parametrize("state", list(SupervisorState), ids=lambda each: each.name)
def test_total_silence_ends_steering_in_a_bounded_time_and_nothing_begins_again(state):
    engagement, seen = brought_to(state), []
    for tick in range(1, 600):
        seen.append(engagement.update(100.0 + 0.05 * tick, Situation(causes=SILENCE)))
        assert not engagement.steers or 0.05 * tick <= LONGEST
    if state in STEERING:
        assert seen[0] is FAULT, "silence means that no command is valid, which is a fault at once"
    assert seen[-1] is {BOOT: STANDBY, SELFTEST: STANDBY, STANDBY: STANDBY, READY: STANDBY}.get(
        state, state if state in LATCHED else FAULT
    )


@pytest.mark.parametrize("state", [SELFTEST, ENGAGING, DEGRADED, STOPPING], ids=lambda each: each.name)
def test_states_with_a_budget_end_by_it(state):
    engagement = brought_to(state)
    causes = {DEGRADED: (Cause.FIX_LOST,), STOPPING: (Cause.NO_OPERATOR,)}.get(state, ())
    limit = engagement.remaining(100.0)
    assert limit == pytest.approx({SELFTEST: 1.0, ENGAGING: 3.0, DEGRADED: 10.0, STOPPING: 10.0}[state])
    engagement.update(100.0 + limit - 0.001, Situation(causes=causes))
    assert engagement.state is state
    assert engagement.remaining(100.0 + limit - 0.001) == pytest.approx(0.001)
    engagement.update(100.0 + limit, Situation(causes=causes))
    assert (engagement.state, engagement.cause) == {
        SELFTEST: (STANDBY, None),
        ENGAGING: (FAULT, Cause.NOT_TAKEN),
        DEGRADED: (STOPPING, Cause.BUDGET),
        STOPPING: (STOPPED, Cause.STOP_IGNORED),
    }[state]


def test_a_stop_at_the_end_of_the_budget_keeps_a_cause_of_its_own():
    engagement = brought_to(DEGRADED)
    engagement.update(100.0 + engagement.remaining(100.0) + 0.001, Situation(causes=(Cause.NO_OPERATOR,)))
    assert (engagement.state, engagement.cause) == (STOPPING, Cause.NO_OPERATOR)


def test_a_vehicle_that_does_not_stop_is_steered_on_while_nothing_else_is_wrong():
    engagement = brought_to(STOPPING)
    for time in (110.1, 120.0):
        engagement.update(time, Situation(causes=(Cause.FIX_LOST,)))
        assert engagement.state is STOPPING
    engagement.update(120.1, Situation(causes=(Cause.POSITION_LOST,)))
    assert (engagement.state, engagement.cause) == (STOPPED, Cause.STOP_IGNORED)


def test_a_vehicle_that_does_not_stop_is_released_in_the_end_and_asked_to_stop_all_the_more():
    engagement = brought_to(STOPPING)
    assert engagement.remaining(110.1) == pytest.approx(19.9)
    assert engagement.update(129.9, Situation(causes=())) is STOPPING
    engagement.update(130.0, Situation(causes=()))
    assert (engagement.state, engagement.cause) == (STOPPED, Cause.STOP_IGNORED)
    assert engagement.hurries(130.05)
    assert not brought_to(STOPPED).hurries(130.05), "the operator released it, and drives"


BOUND = {BOOT: 0.1, SELFTEST: 1.1, ENGAGING: 3.1, DEGRADED: 10.1, STOPPING: 30.1}
"""s, within which each state must have been left that is not one to rest or to drive in"""


@pytest.mark.parametrize("state", sorted(BOUND), ids=lambda each: each.name)
@pytest.mark.parametrize("cause", [None, *Cause], ids=lambda each: each.name if each else "nothing")
def test_each_state_is_left_in_a_bounded_time_whatever_goes_on_for_good(state, cause):
    for taken, standing, overridden in product((False, True), repeat=3):
        engagement, time = brought_to(state), 100.0
        causes = () if cause is None else (cause,)
        situation = Situation(causes=causes, taken=taken, standing=standing, overridden=overridden)
        while engagement.state is state:
            time += 0.05
            assert time <= 100.0 + BOUND[state], situation
            engagement.update(time, situation)


def test_states_without_a_budget_have_no_time_left_to_show():
    for state in set(SupervisorState) - {SELFTEST, ENGAGING, DEGRADED, STOPPING}:
        assert math.isnan(brought_to(state).remaining(100.0))
    late = brought_to(STOPPING)
    assert late.remaining(1000.0) == 0.0


def test_a_failed_selftest_is_a_fault():
    engagement = Engagement(SETTINGS, sound=False)
    engagement.update(0.0, Situation(causes=()))
    assert engagement.state is SELFTEST
    engagement.update(0.05, Situation(causes=()))
    assert (engagement.state, engagement.cause, engagement.since) == (FAULT, Cause.SELFTEST, 0.05)


def test_ready_needs_all_conditions_for_the_whole_time():
    engagement = brought_to(STANDBY)
    for tick in range(1, 400):
        cause = (Cause.OFF_LINE,) if tick % 30 == 0 else ()
        assert engagement.update(100.0 + 0.05 * tick, Situation(causes=cause)) is STANDBY
    engagement.update(120.0, Situation(causes=(Cause.UNSOLVED,)))  # this one does not stand against engaging
    assert engagement.state is STANDBY
    engagement.update(121.5, Situation(causes=()))
    assert engagement.state is READY, "2 s after the last refusal"


def test_the_hold_begins_anew_with_the_state():
    engagement = brought_to(STOPPED)
    engagement.update(150.0, Situation(causes=(), standing=True))
    engagement.update(151.0, Situation(causes=(), standing=True, actions=frozenset({Action.ACKNOWLEDGE})))
    assert engagement.state is STANDBY
    assert engagement.update(152.9, Situation(causes=())) is STANDBY
    assert engagement.update(153.0, Situation(causes=())) is READY


@pytest.mark.parametrize("cause", [cause for cause in Cause if cause.refuses], ids=lambda each: each.name)
def test_each_refusal_ends_ready_and_keeps_from_engaging_in_the_same_tick(cause):
    engagement = brought_to(READY)
    engagement.update(100.05, Situation(causes=(cause,), actions=frozenset({Action.ENGAGE})))
    assert engagement.state is (FAULT if cause in FATAL else STANDBY)


@pytest.mark.parametrize("state", [ENGAGING, ACTIVE, DEGRADED, STOPPING], ids=lambda each: each.name)
@pytest.mark.parametrize("cause", list(Cause), ids=lambda each: each.name)
def test_each_cause_has_its_response_while_driving(state, cause):
    engagement = brought_to(state)
    engagement.update(100.05, Situation(causes=(cause,)))
    after = {
        Response.NONE: state,
        Response.NOTIFY: state,
        Response.DEGRADE: DEGRADED if state is ACTIVE else state,
        Response.STOP: STOPPING,
        Response.RELEASE: FAULT,
    }[cause.response]
    assert engagement.state is after
    if after is not state:
        assert engagement.cause is cause


def test_the_worst_cause_has_the_last_word():
    engagement = brought_to(ACTIVE)
    engagement.update(100.05, Situation(causes=(Cause.FIX_LOST, Cause.SILENT, Cause.LINE_LOST)))
    assert (engagement.state, engagement.cause) == (FAULT, Cause.SILENT)
    engagement = brought_to(ACTIVE)
    actions = frozenset({Action.STOP, Action.EMERGENCY, Action.RELEASE})
    engagement.update(100.05, Situation(causes=(Cause.SILENT,), overridden=True, actions=actions))
    assert (engagement.state, engagement.cause) == (ESTOP, Cause.EMERGENCY)


def test_which_actuators_reported_the_cause_is_kept_as_long_as_the_state():
    engagement, asked = brought_to(ACTIVE), []

    def concerned(cause):
        asked.append(cause)
        return 2

    fault = Situation(causes=(Cause.SILENT,), concerned=concerned)
    engagement.update(100.05, fault)
    assert (engagement.state, engagement.concerned, asked) == (FAULT, 2, [Cause.SILENT])
    engagement.update(100.1, Situation(causes=(), concerned=lambda _: 1))
    assert (engagement.state, engagement.concerned) == (FAULT, 2)
    engagement.update(100.15, Situation(causes=(), actions=frozenset({Action.EMERGENCY})))
    assert (engagement.state, engagement.concerned) == (ESTOP, 0)


@pytest.mark.parametrize("why", [Cause.SILENT, Cause.OTHER_MASTER, Cause.LOCKED_OUT, Cause.TOO_NEW])
def test_an_actuator_that_released_and_says_why_is_not_said_to_have_released_by_itself(why):
    engagement = brought_to(ACTIVE)
    engagement.update(100.05, Situation(causes=(Cause.ACTUATOR_RELEASED, why)))
    assert (engagement.state, engagement.cause) == (FAULT, why)
    engagement = brought_to(ACTIVE)
    engagement.update(100.05, Situation(causes=(Cause.LINE_LOST, Cause.ACTUATOR_RELEASED)))
    assert (engagement.state, engagement.cause) == (FAULT, Cause.ACTUATOR_RELEASED)


@pytest.mark.parametrize("state", list(SupervisorState), ids=lambda each: each.name)
@pytest.mark.parametrize("cause", sorted(FATAL, key=lambda each: each.value), ids=lambda each: each.name)
def test_fatal_causes_are_faults_everywhere(state, cause):
    engagement = brought_to(state)
    engagement.update(100.05, Situation(causes=(Cause.OFF_LINE, cause)))
    assert engagement.state is (ESTOP if state is ESTOP else FAULT)
    if state not in (ESTOP, FAULT):
        assert engagement.cause is cause


@pytest.mark.parametrize(
    ("action", "state", "after", "cause"),
    [
        (Action.RELEASE, ACTIVE, STANDBY, Cause.OPERATOR_RELEASES),
        (Action.STOP, ACTIVE, STOPPING, Cause.OPERATOR_STOPS),
        (Action.EMERGENCY, STANDBY, ESTOP, Cause.EMERGENCY),
        (Action.RELEASE, STOPPING, STOPPED, Cause.OPERATOR_RELEASES),
    ],
)
def test_an_operators_action_leads_to_its_state_with_its_cause(action, state, after, cause):
    engagement = brought_to(state)
    engagement.update(100.05, Situation(causes=(), actions=frozenset({action})))
    assert (engagement.state, engagement.cause) == (after, cause)


def test_an_operator_at_the_wheel_wins_over_a_stop():
    engagement = brought_to(ACTIVE)
    engagement.update(100.05, Situation(causes=(Cause.LINE_LOST,), overridden=True))
    assert (engagement.state, engagement.cause) == (OVERRIDE, Cause.OPERATOR_STEERS)


@pytest.mark.parametrize("state", sorted(LATCHED), ids=lambda each: each.name)
def test_latched_states_are_acknowledged_standing_only(state):
    engagement, ask = brought_to(state), frozenset({Action.ACKNOWLEDGE})
    moving = Situation(causes=(), actions=ask)
    if state is not OVERRIDE:  # after an override it is the operator who drives
        assert engagement.update(100.05, moving) is state
        assert engagement.answer(100.05, Action.ACKNOWLEDGE) is Cause.NOT_STANDING
        standing = Situation(causes=(), actions=ask, standing=True)
        assert engagement.update(100.54, standing) is state, "not yet half a second"
        assert engagement.answer(100.55, Action.ACKNOWLEDGE) is None
        engagement.update(100.56, standing)
    else:
        engagement.update(100.05, moving)
    assert engagement.state is (STANDBY if state in (STOPPED, OVERRIDE) else SELFTEST)
    assert engagement.cause is None


def test_there_is_nothing_to_acknowledge_elsewhere():
    for state in set(SupervisorState) - LATCHED:
        engagement = brought_to(state)
        assert engagement.answer(200.0, Action.ACKNOWLEDGE) is Cause.NOTHING_TO_ACKNOWLEDGE
        for action in (Action.RELEASE, Action.STOP, Action.EMERGENCY, Action.PRESENT):
            assert engagement.answer(200.0, action) is None


def test_arming_holds_for_a_while_and_ends_with_the_state():
    engagement = brought_to(READY)
    assert engagement.answer(100.0, Action.ARM) is None
    assert engagement.answer(100.0, Action.ENGAGE) is Cause.NOT_ARMED
    engagement.arm(100.0)
    assert engagement.answer(105.0, Action.ENGAGE) is None
    assert engagement.armed(105.0)
    assert engagement.answer(105.1, Action.ENGAGE) is Cause.NOT_ARMED
    engagement.update(100.1, Situation(causes=(Cause.OFF_LINE,)))
    assert not engagement.armed(100.1)
    assert engagement.answer(100.1, Action.ARM) is Cause.STATE_NOT_READY
    assert engagement.answer(100.1, Action.ENGAGE) is Cause.STATE_NOT_READY
    engagement.update(102.2, Situation(causes=()))
    assert engagement.state is READY
    assert not engagement.armed(102.2)


@pytest.mark.parametrize("state", STEERING)
def test_whoever_engages_what_is_steered_is_reported_so(state):
    engagement = brought_to(state)
    assert {engagement.answer(100.0, action) for action in (Action.ARM, Action.ENGAGE)} == {Cause.STEERED}


def test_an_edge_that_comes_with_readiness_is_too_early():
    engagement = brought_to(STANDBY)
    engagement.update(150.0, Situation(causes=(), actions=frozenset({Action.ENGAGE})))
    assert engagement.state is READY


def test_it_eases_for_a_second_and_takes_over_only_then():
    engagement = brought_to(ENGAGING)
    assert engagement.eases(100.99)
    assert engagement.update(100.95, Situation(causes=(), taken=True)) is ENGAGING
    assert engagement.update(101.0, Situation(causes=(), taken=True)) is ACTIVE
    assert not engagement.eases(101.0)
    late = brought_to(ENGAGING)
    assert not late.eases(101.0)
    assert late.update(102.9, Situation(causes=())) is ENGAGING
    assert late.update(102.95, Situation(causes=(), taken=True)) is ACTIVE


def test_it_recovers_only_after_calm():
    engagement = brought_to(DEGRADED)
    for tick in range(1, 60):
        cause = (Cause.FIX_LOST,) if tick % 30 == 0 else ()
        assert engagement.update(100.0 + 0.05 * tick, Situation(causes=cause)) is DEGRADED
    assert engagement.update(103.4, Situation(causes=())) is DEGRADED
    assert engagement.update(103.5, Situation(causes=())) is ACTIVE, "2 s after 101.5"


def test_a_stop_ends_where_the_vehicle_stands_and_hurries_before():
    engagement = brought_to(STOPPING)
    assert not engagement.hurries(104.99)
    assert engagement.hurries(105.0)
    assert brought_to(ESTOP).hurries(100.0)
    assert brought_to(FAULT).hurries(100.0), "nobody steers"
    assert not brought_to(OVERRIDE).hurries(1000.0), "somebody steers"
    engagement.update(106.0, Situation(causes=()))
    engagement.update(106.4, Situation(causes=(), standing=True))
    assert engagement.state is STOPPING
    engagement.update(106.5, Situation(causes=(), standing=True))
    assert (engagement.state, engagement.cause) == (STOPPED, Cause.OPERATOR_STOPS)


def test_the_emergency_stop_counts_as_tried():
    engagement = brought_to(STANDBY)
    engagement.update(100.0, Situation(causes=(), actions=frozenset({Action.STOP})))
    assert not engagement.emergency_tried
    engagement.update(100.1, Situation(causes=(), actions=frozenset({Action.EMERGENCY})))
    engagement.update(100.2, Situation(causes=()))
    assert engagement.emergency_tried
