"""When a drive in which drawbar only looked on could have been engaged, from made-up states of gate and controller."""

from dataclasses import replace

import numpy as np
import pytest
from drive_messages import controller_of, gate_of

from drawbar.driving.evaluation.engageable import Engageable
from drawbar.messages import SupervisorState
from drawbar.safety.causes import Cause
from drawbar.statuses import Status

BEGIN = 1.8e9
"""s since the epoch"""
MEASURED = {"tractor_angle_time": 1, "trailer_angle_time": 1}
REPORT = (BEGIN, controller_of(Status.OK))
OWN = (Cause.SHADOW, Cause.EMERGENCY_UNTRIED, Cause.WIGGLE_UNTRIED)


def gate(second, *causes, state=SupervisorState.STANDBY, **values):
    codes = [cause.value for cause in sorted((*causes, *OWN), key=lambda cause: cause.value)]
    refusals = (*codes, *[0] * 8)[:8]
    return BEGIN + second, replace(gate_of(state), refusals=refusals, **(MEASURED | values))


def test_what_a_shadow_brings_with_it_does_not_count_and_all_else_does_with_its_duration():
    slow, none = gate(0.0, Cause.TOO_SLOW, Cause.FIX_LOST), gate(2.0)
    found = Engageable.of(
        [REPORT, slow, gate(1.0, Cause.FIX_LOST), none, gate(7.0), gate(8.0, Cause.FIX_LOST), gate(10.0)]
    )
    assert found.durations() == {Cause.FIX_LOST: 4.0, Cause.TOO_SLOW: 1.0}
    assert list(found.durations()) == [Cause.FIX_LOST, Cause.TOO_SLOW]
    assert (found.judged, found.free) == (10.0, 6.0)
    times = BEGIN + np.array([-1.0, 0.5, 1.9, 2.1, 7.9, 8.1, 11.0])
    assert found.at(times).tolist() == [False, False, False, True, True, False, False]
    assert len(found.stretches) == 4


def test_nothing_is_judged_before_the_controller_has_reported_nor_while_the_gate_waits_for_nothing():
    stopped = gate(3.0, state=SupervisorState.ESTOP)
    found = Engageable.of([gate(0.0), (BEGIN + 1.0, REPORT[1]), gate(1.0), stopped, gate(5.0), gate(6.0)])
    assert [(each.begin - BEGIN, each.end - BEGIN) for each in found.stretches] == [(1.0, 3.0), (5.0, 6.0)]
    assert found.at(BEGIN + np.array([0.5, 2.0, 4.0, 5.5])).tolist() == [False, True, False, True]
    nothing = Engageable.of([gate(0.0), gate(9.0)])
    assert (nothing.judged, nothing.free, nothing.durations()) == (0.0, 0.0, {})
    assert nothing.at(np.array([BEGIN + 5.0])).tolist() == [False]


@pytest.mark.parametrize(("measured", "refused"), [(True, {Cause.STEERING_OLD: 2.0}), (False, {})])
def test_that_no_angle_is_measured_counts_only_where_one_ever_was(measured, refused):
    silent = {} if measured else {"trailer_angle_time": 0}
    messages = [REPORT, gate(0.0, Cause.STEERING_OLD, trailer_angle_time=0), gate(2.0, **silent), gate(5.0, **silent)]
    found = Engageable.of(messages)
    assert found.durations() == refused
    assert found.judged - found.free == sum(refused.values())


def test_a_state_that_was_recorded_behind_a_newer_one_changes_nothing():
    found = Engageable.of([REPORT, gate(0.0), gate(2.0), gate(1.0, Cause.FIX_LOST), gate(3.0)])
    assert (found.judged, found.free) == (3.0, 3.0)


def test_what_only_follows_from_a_silent_receiver_is_not_told_in_its_place():
    controller = replace(REPORT[1], notices=(Cause.RECEIVER_SILENT.value, *[0] * 7))
    messages = [(BEGIN, controller), gate(0.0, Cause.UNPROVED, Cause.FIX_LOST), gate(4.0)]
    assert Engageable.of(messages).durations() == {Cause.RECEIVER_SILENT: 4.0}


def test_more_causes_than_a_state_holds_refuse_too():
    many = [Cause.UNPROVED, Cause.FIX_TOO_NEW, Cause.FIX_LOST, Cause.CORRECTIONS_OLD, Cause.CORRECTIONS_LOST]
    many += [Cause.POSITION_UNSURE, Cause.POSITION_LOST, Cause.HEADING_UNSURE, Cause.TOO_SLOW]
    found = Engageable.of([REPORT, gate(0.0, *many), gate(1.0)])
    assert (found.judged, found.free) == (1.0, 0.0)
    assert len(found.durations()) == 8
