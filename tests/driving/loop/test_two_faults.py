"""Two faults in one drive: what has been left out stays so, and what is computed again is computed without both."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest
from fixes import fixes_of
from ordinary import measured

from drawbar.config import load_configuration
from drawbar.driving.fault_detection.confirmation import CONFIRMED
from drawbar.driving.fault_detection.course_error import CourseError
from drawbar.driving.fault_detection.position_drift import PositionDrift
from drawbar.driving.fault_detection.sensor_faults import SensorFaults
from drawbar.driving.loop.control_loop import ControlLoop
from drawbar.driving.loop.controller import Controller
from drawbar.signals import Actuation, Command, FixQuality, FixStatus, SolverStatus, Status
from drawbar.simulation import build_path

PERIOD, SPEED, BEHIND = 0.2, 2.0, 5.0
AT = SimpleNamespace(x=0.0, y=0.0, yaw=0.0)


def epoch(time, aside):
    """Return what both receivers say on the way east, `aside` (m) to the left of it."""
    values = {"epoch": round((1.0 + time) * 1e9)}
    for body, behind in (("tractor", 0.0), ("trailer", BEHIND)):
        values |= {f"{body}_x": SPEED * time - behind, f"{body}_y": aside, f"{body}_speed": SPEED}
        values |= {f"{body}_course": 0.0, f"{body}_quality": int(FixQuality.FIXED)}
    return fixes_of(**values)


def sample(time, aside):
    return measured(SPEED * time, aside, SPEED * time - BEHIND, aside, time=time, speed=SPEED, hitch_angle=0.01)


def step(measurement, hitch):
    estimate = SimpleNamespace(
        time=1.0 + measurement.time, hitch_angle=hitch, trailer_steering=0.0, status=SolverStatus.SOLVED, speed=SPEED,
        tractor_fix=FixStatus.ACCEPTED, trailer_fix=FixStatus.ACCEPTED,
        tractor=SimpleNamespace(x=measurement.tractor_x, y=measurement.tractor_y, yaw=0.0), trailer=AT,
        longitudinal_slip=1.0, tractor_slip=1.0, steering_offset=0.0, tractor_crab=0.0, trailer_crab=0.0,
    )  # fmt: skip
    return SimpleNamespace(measurement=measurement, estimate=estimate, actuation=Actuation())


class Drive:
    """A controller that is engaged, without its autopilot: what it believes, and what it has computed again."""

    def __init__(self, monkeypatch):
        configuration = load_configuration("articulated")
        path, _ = build_path(configuration)
        self.controller = Controller(configuration, path, 0)
        monkeypatch.setattr(Controller, "engaged", property(lambda controller: True))
        self.given, self.again = [], []
        monkeypatch.setattr(
            self.controller._rollback, "recompute", lambda change: self.again.append([change(m) for m in self.given])
        )

    def pass_epochs(self, begin, end, aside, *, hitch=0.01):
        """Let epochs pass; `aside`: a function of the time, `hitch`: the estimate's angle, rad."""
        for i in range(round(begin / PERIOD), round(end / PERIOD)):
            time = i * PERIOD
            self.controller.receive_fixes(epoch(time, aside(time)))
            self.given.append(self.faults.without_faults(sample(time, aside(time))))
            if (change := self.faults.update(step(self.given[-1], hitch), engaged=True)) is not None:
                self.controller._recompute(change)
            self.given = self.given[-10:]

    @property
    def faults(self):
        return self.controller._faults

    @property
    def exclusion(self):
        return self.faults.exclusion


@pytest.fixture
def drive(monkeypatch):
    return Drive(monkeypatch)


def none(time):
    return 0.0


def test_a_drift_after_the_trailer_has_been_left_out_is_computed_again_without_both(drive):
    drive.pass_epochs(0.0, 4.0, none)
    drive.pass_epochs(4.0, 5.0, none, hitch=0.5)
    assert drive.exclusion.excludes_trailer
    assert len(drive.again) == 1
    drive.pass_epochs(5.0, 7.0, lambda time: 0.3 * (time - 5.0))
    assert len(drive.again) == 2
    assert all(math.isnan(each.tractor_x + each.tractor_y) for each in drive.again[1])
    newest = drive.given[-1]
    assert (newest.tractor_x, newest.tractor_y) == pytest.approx((SPEED * newest.time, 0.0), abs=1e-6)
    assert math.isnan(newest.trailer_x)
    assert math.isnan(newest.hitch_angle)


