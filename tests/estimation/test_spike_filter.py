"""Speed and steering: a single value that leaps is masked."""

import math
from dataclasses import replace

import numpy as np
import pytest
from screening_alone import drive, screened


@pytest.mark.parametrize(
    ("name", "false"), [("speed", 9.0), ("speed", -9.0), ("tractor_steering", 1.4), ("trailer_steering", -0.5)]
)
def test_a_single_value_that_leaps_is_masked_and_two_are_believed(name, false):
    usual = getattr(drive(1)[0], name)
    told = [usual] * 10 + [false] + [usual] * 5 + [false] * 5 + [math.nan] + [usual] * 3
    measurements = [replace(m, **{name: value}) for m, value in zip(drive(len(told)), told, strict=True)]
    seen = [getattr(result.measurement, name) for result in screened(measurements)]
    masked = [k for k, value in enumerate(seen) if math.isnan(value)]
    assert masked == [10, 16, 21, 22]  # alone; the first of some; missing; the first of those that come back
    assert all(value == told[k] for k, value in enumerate(seen) if k not in masked)


def test_steering_and_speed_that_change_as_fast_as_machines_do_pass():
    rng = np.random.default_rng(5)
    rates = np.clip(np.cumsum(rng.normal(0.0, 0.2, 400)), -1.0, 1.0)  # 57°/s and 4 m/s² at most
    measurements = [
        replace(m, tractor_steering=0.19 * rate, trailer_steering=-0.19 * rate, speed=2.0 + 0.8 * rate)
        for m, rate in zip(drive(400), np.where(np.arange(400) % 2, rates, 0.0).tolist(), strict=True)
    ]
    assert all(
        math.isfinite(r.measurement.speed + r.measurement.tractor_steering + r.measurement.trailer_steering)
        for r in screened(measurements)
    )
