"""The steering rate that plans keep on machines for which the shipped bounds were not declared."""

import re

import pytest

from drawbar.config import load_configuration
from drawbar.control.tube.kept_rate import with_kept_rates
from drawbar.control.tube.tube import tubes_of
from drawbar.errors import TubeError
from drawbar.step.build import build_tubes, operating_conditions

SLOW = ("sample_time=0.1", "vehicle.steering_lag=0.13", "vehicle.tractor_steering_rate=0.12")


def kept(*changes):
    configuration = load_configuration("articulated", changes)
    conditions = operating_conditions(configuration)
    return configuration, conditions, with_kept_rates(configuration.controller, conditions, configuration.tube)


def test_the_shipped_machine_keeps_its_rate_with_what_is_declared():
    configuration, _, tube = kept()
    assert tube == configuration.tube


def test_a_slow_steering_keeps_its_rate_and_falls_short_by_no_more_than_that_takes():
    configuration, conditions, tube = kept(*SLOW)
    declared = configuration.tube.tractor.disturbances["steering_rate"]
    counted = tube.tractor.disturbances["steering_rate"]
    assert counted > declared
    for size, enough in ((declared, False), (0.99 * counted, False), (counted, True)):
        tractor = tube.tractor.model_copy(update={"disturbances": {**tube.tractor.disturbances, "steering_rate": size}})
        tubes = tubes_of(
            conditions.vehicle,
            configuration.controller,
            tube.model_copy(update={"tractor": tractor}),
            speed=conditions.speed,
            sample_time=conditions.sample_time,
        )
        assert (tubes.tractor.bounds["steering_rate"].tightened >= conditions.vehicle.tractor_steering_rate) is enough


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_the_part_that_is_kept_is_what_is_left(share):
    bounds = build_tubes(load_configuration("articulated", [*SLOW, f"tube.tractor.kept_rate={share}"])).tractor.bounds
    left = bounds["steering_rate"].tightened / bounds["steering_rate"].original
    assert left < 0.01 if share == 0.0 else left == pytest.approx(share, abs=0.01)


def test_where_the_gain_takes_the_rate_it_is_said():
    with pytest.raises(
        TubeError,
        match=r"less of its steering rate, 0\.436 rad/s, than plans need \(tube\.tractor\.kept_rate = 1\); lower",
    ):
        build_tubes(load_configuration("articulated", ["tube.tractor.yaw=-5.0"]))


def test_samples_too_far_apart_are_refused_with_a_sample_time_that_is_not():
    far = (
        *("vehicle.wheelbase=2.4", "vehicle.steering_lag=0.05", "vehicle.tractor_steering_limit=0.61"),
        *("speed=3.5", "machine.hydrostat.full_speed=5.0"),
    )
    with pytest.raises(TubeError, match="lower sample_time or speed") as refused:
        kept(*far, "sample_time=0.5")
    enough = re.search(r"at this speed sample_time = (.+) s is short enough$", str(refused.value))
    assert enough
    assert 0.2 < float(enough[1]) < 0.5
    kept(*far, f"sample_time={enough[1]}")
