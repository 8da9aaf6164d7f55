"""Each cause at the edge of its limit: what is just allowed, and what is just too much."""

import math
from dataclasses import replace

import pytest

from drawbar.protocols.actuator import Readiness
from drawbar.safety.causes import BY_READINESS, Cause, Response
from drawbar.safety.conditions import Observation, present, worst
from drawbar.safety.settings import (
    DriveSettings,
    EngageSettings,
    EnvelopeSettings,
    SafetySettings,
    TimingSettings,
)

SETTINGS = SafetySettings(
    engage=EngageSettings(
        clean=3.0, solved=20, fixed=10.0, correction_age=5.0, lateral_deviation=0.07, heading_deviation=0.05,
        lateral_error=1.0, heading_error=0.5, hitch_angle=0.8, speed=0.1, steering_error=0.035,
    ),
    drive=DriveSettings(
        overruns=3, correction_age=20.0, lateral_deviation=0.08, lateral_error=1.5, leaving=0.4, hitch_angle=1.0,
        operator=2.0,
    ),
    envelope=EnvelopeSettings(clips=5, speed=4.2),
    timing=TimingSettings(controller=0.5, fix=0.75, speed=0.5, angle=0.25, angle_lost=0.5),
)  # fmt: skip
"""each limit differs from those it could be taken for, and sums of them are exact"""
SOUND = Observation(
    controller_age=0.0, command_valid=True, refused_ago=60.0, agrees=True, configured=True, solved=100, fixed_for=60.0,
    fix_age=0.0, correction_age=1.0, lateral_deviation=0.01, heading_deviation=0.01, lateral_error=0.02,
    heading_error=0.01, hitch_angle=0.0, speed=1.0, speed_received=True, speed_known=True, angle_age=0.0,
    steering_error=0.0, readiness=(Readiness.READY, Readiness.READY), late_ago=60.0, unsent_ago=60.0, operator_age=0.0,
    recording=True, guarded=True, emergency_tried=True, wiggled=True,
)  # fmt: skip
"""an observation in which nothing is wrong"""
ABOVE = {
    "controller_age": [(0.5, Cause.CONTROLLER_SILENT)],
    "correction_age": [(5.0, Cause.CORRECTIONS_OLD), (20.0, Cause.CORRECTIONS_LOST)],
    "fix_age": [(0.75, Cause.FIX_LOST)],
    "lateral_deviation": [(0.07, Cause.POSITION_UNSURE), (0.08, Cause.POSITION_LOST)],
    "heading_deviation": [(0.05, Cause.HEADING_UNSURE)],
    "lateral_error": [(1.0, Cause.OFF_LINE), (1.5, Cause.LINE_LOST)],
    "heading_error": [(0.5, Cause.ACROSS_LINE)],
    "hitch_angle": [(0.8, Cause.HITCH_ANGLE), (1.0, Cause.HITCH_FOLDED)],
    "angle_age": [(0.25, Cause.STEERING_OLD), (0.5, Cause.STEERING_LOST)],
    "steering_error": [(0.035, Cause.STEERING_APART)],
    "operator_age": [(2.0, Cause.NO_OPERATOR)],
}
"""largest values that are allowed; more, or none that is known, is the cause"""
BELOW = {"fixed_for": (10.0, Cause.FIX_TOO_NEW), "speed": (0.1, Cause.TOO_SLOW), "solved": (20, Cause.UNPROVED)}
"""smallest values that are allowed"""
RECENT = {
    "refused_ago": Cause.COMMAND_REFUSED,
    "late_ago": Cause.GATE_LATE,
    "unsent_ago": Cause.NOT_SENT,
}
"""what must be at least `engage.clean` ago"""
TURNED = {
    "command_valid": Cause.COMMAND_EXPIRED,
    "agrees": Cause.MODE,
    "run_ended": Cause.CONTROLLER_STOPS,
    "controller_gone": Cause.CONTROLLER_GONE,
    "configured": Cause.CONFIGURATION,
    "speed_known": Cause.SPEED_UNKNOWN,
    "speeds_contradict": Cause.SPEEDS_CONTRADICT,
    "stuck": Cause.STEERING_STUCK,
    "not_following": Cause.STEERING_STUCK,
    "reversed": Cause.STEERING_REVERSED,
    "jumped": Cause.STEERING_JUMPED,
    "released": Cause.ACTUATOR_RELEASED,
    "suspended": Cause.SUSPENDED,
    "device_failed": Cause.DEVICE,
    "ended": Cause.ENDED,
    "backwards": Cause.RECEIVERS_SWAPPED,
    "recording": Cause.NOT_RECORDING,
    "guarded": Cause.NOT_GUARDED,
    "emergency_tried": Cause.EMERGENCY_UNTRIED,
    "wiggled": Cause.WIGGLE_UNTRIED,
}
"""what is one cause as soon as it is otherwise than in SOUND"""


