"""Notices: which sensor is silent or not believed is told to the operator, and stays told until it is acknowledged."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from fixes import fixes_of
from ordinary import measured

from drawbar.config import load_configuration
from drawbar.driving.fault_detection.notices import MOST, Notices
from drawbar.driving.stand_in.rehearsal import Rehearsal
from drawbar.machine.stand_in.breaking import moved, report_otherwise
from drawbar.machine.stand_in.faults import FAULTS
from drawbar.messages import SupervisorState
from drawbar.safety.causes import BY_CODE, Cause
from drawbar.signals import Actuation, FixStatus
from drawbar.simulation import build_path

NOTHING = SimpleNamespace(excludes_positions=False, excludes_trailer=False, steering_contradicts=False)
ALL_RIGHT = {"drifts": False, "mirrored": False, "far_apart": False}
NUMBERS = ("yaw.error", "yaw.latency", "yaw.change", "yaw_rate.exclusion")
"""of an alignment, that are read"""
NOT_CORRECTED = Actuation()
ACCEPTED, REJECTED = FixStatus.ACCEPTED, FixStatus.REJECTED


class Told:
    """Notices with an alignment whose numbers are given."""

    def __init__(self, *, has_trailer_receiver=True):
        self.numbers = {name: np.zeros(1) for name in NUMBERS}
        self.time, self.yaw, self.rate = 0.0, 0.5, 0.0  # of the estimate: s, rad, rad/s
        live = SimpleNamespace(array=self.numbers.__getitem__)
        self.notices = Notices(
            SimpleNamespace(library=SimpleNamespace(components={"alignment": SimpleNamespace(live=live)})),
            has_trailer_receiver=has_trailer_receiver,
        )

    def step(
        self,
        *,
        fixes=(ACCEPTED, ACCEPTED),
        yaw=math.nan,
        roll=0.0,
        age=0.0,
        known=NOT_CORRECTED,
        exclusion=NOTHING,
        **found,
    ):
        """Let a step pass; return what is told."""
        self.time += 0.2
        self.yaw += 0.2 * self.rate
        estimate = SimpleNamespace(
            tractor_fix=fixes[0], trailer_fix=fixes[1], tractor=SimpleNamespace(yaw=self.yaw), time=self.time
        )
        attitude = {"tractor_yaw": yaw, "tractor_roll": roll, "tractor_attitude_age": age}
        measurement = replace(measured(0.0, 0.0, 0.0, 0.0), **attitude)
        record = SimpleNamespace(estimate=estimate, measurement=measurement, actuation=known)
        self.notices.update(record, exclusion, **ALL_RIGHT | found)
        assert len(self.notices.codes) == MOST
        return [BY_CODE[code] for code in self.notices.codes if code]

    def hear(self, begin, end, **given):
        """Let epochs pass, five a second; return what is told."""
        for i in range(round(5 * begin), round(5 * end)):
            self.notices.receive_fixes(fixes_of(epoch=round(0.2e9 * i) + 10**9, **given))
        return self.step()

    def gate(self, state):
        self.notices.receive_gate(SimpleNamespace(state=state))


@pytest.fixture
def told():
    return Told()


def test_receivers_that_never_mean_the_same_time_are_reported_by_that(told):
    assert not told.hear(0.0, 1.0)
    for k in range(20):
        found = told.hear(1.0 + 0.2 * k, 1.2 + 0.2 * k, **{f"{('tractor', 'trailer')[k % 2]}_heard": 0})
        assert (Cause.RECEIVER_TIMES in found) == (k >= 10)
    assert not told.hear(5.0, 5.2), "a common epoch"
    assert Cause.RECEIVER_TIMES not in told.hear(5.2, 10.0, trailer_heard=0), "one of them is silent"


def test_a_receiver_that_is_never_heard_is_reported_where_there_is_one(told):
    assert told.hear(0.0, 0.4, trailer_heard=0) == []
    assert told.hear(0.4, 2.0, trailer_heard=0) == [Cause.RECEIVER_SILENT]
    assert told.hear(2.0, 2.2) == []
    assert Told(has_trailer_receiver=False).hear(0.0, 2.0, trailer_heard=0) == []


@pytest.mark.parametrize("silent", ["tractor_heard", "trailer_heard"])
def test_a_receiver_that_falls_silent_is_reported_and_one_lost_epoch_is_not(told, silent):
    assert told.hear(0.0, 2.0) == []
    assert told.hear(2.0, 2.4, **{silent: 0}) == []
    assert told.hear(2.4, 3.0, **{silent: 0}) == [Cause.RECEIVER_SILENT]
    assert told.hear(3.0, 3.2) == []


@pytest.mark.parametrize("silent", ["hitch_angle", "wheel_speed"])
def test_a_sensor_that_falls_silent_is_reported_and_one_that_there_is_not_is_not(told, silent):
    assert told.hear(0.0, 5.0, **{silent: math.nan}) == []
    assert told.hear(5.0, 6.0) == []
    assert told.hear(6.0, 6.4, **{silent: math.nan}) == []
    assert told.hear(6.4, 7.0, **{silent: math.nan}) == [Cause.SENSOR_SILENT]


@pytest.mark.parametrize("fixes", [(REJECTED, ACCEPTED), (ACCEPTED, REJECTED), (REJECTED, FixStatus.MISSING)])
def test_one_antenna_that_is_not_believed_three_times_is_reported(told, fixes):
    assert [told.step(fixes=fixes) for _ in range(3)] == [[], [], [Cause.POSITION_REJECTED]]
    assert told.step() == []
    assert [told.step(fixes=(REJECTED, REJECTED)) for _ in range(3)] == [[], [], []]


def test_what_is_excluded_is_reported(told):
    both = SimpleNamespace(excludes_positions=True, excludes_trailer=True, steering_contradicts=False)
    assert told.step(exclusion=both) == [Cause.POSITIONS_JUMPED, Cause.TRAILER_CONTRADICTS]
    assert told.step(exclusion=both, drifts=True) == [Cause.POSITIONS_DRIFT]
    told.gate(SupervisorState.STOPPING)
    assert told.step(exclusion=both, drifts=True) == [Cause.POSITIONS_DRIFT]
    assert told.step(exclusion=both) == [Cause.POSITIONS_DRIFT]


def test_a_yaw_rate_that_the_estimator_has_dropped_is_reported(told):
    told.numbers["yaw_rate.exclusion"][0] = 59.0
    assert told.step() == [Cause.YAW_REJECTED]


def test_a_yaw_beyond_what_is_believed_is_reported(told):
    told.numbers["yaw.error"][0] = -1.0  # of the mounting
    assert [told.step(yaw=1.59) for _ in range(5)][-1] == []
    assert [told.step(yaw=1.61) for _ in range(3)] == [[], [], [Cause.YAW_REJECTED]]
    assert told.step(yaw=1.61 + 2.0 * math.pi) == [Cause.YAW_REJECTED]
    assert [told.step(yaw=1.5 + 2.0 * math.pi) for _ in range(3)] == [[], [], []]
    assert told.step(yaw=math.nan) == []


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_yaw_that_has_turned_is_reported_where_a_roll_tells_that_no_slope_does_it(told, sign):
    told.numbers["yaw.change"][0] = sign * math.radians(1.4)
    assert told.step() == []
    told.numbers["yaw.change"][0] = sign * math.radians(1.6)
    assert told.step(roll=math.nan) == []
    assert told.step() == [Cause.YAW_CHANGED]


@pytest.mark.parametrize("scale", ["hitch_scale", "joint_scale"])
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_wrong_scale_of_hitch_or_joint_is_reported(told, scale, sign):
    assert told.step(known=Actuation(**{scale: sign * 0.09})) == []
    assert told.step(known=Actuation(**{scale: sign * 0.11})) == [Cause.ANGLE_SCALE]


@pytest.mark.parametrize(("reported", "latency"), [(0.4, 0.0), (0.0, 0.4), (0.2, 0.2)])
def test_a_late_yaw_is_believed_in_a_turn_and_a_wrong_one_is_not(told, reported, latency):
    told.numbers["yaw.latency"][0], told.rate = latency, 0.3
    told.step()
    for wrong, found in ((0.0, []), (0.11, [Cause.YAW_REJECTED])):
        said = [told.step(yaw=told.yaw + 0.3 * (0.2 - 0.4) + wrong, age=reported) for _ in range(3)]
        assert said[-1] == found


def test_what_has_been_told_stays_until_the_stop_is_acknowledged(told):
    trailer = SimpleNamespace(excludes_positions=False, excludes_trailer=True, steering_contradicts=False)
    told.gate(SupervisorState.ACTIVE)
    assert told.step(exclusion=trailer) == [Cause.TRAILER_CONTRADICTS]
    told.gate(SupervisorState.STOPPED)
    assert told.step() == [Cause.TRAILER_CONTRADICTS]
    told.gate(SupervisorState.STANDBY)
    assert told.step() == []


def test_mirrored_front_wheels_are_reported_instead_of_the_trailers_angles(told):
    trailer = SimpleNamespace(excludes_positions=False, excludes_trailer=True, steering_contradicts=False)
    told.gate(SupervisorState.ACTIVE)
    assert told.step(exclusion=trailer) == [Cause.TRAILER_CONTRADICTS]
    assert told.step(exclusion=trailer, mirrored=True) == [Cause.STEERING_MIRRORED]
    assert told.step(mirrored=True) == [Cause.STEERING_MIRRORED]


def engaged(*changes):
    """Return a rehearsal that has been steered for two seconds."""
    given = ["safety.engage.wiggle_test=false", "safety.engage.fixed=1.0", *changes]
    configuration = load_configuration("articulated", given)
    path, _ = build_path(configuration)
    rehearsal = Rehearsal(configuration, path, 1, configuration.safety)
    while rehearsal.gate_state is None or rehearsal.gate_state.state is not SupervisorState.ACTIVE:
        rehearsal.advance()
        assert rehearsal.time < 30.0
    list(rehearsal.run(2.0))
    return rehearsal


def notices(rehearsal):
    return [BY_CODE[code] for code in rehearsal.loop._controller._faults.notices if code]


def test_a_drift_is_reported_as_one_after_the_stop_as_well():
    rehearsal = engaged()
    machine = rehearsal.machine
    report_otherwise(machine, lambda report, since: moved(report, machine, 0.3 * since))
    list(rehearsal.run(8.0))
    assert rehearsal.gate_state.state is SupervisorState.STOPPED
    assert notices(rehearsal) == [Cause.POSITIONS_DRIFT]


@pytest.mark.parametrize(
    ("fault", "cause"),
    [
        ("receiver-silent", Cause.RECEIVER_SILENT),
        ("receivers-silent", Cause.RECEIVER_SILENT),
        ("sensors-silent", Cause.SENSOR_SILENT),
        ("fixes-jump", Cause.POSITIONS_JUMPED),
        (None, None),
    ],
)
def test_in_a_drive_the_operator_is_told_what_has_failed(fault, cause):
    rehearsal = engaged()
    if fault is not None:
        FAULTS[fault].begin(rehearsal.machine)
    list(rehearsal.run(2.0))
    assert notices(rehearsal) == ([cause] if cause else [])


def test_where_nothing_is_heard_any_more_the_operator_is_told_of_all():
    rehearsal = engaged()
    for line in ("tractor receiver", "trailer receiver", "sensors"):
        rehearsal.links.faults[line] = lambda now, data: []
    list(rehearsal.run(1.2))
    assert notices(rehearsal) == []
    list(rehearsal.run(1.0))
    assert notices(rehearsal) == [Cause.RECEIVER_SILENT, Cause.SENSOR_SILENT]


@pytest.mark.parametrize("degrees", [0.0, 3.0])
def test_an_antenna_that_is_bumped_is_told_while_driving(degrees):
    attitude = "machine.attitude={tractor={present=true},yaw={present=true}}"
    rehearsal = engaged(attitude, "machine.terrain.slope=0.05", "vehicle.masts={tractor={up=2.5},trailer={up=2.0}}")
    list(rehearsal.run(20.0))
    assert notices(rehearsal) == []
    turn = math.radians(degrees)
    report_otherwise(rehearsal.machine, lambda report, since: replace(report, yaw=report.yaw + turn), ["tractor"])
    list(rehearsal.run(10.0))
    assert notices(rehearsal) == ([Cause.YAW_CHANGED] if degrees else [])
    assert rehearsal.gate_state.state is SupervisorState.ACTIVE
