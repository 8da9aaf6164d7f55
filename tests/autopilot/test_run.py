import math
from dataclasses import dataclass, field

import pytest

from drawbar.autopilot.run import LOST, RunAborted, drive


@dataclass
class Fake:
    """An autopilot whose steps are records of the given lateral errors, 0.2 s apart."""

    errors: list[float]
    steps: int = 0
    guidance: "Fake" = field(init=False)

    def __post_init__(self):
        self.guidance = self
        self.measurement = self.reference = self.tractor = self
        self.time = self.lateral_error = 0.0

    @property
    def finished(self):
        return self.steps == len(self.errors)

    def step(self):
        self.lateral_error = self.errors[self.steps]
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
