"""The simulated machine with valves and a pedal under drawbar_actuate, and the figures of the benchmark."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from drawbar.benchmark.actuation import ANGLE_CASES, SPEED_CASES, angle_table, drive_angle, drive_speed, speed_table
from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.machine.low_level.settings import LowLevelSettings
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.machine.simulated import SimulatedMachine
from drawbar.signals import Command, Pose
from drawbar.simulation import Simulation
from drawbar.vehicle.parameters import VehicleParameters


def machine(low_level: LowLevelSettings) -> SimulatedMachine:
    return SimulatedMachine(
        vehicle=VehicleParameters(),
        settings=SimulatedMachineSettings(low_level=low_level),
        sample_time=0.2,
        start=Pose(x=0.0, y=0.0, yaw=0.0),
        seed=0,
    )


def driven(low_level: LowLevelSettings, samples: int, command: Command) -> list[tuple[float, float, float]]:
    """Return both true angles and the speed, sample by sample."""
    simulated = machine(low_level)
    truths = []
    for _ in range(samples):
        simulated.read()
        simulated.write(command)
        truth = simulated.truth()
        truths.append((truth.tractor_steering, truth.trailer_steering, truth.speed))
    return truths


COMMAND = Command(time=0.0, tractor_steering=0.2, trailer_steering=-0.1, speed=1.0)


def test_valves_bring_both_angles_and_the_pedal_the_speed() -> None:
    front, joint, speed = driven(LowLevelSettings(kind="valve"), 50, COMMAND)[-1]
    assert front == pytest.approx(0.2, abs=math.radians(0.35))
    assert joint == pytest.approx(-0.1, abs=math.radians(0.35))
    assert speed == pytest.approx(1.0, abs=0.05)


def test_without_compensation_the_dead_band_stays_as_an_error() -> None:
    kept = LowLevelSettings(kind="valve")
    loop = kept.front_loop.model_copy(update={"compensation": 0.0})
    front, *_ = driven(kept.model_copy(update={"front_loop": loop}), 50, COMMAND)[-1]
    assert math.degrees(0.2 - front) > 0.6


def test_the_same_settings_give_the_same_run() -> None:
    assert driven(LowLevelSettings(kind="valve"), 20, COMMAND) == driven(LowLevelSettings(kind="valve"), 20, COMMAND)


def test_lags_are_what_they_were_whatever_the_low_level_says() -> None:
    other = LowLevelSettings(dead_time=0.033, sensor_step=0.01)
    assert driven(other, 20, COMMAND) == driven(LowLevelSettings(), 20, COMMAND)


def test_a_dead_time_off_the_grid_is_refused() -> None:
    with pytest.raises(ConfigurationError, match=r"low_level\.dead_time"):
        load_configuration("articulated", ("machine.low_level.kind=valve", "machine.low_level.dead_time=0.033"))


def test_the_figure_eight_is_driven_with_valves_as_well() -> None:
    configuration = load_configuration("articulated", ("machine.low_level.kind=valve",))
    with Simulation(configuration, 0) as simulation:
        records = list(simulation.steps())
    errors = np.array([record.reference.tractor.lateral_error for record in records[50:]])
    assert records[-1].status.is_new_command
    assert np.abs(errors).max() < 0.1


def test_figures_of_the_angle_loop_are_those_of_the_facts() -> None:
    """hardware.md 5.3: t90, overshoot and rest error of the same laws in a model of its own."""
    expected = {
        0: (0.70, 0.0, 0.70),
        1: (0.62, 0.2, 0.0),
        2: (0.52, 1.0, 0.0),
        3: (0.50, 1.5, 0.0),
        5: (0.62, 0.05, 0.05),
    }
    for i, (t90, overshoot, rest) in expected.items():
        made = drive_angle(ANGLE_CASES[i])
        assert made.t90 == pytest.approx(t90, abs=0.025)
        assert math.degrees(made.overshoot) == pytest.approx(overshoot, abs=0.1)
        assert abs(math.degrees(made.rest)) == pytest.approx(rest, abs=0.05)
    assert drive_angle(ANGLE_CASES[5]).reversals == 0
    assert drive_angle(ANGLE_CASES[6]).reversals > 5


def test_figures_of_the_speed_cascade_are_no_worse_than_those_of_the_facts() -> None:
    stated = ((0.36, 0.18, 2.5), (0.18, 0.18, 2.5), (0.09, 0.11, 1.7), (0.12, 0.23, 7.0))
    for case, (overshoot, dip, back) in zip(SPEED_CASES, stated, strict=True):
        made = drive_speed(case)
        assert made.overshoot <= overshoot
        assert made.dip <= dip
        assert made.back <= back


def test_the_page_shows_the_tables_that_the_command_prints(repository_page: Callable[[str], str]) -> None:
    page = repository_page("actuation.md")
    assert angle_table() in page
    assert speed_table() in page