def causes(settings=SETTINGS, **otherwise):
    return present(replace(SOUND, **otherwise), settings)


def test_nothing_is_wrong_with_a_sound_observation():
    assert causes() == ()


@pytest.mark.parametrize("field", list(ABOVE))
def test_more_than_the_largest_value_allowed_is_a_cause(field):
    expected = ()
    for limit, cause in ABOVE[field]:
        assert causes(**{field: limit}) == expected
        expected = (*expected, cause)
        assert causes(**{field: math.nextafter(limit, math.inf)}) == expected
    assert causes(**{field: math.nan}) == expected, "what is not known counts as too much"


def test_a_hitch_angle_to_the_other_side_is_as_large():
    assert causes(hitch_angle=-1.1) == (Cause.HITCH_ANGLE, Cause.HITCH_FOLDED)


@pytest.mark.parametrize("field", list(BELOW))
def test_less_than_the_smallest_value_allowed_is_a_cause(field):
    limit, cause = BELOW[field]
    less = limit - 1 if isinstance(limit, int) else math.nextafter(limit, -math.inf)
    assert causes(**{field: limit}) == ()
    assert causes(**{field: less}) == (cause,)
    if isinstance(limit, float):
        assert causes(**{field: math.nan}) == (cause,)


@pytest.mark.parametrize("field", list(RECENT))
def test_a_trouble_of_the_last_seconds_is_a_cause(field):
    assert causes(**{field: 3.0}) == ()
    assert causes(**{field: math.nextafter(3.0, 0.0)}) == (RECENT[field],)


@pytest.mark.parametrize("field", list(TURNED))
def test_what_must_or_must_not_be_is_a_cause_otherwise(field):
    assert causes(**{field: not getattr(SOUND, field)}) == (TURNED[field],)


@pytest.mark.parametrize(
    "cause",
    [
        Cause.POSITION_REJECTED,
        Cause.ANTENNA_DISTANCE,
        Cause.FIELD_EDGE,
        Cause.STEERING_MIRRORED,
        Cause.STEERING_CONTRADICTS,
    ],
    ids=lambda cause: cause.name,
)
def test_what_the_controller_reports_is_a_cause(cause):
    assert causes(notices=(Cause.RECEIVER_SILENT.value, cause.value, 0)) == (cause,)


@pytest.mark.parametrize("cause", [Cause.OUTSIDE_TUBE, Cause.TUBE_LOST], ids=lambda cause: cause.name)
def test_the_tube_counts_once_the_line_has_been_reached(cause):
    assert causes(notices=(cause.value, 0)) == ()
    assert causes(notices=(cause.value, 0), on_line=True) == (cause,)


def test_what_is_only_said_to_the_operator_is_none():
    assert causes(notices=(Cause.RECEIVER_SILENT.value, 0)) == ()


@pytest.mark.parametrize(("clips", "expected"), [(4, ()), (5, (Cause.COMMAND_LIMITED,))])
def test_commands_that_were_limited_in_a_row(clips, expected):
    assert causes(clips=clips) == expected


@pytest.mark.parametrize(
    ("late", "expected"),
    [(1, (Cause.OVERRUN,)), (2, (Cause.OVERRUN,)), (3, (Cause.OVERRUN, Cause.OVERRUNS))],
)
def test_late_steps(late, expected):
    assert causes(overruns=late) == expected


def test_steps_that_were_not_solved():
    assert causes(solved=1) == (Cause.UNPROVED,)
    assert causes(solved=0) == (Cause.UNPROVED, Cause.UNSOLVED)


