"""A recorded run, computed again: the very numbers, or the first that is not."""

from dataclasses import replace

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError, DrawbarError
from drawbar.recompute import replay
from drawbar.recording.log import read_log
from drawbar.recording.recorder import Recorder
from drawbar.simulation import Simulation

SHORT = ("path.radii=[8.0]", "path.straight_length=4.0")
LOSS = "machine.events=[{kind='gps_loss', start=10.0, duration=4.0}]"


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """Return a function that drives, writes a log file and reads it back."""

    def recorded(name, *changes):
        file = tmp_path_factory.mktemp("replay") / "log.mcap"
        simulation = Simulation(load_configuration(name, [*SHORT, *changes]))
        with simulation, Recorder(file, simulation.header()) as recorder:
            for record in simulation.steps():
                recorder.write(record)
        return read_log(file)

    return recorded


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("articulated", ()),
        ("articulated", (LOSS,)),
        ("articulated", ("vehicle.dead_time=0.3", "machine.actuators.dead_time=0.3")),
        ("articulated-ekf", ()),
        ("articulated-ideal", ()),
        ("articulated-centralised", ()),
        ("paper", ()),
        ("lqr-pi", ()),
    ],
)
def test_every_number_is_the_recorded_one(recorded, name, changes):
    log = recorded(name, *changes)
    again = replay(log)
    assert len(again.records) == len(log.records) > 100
    assert again.differences == ()


def test_the_first_number_that_differs_is_reported(recorded):
    log = recorded("articulated")
    touched = list(log.records)
    estimate = touched[40].estimate
    touched[40] = replace(touched[40], estimate=replace(estimate, speed=np.nextafter(estimate.speed, 2.0)))
    (only,) = replay(replace(log, records=tuple(touched))).differences
    assert (only.step, only.signal) == (40, "estimate.speed")
    assert 0.0 < only.size < 1e-15


def test_another_measurement_makes_another_run(recorded):
    log = recorded("articulated")
    touched = list(log.records)
    measurement = touched[30].measurement
    touched[30] = replace(touched[30], measurement=replace(measurement, hitch_angle=measurement.hitch_angle + 1e-3))
    again = replay(replace(log, records=tuple(touched)))
    assert again.differences[0].step == 30
    assert again.largest["estimate.hitch_angle"] > 1e-6


def test_steps_before_the_first_that_is_lost_are_recomputed(recorded):
    log = recorded("articulated")
    damaged = replace(log, records=log.records[:60] + log.records[70:], losses=("steps 60 to 69 are lost",))
    again = replay(damaged)
    assert (len(again.records), again.differences, again.cut) == (60, (), "steps 60 to 69 are lost")
    assert replay(log).cut == ""
    with pytest.raises(DrawbarError, match="the first steps are lost, and nothing can be recomputed"):
        replay(replace(log, records=log.records[1:]))


def test_another_setting_is_compared(recorded):
    again = replay(recorded("articulated"), ["controller.tractor.lateral=30.0"])
    first = again.differences[0]
    assert first.signal.startswith("plan.tractor")
    assert "command.tractor_steering" in again.largest
    assert "estimate.hitch_angle" not in {each.signal for each in again.differences if each.step == first.step}


@pytest.mark.parametrize("change", ["controller.horizon=8", "sample_time=0.1"])
def test_a_setting_with_other_stages_is_compared_in_what_both_have(recorded, change):
    log = recorded("articulated")
    again = replay(log, [change])
    assert len(again.records) == len(log.records)
    assert "command.tractor_steering" in again.largest


def test_a_wrong_setting_is_refused(recorded):
    with pytest.raises(ConfigurationError, match="has no key weight"):
        replay(recorded("articulated"), ["controller.weight=3.0"])


@pytest.mark.parametrize("changes", [(), ("controller.tractor.lateral=30.0",)])
def test_numbers_that_are_missing_are_differences_but_of_another_setting(recorded, changes):
    log = recorded("articulated")
    touched = list(log.records)
    plan = touched[20].plan
    shorter = replace(plan.tractor, steerings=plan.tractor.steerings[:-1])
    touched[20] = replace(touched[20], plan=replace(plan, tractor=shorter))
    missing = f"plan.tractor.steerings.{len(shorter.steerings)}"
    found = replay(replace(log, records=tuple(touched)), changes).differences
    assert (missing in {each.signal for each in found if each.step == 20}) == (not changes)
