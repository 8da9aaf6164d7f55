"""When a run ends, and why."""

import math
from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import numpy as np
import pytest

from drawbar.safety.supervisor import BLIND, LOST
from drawbar.signals import BodyReference, Estimate, FixStatus, GateVerdict, Pose, SolverStatus
from drawbar.simulation import RunAborted, drive

NOWHERE = Pose(x=0.0, y=0.0, yaw=0.0)
ESTIMATE = Estimate(
    time=0.0,
    tractor=NOWHERE,
    trailer=NOWHERE,
    hitch_angle=0.0,
    speed=1.0,
    tractor_steering=0.0,
    trailer_steering=0.0,
    longitudinal_slip=1.0,
    tractor_slip=1.0,
    trailer_slip=1.0,
    steering_offset=0.0,
    tractor_crab=0.0,
    trailer_crab=0.0,
    status=SolverStatus.SOLVED,
    trailer_fix=FixStatus.MISSING,
)


@dataclass
class Fake:
    """An autopilot whose steps are records of the given lateral errors, 0.2 s apart."""

    errors: list[float]
    fixes: list[FixStatus] = field(default_factory=list)
    """of the tractor's antenna at each step; accepted beyond the list's end"""
    verdicts: list[GateVerdict] = field(default_factory=list)
    start: float = 0.2
    steps: int = 0

    @property
    def guidance(self):
        return SimpleNamespace(finished=self.steps == len(self.errors))

    def step(self):
        step, time = self.steps, self.start + 0.2 * self.steps
        self.steps += 1
        fix = self.fixes[step] if step < len(self.fixes) else FixStatus.ACCEPTED
        tractor = BodyReference(
            progress=0.0, lateral_error=self.errors[step], closest=np.zeros(4), samples=np.zeros((2, 4))
        )
        return SimpleNamespace(
            measurement=SimpleNamespace(time=time),
            estimate=replace(ESTIMATE, time=time, tractor_fix=fix),
            reference=SimpleNamespace(tractor=tractor),
            gate=self.verdicts[step] if step < len(self.verdicts) else GateVerdict.PASSED,
        )


def test_a_run_ends_with_the_path():
    autopilot = Fake([0.0, LOST, -LOST, 0.1])
    assert len(list(drive(autopilot, time_limit=10.0))) == 4


def test_no_step_is_taken_on_a_path_already_driven():
    assert list(drive(Fake([]), time_limit=10.0)) == []


@pytest.mark.parametrize("error", [5.01, -5.01, math.nan, math.inf])
def test_a_vehicle_that_left_the_path_is_given_up_after_its_record(error):
    autopilot = Fake([0.0, error, 0.0])
    run = drive(autopilot, time_limit=10.0)
    records = [next(run), next(run)]
    assert len(records) == 2
    with pytest.raises(RunAborted, match=r"At 0\.4 s the tractor was .* m from the path \(limit 5\.0 m\)"):
        next(run)
    assert autopilot.steps == 2


def test_a_vehicle_that_does_not_arrive_is_given_up():
    autopilot = Fake([0.0] * 1000)
    with pytest.raises(RunAborted, match="not finished within 10 s"):
        list(drive(autopilot, time_limit=10.0))
    assert autopilot.steps == 51


@pytest.mark.parametrize("status", [FixStatus.MISSING, FixStatus.STALE, FixStatus.REJECTED])
def test_a_vehicle_without_a_fix_is_given_up_in_time(status):
    blind = round(BLIND / 0.2)
    autopilot = Fake([0.0] * 1000, fixes=[FixStatus.ACCEPTED] * 10 + [status] * 1000)
    with pytest.raises(RunAborted, match="neither antenna had had a valid fix for more than 15 s"):
        list(drive(autopilot, time_limit=100.0))
    assert autopilot.steps in (10 + blind, 11 + blind)  # the last is beyond the limit, or at it but for rounding


def test_a_run_may_begin_at_any_time_and_without_a_fix():
    autopilot = Fake([0.0] * 70, fixes=[FixStatus.MISSING] * 70, start=1e6)
    assert len(list(drive(autopilot, time_limit=2e6))) == 70


def test_one_fix_in_time_keeps_a_run_going():
    autopilot = Fake([0.0] * 140, fixes=([FixStatus.STALE] * 69 + [FixStatus.ACCEPTED]) * 2)
    assert len(list(drive(autopilot, time_limit=100.0))) == 140


def test_a_vehicle_that_the_gate_has_stopped_is_given_up():
    borne = [GateVerdict.REPEATED] * 4 + [GateVerdict.LIMITED]
    autopilot = Fake([0.0] * 100, verdicts=borne * 3 + [GateVerdict.STOPPED] * 100)
    with pytest.raises(RunAborted, match=r"At 3\.2 s the gate had had no valid command to let pass for 1\.0 s"):
        list(drive(autopilot, time_limit=100.0))
    assert autopilot.steps == 16
