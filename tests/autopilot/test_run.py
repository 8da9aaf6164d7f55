import math
from dataclasses import dataclass, field

import pytest

from drawbar.autopilot.run import BLIND, LOST, REFUSED, RunAborted, drive
from drawbar.signals import FixStatus


@dataclass
class Fake:
    """An autopilot whose steps are records of the given lateral errors, 0.2 s apart."""

    errors: list[float]
    fixes: list[FixStatus] = field(default_factory=list)
    """of the tractor's antenna at each step; accepted beyond the list's end"""
    refusals: list[bool] = field(default_factory=list)
    steps: int = 0
    trailer_fix: FixStatus = FixStatus.MISSING
    guidance: "Fake" = field(init=False)

    def __post_init__(self):
        self.guidance = self
        self.measurement = self.estimate = self.reference = self.tractor = self
        self.time = self.lateral_error = 0.0

    @property
    def finished(self):
        return self.steps == len(self.errors)

    def step(self):
        self.lateral_error = self.errors[self.steps]
        self.tractor_fix = self.fixes[self.steps] if self.steps < len(self.fixes) else FixStatus.ACCEPTED
        self.command_refused = self.steps < len(self.refusals) and self.refusals[self.steps]
        self.steps += 1
        self.time = 0.2 * self.steps
        return self


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


def test_one_fix_in_time_keeps_a_run_going():
    autopilot = Fake([0.0] * 140, fixes=([FixStatus.STALE] * 69 + [FixStatus.ACCEPTED]) * 2)
    assert len(list(drive(autopilot, time_limit=100.0))) == 140


def test_a_vehicle_whose_commands_are_refused_is_given_up():
    autopilot = Fake([0.0] * 100, refusals=([True] * (REFUSED - 1) + [False]) * 3 + [True] * 100)
    with pytest.raises(RunAborted, match="refused 5 commands in a row"):
        list(drive(autopilot, time_limit=100.0))
    assert autopilot.steps == 4 * REFUSED
