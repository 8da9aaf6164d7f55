"""Impossible machines and events are refused where they are declared."""

import math
from typing import Any

import pytest
from pydantic import ValidationError

from drawbar.machine.events import Bump, GpsLoss
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.machine.steps import whole_steps

LOSS = {"kind": "gps_loss", "start": 1.0, "duration": 2.0}


@pytest.mark.parametrize("name", ["speed_lag", "pedal_lag"])
def test_a_lag_that_the_step_cannot_follow_is_refused(name: str) -> None:
    with pytest.raises(ValidationError, match=rf"hydrostat\.{name} = 0\.004 s is less than half of step = 0\.01 s"):
        SimulatedMachineSettings.model_validate({"hydrostat": {name: 0.004}})


def test_events_are_read_by_their_kind_from_a_list() -> None:
    """As a TOML array of tables delivers them."""
    bump = {"kind": "bump", "start": 3.0, "lateral": 0.05}
    settings = SimulatedMachineSettings.model_validate({"events": [LOSS, bump]})
    assert settings.events == (GpsLoss(start=1.0, duration=2.0), Bump(start=3.0, lateral=0.05))


@pytest.mark.parametrize(
    "event",
    [
        {**LOSS, "start": -1.0},
        {**LOSS, "duration": 0.0},
        {**LOSS, "duration": math.inf},
        {**LOSS, "start": math.nan},
        {**LOSS, "antenna": "roof"},
        {**LOSS, "report": "zero"},
        {**LOSS, "kind": "gps_lost"},
        {**LOSS, "until": 3.0},
        {"start": 1.0, "duration": 2.0},
        {"kind": "slip_step", "start": 1.0, "factor": "tractor_slip", "value": 1.01},
        {"kind": "slip_step", "start": 1.0, "factor": "tractor_slip", "value": 0.0},
        {"kind": "slip_step", "start": 1.0, "factor": "alpha", "value": 0.9},
        {"kind": "side_slope", "start": 1.0, "crab": 3.0},
        {"kind": "side_slope", "start": 1.0, "crab": 0.05, "ramp": 0.0},
        {"kind": "bump", "start": 1.0, "tractor_yaw": 20.0},
        {"kind": "bump", "start": 1.0, "lateral": math.nan},
        {"kind": "gps_jump", "start": 1.0, "east": 0.5},
    ],
)
def test_event_outside_sense_is_refused(event: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        SimulatedMachineSettings.model_validate({"events": [event]})


@pytest.mark.parametrize(
    "settings",
    [
        {"step": 0.0},
        {"actuators": {"dead_time": -0.1}},
        {"actuators": {"tractor_rate": 25.0}},
        {"ground": {"longitudinal_slip": {"mean": 1.2, "deviation": 0.0}}},
        {"ground": {"tractor_crab": {"deviation": -0.01}}},
        {"sensors": {"position": -0.03}},
        {"sensors": {"steering_resolution": 0.0}},
        {"hydrostat": {"full_speed": 0.0}},
    ],
)
def test_impossible_machine_is_refused(settings: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        SimulatedMachineSettings.model_validate(settings)


def test_dead_time_off_the_grid_is_refused_with_both_numbers() -> None:
    with pytest.raises(ValidationError, match=r"dead_time = 0\.015 s is not a multiple of step = 0\.01 s"):
        SimulatedMachineSettings.model_validate({"actuators": {"dead_time": 0.015}})


@pytest.mark.parametrize(
    ("duration", "step", "steps"), [(0.2, 0.01, 20), (0.0, 0.01, 0), (0.3, 0.1, 3), (0.205, 0.01, None)]
)
def test_duration_is_counted_in_steps_only_where_it_is_a_multiple(
    duration: float, step: float, steps: int | None
) -> None:
    assert whole_steps(duration, step) == steps