def test_a_wrong_hitch_angle_after_a_drift_leaves_the_positions_to_the_velocities(drive):
    drive.pass_epochs(0.0, 4.0, none)
    drive.pass_epochs(4.0, 5.4, lambda time: 0.3 * (time - 4.0))
    assert len(drive.again) == 1
    drive.pass_epochs(5.4, 7.0, lambda time: 0.3 * (time - 4.0), hitch=0.5)
    assert drive.exclusion.excludes_trailer
    assert len(drive.again) == 2
    last = drive.again[1][-1]
    assert last.tractor_y == pytest.approx(0.0, abs=1e-6)
    assert all(math.isnan(each.hitch_angle + each.trailer_x) for each in drive.again[1])
    assert drive.given[-1].tractor_y == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("order", [("jump", "hitch"), ("hitch", "jump")])
def test_positions_that_jump_stay_left_out_beside_a_wrong_hitch_angle(drive, order):
    begins = {name: 4.0 + 1.6 * i for i, name in enumerate(order)}
    drive.pass_epochs(0.0, 4.0, none)
    for i in range(20, 40):
        time = i * PERIOD
        hitch = 0.5 if begins["hitch"] <= time else 0.01
        drive.pass_epochs(time, time + PERIOD, lambda now: float(now >= begins["jump"]), hitch=hitch)
    assert drive.exclusion.excludes_trailer
    newest = drive.given[-1]
    assert math.isnan(newest.tractor_x)
    assert math.isnan(newest.trailer_x)
    for _ in range(CONFIRMED):
        drive.exclusion.update(step(replace(newest, tractor_x=0.0), 0.01), engaged=False)
    assert not drive.exclusion.is_active


def test_where_the_antennas_were_before_a_jump_is_not_taken_from_after_it(drive):
    drive.pass_epochs(0.0, 4.0, none)
    drive.pass_epochs(4.0, 12.0, lambda time: 1.0 + 0.3 * max(time - 7.0, 0.0))
    assert math.isnan(drive.given[-1].tractor_x)
    assert not drive.faults.dead_reckons


def test_the_answer_that_is_computed_again_takes_the_place_of_the_bent_one_at_once(drive, monkeypatch):
    anew = Command(time=3.0, tractor_steering=0.1, trailer_steering=-0.2, speed=1.0)
    controller = drive.controller
    monkeypatch.setattr(controller._rollback, "recompute", lambda change: (Status.OK, anew))
    drive.pass_epochs(0.0, 4.0, none)
    assert not controller.has_corrected
    drive.pass_epochs(4.0, 6.0, lambda time: 0.5 * (time - 4.0))
    assert controller.has_corrected
    assert controller.repeat(0).tractor_angle == anew.tractor_steering

    sent = []
    monkeypatch.setattr(controller, "feedback", lambda measurement, now: SimpleNamespace(time=now, told="bent"))
    monkeypatch.setattr(controller, "prepare", lambda late: None)
    monkeypatch.setattr(controller, "state", lambda now, **told: "state")
    monkeypatch.setattr(controller, "repeat", lambda now: "anew")
    loop = ControlLoop(controller, SimpleNamespace(miss=lambda: None), send=sent.append, record=print, clock=lambda: 0)
    loop.miss()
    assert [getattr(each, "told", each) for each in sent] == ["bent", "anew", "state"]
    controller.has_corrected = False
    loop.miss()
    assert [getattr(each, "told", each) for each in sent[3:]] == ["bent", "state"]


def test_by_how_much_the_antennas_are_apart_decides_on_a_slow_drift_of_one(drive, monkeypatch):
    told, drift = [], drive.faults._drift
    monkeypatch.setattr(drift, "drifts_slowly", lambda *, tractor, trailer, apart: bool(told.append(apart)))
    drive.pass_epochs(
        0.0, 4.0, lambda time: -0.1
    )  # the trailer's is to the right of its estimate, the tractor's is not
    assert told[0] == 0.0
    assert told[-1] > 1.0


@pytest.mark.parametrize("swapped", [False, True])
def test_an_estimate_is_not_astray_beside_the_course_of_the_other_antenna(monkeypatch, swapped):
    monkeypatch.setattr(CourseError, "is_large", property(lambda error: True))
    monkeypatch.setattr(PositionDrift, "tractor_fits", property(lambda drift: True))
    monkeypatch.setattr(SensorFaults, "receivers_are_swapped", property(lambda faults: swapped))
    drive = Drive(monkeypatch)
    drive.pass_epochs(0.0, 1.0, lambda time: 0.0)
    assert drive.exclusion.excludes_trailer is not swapped