def test_a_body_that_has_been_on_the_line_has_left_it_sooner():
    assert causes(on_line=True, lateral_error=0.4) == ()
    assert causes(on_line=True, lateral_error=math.nextafter(0.4, 1.0)) == (Cause.LINE_LOST,)
    assert causes(on_line=True, lateral_error=math.nan) == (Cause.OFF_LINE, Cause.LINE_LOST)


def test_neither_fix_nor_speed_for_a_while():
    longest = 0.75 + 0.5
    assert causes(speed_received=False, fix_age=longest) == (Cause.FIX_LOST,)
    beyond = math.nextafter(longest, 2.0)
    assert causes(speed_received=False, fix_age=beyond) == (Cause.FIX_LOST, Cause.SENSORS_LOST)
    assert causes(speed_received=False, fix_age=math.nan) == (Cause.FIX_LOST, Cause.SENSORS_LOST)
    assert causes(fix_age=beyond) == (Cause.FIX_LOST,)


def test_a_speed_actuator_may_begin_from_standing():
    assert causes(drives=True, speed=0.0) == ()
    assert causes(drives=True, speed=math.nan) == ()


def test_the_fastest_speed():
    assert causes(speed=4.2) == ()
    assert causes(speed=math.nextafter(4.2, 5.0)) == (Cause.TOO_FAST,)


@pytest.mark.parametrize(
    ("setting", "field"), [("recorder", "recording"), ("emergency_test", "emergency_tried"), ("wiggle_test", "wiggled")]
)
def test_what_the_settings_do_not_ask_for_is_no_cause(setting, field):
    engage = SETTINGS.engage.model_copy(update={setting: False})
    assert causes(SETTINGS.model_copy(update={"engage": engage}), **{field: False}) == ()


@pytest.mark.parametrize("each", list(Readiness), ids=lambda each: each.name)
def test_an_actuator_that_is_not_ready_says_why(each):
    expected = () if each is Readiness.READY else (BY_READINESS[each],)
    assert causes(readiness=(Readiness.READY, each)) == expected
    assert causes(readiness=(each, Readiness.READY)) == expected


def test_total_silence_is_everything_that_nobody_has_said():
    unsaid = {
        Cause.CONTROLLER_SILENT, Cause.COMMAND_EXPIRED, Cause.CONFIGURATION, Cause.UNPROVED, Cause.UNSOLVED,
        Cause.FIX_TOO_NEW, Cause.FIX_LOST, Cause.CORRECTIONS_OLD, Cause.CORRECTIONS_LOST, Cause.POSITION_UNSURE,
        Cause.POSITION_LOST, Cause.HEADING_UNSURE, Cause.OFF_LINE, Cause.LINE_LOST, Cause.ACROSS_LINE,
        Cause.HITCH_ANGLE, Cause.HITCH_FOLDED, Cause.SENSORS_LOST, Cause.TOO_SLOW, Cause.SPEED_UNKNOWN,
        Cause.STEERING_OLD, Cause.STEERING_LOST, Cause.STEERING_APART, Cause.NO_OPERATOR, Cause.NOT_RECORDING,
        Cause.NOT_GUARDED, Cause.EMERGENCY_UNTRIED, Cause.WIGGLE_UNTRIED,
    }  # fmt: skip
    assert set(present(Observation(), SETTINGS)) == unsaid


def test_causes_come_in_the_order_of_their_codes():
    found = causes(readiness=(Readiness.FAULT,), guarded=False, run_ended=True)
    assert found == (Cause.CONTROLLER_STOPS, Cause.ACTUATOR_FAULT, Cause.NOT_GUARDED)


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        ((), None),
        ((Cause.OVERRUN,), Cause.OVERRUN),
        ((Cause.FIX_LOST, Cause.LINE_LOST, Cause.NO_OPERATOR), Cause.LINE_LOST),
        ((Cause.LINE_LOST, Cause.ACTUATOR_RELEASED), Cause.ACTUATOR_RELEASED),
        ((Cause.ACTUATOR_RELEASED, Cause.SILENT), Cause.SILENT),
        ((Cause.COMMAND_EXPIRED, Cause.GATE_LATE), Cause.GATE_LATE),
        ((Cause.CONTROLLER_SILENT, Cause.COMMAND_EXPIRED), Cause.CONTROLLER_SILENT),
    ],
)
def test_the_strongest_response_counts_and_of_those_the_cause_that_explains_most(found, expected):
    assert worst(found) == (expected.response if expected else Response.NONE, expected)
