"""The yaw-rate sensor: bias, scale, latency of fixes or sensor, when it is used, when it is dropped."""

import math
from collections.abc import Iterator

import numpy as np
import pytest
from alone import Alone
from c_signals import Real

from drawbar.codegen import Unit
from drawbar.geometry import Floats

UNIT = """
#include "yaw_rate_sensor.h"
#include "unit.h"
struct component { struct yaw_rate_sensor sensor; double judged; };
#define COMPONENT_FIELDS FIELD(component, judged, 0, 1, 0, 0) FIELD(component, sensor.latency, 0, 1, 0, 0) \\
    FIELD(component, sensor.state, 0, YAW_RATE_STATES, 0, 0) \\
    FIELD(component, sensor.covariance, 0, YAW_RATE_STATES, YAW_RATE_STATES, 0)
int UNIT(judged)(struct component *component, double measured, double wheels, double yaw, double turning,
                 double elapsed)
{
    const struct yaw_reference reference = {yaw, turning};

    component->judged = yaw_rate_judged(&component->sensor, measured, wheels, &reference, elapsed);
    return 0;
}
"""
SAMPLE = 0.2
DEGREE = math.pi / 180.0


class Sensor(Alone):
    """The sensor's judge by itself."""

    def __init__(self) -> None:
        super().__init__(Unit(name="yaw_rate", source=UNIT, configure=lambda workspace: None))

    def judged(
        self, measured: float, wheels: float, yaw: float, elapsed: float = SAMPLE, turning: float | None = None
    ) -> float:
        """Return the corrected yaw rate, rad/s (NaN: excluded); turning: of the line through both antennas."""
        line = wheels if turning is None else turning
        self.call("judged", Real(measured), Real(wheels), Real(yaw), Real(line), Real(elapsed))
        return float(self.live.array("judged").item())

    @property
    def found(self) -> Floats:
        """Bias, rad/s; lead of the integral, rad; latency of the fixes beyond the sensor's, s; error of the scale."""
        return self.live.array("sensor.state").copy()

    @property
    def bias(self) -> float:
        """rad/s."""
        return float(self.found[0])

    @property
    def latency(self) -> float:
        """Corrected for, s; below zero: the sensor's own."""
        return float(self.live.array("sensor.latency").item())


def weaving(samples: int, seed: int) -> Iterator[tuple[float, float]]:
    """Yield true yaw rates (rad/s) of a vehicle that weaves along an eight, and noisy yaws after them (rad)."""
    rng, yaw, before = np.random.default_rng(seed), 3.0, 0.0
    for k in range(samples):
        lap = (k * SAMPLE + 35.0) % 40.0
        rate = 0.06 * math.sin(0.9 * k * SAMPLE) + (0.1 if lap < 15.0 else -0.1 if 20.0 <= lap < 35.0 else 0.0)
        yaw += 0.5 * (rate + before) * SAMPLE
        before = rate
        yield rate, math.remainder(yaw + rng.normal(0.0, 1.0 * DEGREE), 2.0 * math.pi)


def answers(sensor: Sensor, measured: Floats, seed: int = 3) -> Floats:
    """Return the corrected yaw rates (n,) of measured ones (n,) of the weaving vehicle, rad/s."""
    true = weaving(measured.size, seed)
    return np.array([sensor.judged(each, rate, yaw) for each, (rate, yaw) in zip(measured.tolist(), true, strict=True)])


def rates(samples: int) -> Floats:
    return np.array([rate for rate, _ in weaving(samples, 3)])


@pytest.mark.parametrize("bias", [-3.0, 0.0, 1.0])
def test_the_bias_is_found_and_taken_off(bias: float) -> None:
    true = rates(600)
    found = answers(sensor := Sensor(), true + bias * DEGREE)
    assert np.isnan(found[:10]).all()
    assert np.isfinite(found[60:]).all()
    assert sensor.bias == pytest.approx(bias * DEGREE, abs=0.05 * DEGREE)
    assert np.abs(found[60:] - true[60:]).max() < 0.4 * DEGREE


@pytest.mark.parametrize("scale", [0.95, 1.03, 1.06])
def test_the_scale_is_found_and_taken_off(scale: float) -> None:
    true = rates(1200)
    found = answers(sensor := Sensor(), scale * true + 0.5 * DEGREE)
    assert 1.0 - sensor.found[3] == pytest.approx(1.0 / scale, abs=0.005)
    assert np.abs(found[600:] - true[600:]).max() < 0.15 * DEGREE


def test_what_is_found_is_that_of_a_kalman_filter_in_textbook_form() -> None:
    measured, sensor, missing = rates(400) + 0.02, Sensor(), range(200, 400, 3)
    state, covariance, ahead = np.zeros(4), np.diag([2.0 * DEGREE, 0.0, 0.1, 0.03]) ** 2, None
    for k, (rate, (wheels, yaw)) in enumerate(zip(measured.tolist(), weaving(400, 3), strict=True)):
        reckoned, row = sensor.latency, np.array([0.0, 1.0, wheels, 0.0])
        sensor.judged(math.nan if k in missing else rate, wheels, yaw)
        if k in missing:
            ahead = None
            continue
        if ahead is None:  # the lead that the yaw's own lateness makes, and a deviation of 2 degrees about it
            ahead, begin = yaw, np.diag([1.0, 0.0, 1.0, 1.0])
            begin[1] = [0.0, 0.0, -wheels, 0.0]
            state, covariance = begin @ state, begin @ covariance @ begin.T
            state[1] += reckoned * wheels
            covariance[1, 1] += (2.0 * DEGREE) ** 2
            continue
        turned = 0.5 * (rate + measured[k - 1]) * SAMPLE
        ahead += turned
        A = np.eye(4)
        A[1] = [SAMPLE, 1.0, 0.0, turned]
        state = A @ state
        covariance = A @ covariance @ A.T + SAMPLE * np.diag([0.005 * DEGREE, 0.2 * DEGREE, 0.002, 0.0]) ** 2
        beyond = math.remainder(ahead - yaw - row @ state + reckoned * wheels, 2.0 * math.pi)
        gain = covariance @ row / (row @ covariance @ row + (1.5 * DEGREE) ** 2)
        state = state + gain * beyond
        covariance = covariance - np.outer(gain, row @ covariance)
        np.testing.assert_allclose(sensor.found, state, rtol=0.0, atol=1e-12)


def late_yaws(samples: int, latency: float, seed: int = 3) -> Floats:
    """Return yaws (samples,) of the weaving vehicle as late fixes show them, rad, noisy by 0.7°."""
    times, true = SAMPLE * np.arange(samples), rates(samples)
    yaws = np.concatenate(([0.0], np.cumsum(0.5 * SAMPLE * (true[1:] + true[:-1]))))
    noise = np.random.default_rng(seed).normal(0.0, 0.7 * DEGREE, samples)
    return np.interp(times - latency, times, yaws) + noise


@pytest.mark.parametrize("bias", [0.0, 1.0])
@pytest.mark.parametrize("latency", [0.0, 0.05, 0.1, 0.2])
def test_the_latency_of_the_fixes_is_found_and_reckoned_with_as_far_as_it_is_sure(latency: float, bias: float) -> None:
    sensor, true = Sensor(), rates(1200)
    for rate, yaw in zip(true.tolist(), late_yaws(1200, latency).tolist(), strict=True):
        # what is reckoned with brings the fixes, and their yaw, up to now
        sensor.judged(rate + bias * DEGREE, rate, yaw + sensor.latency * rate)
    assert sensor.found[2] == pytest.approx(latency, abs=0.03)
    assert max(latency - 0.06, 0.0) <= sensor.latency <= latency + 0.02


def test_what_is_reckoned_with_changes_slowly_and_never_beyond_its_limits() -> None:
    sensor, true = Sensor(), rates(1200)
    reckoned = [0.0]
    for rate, yaw in zip(true.tolist(), late_yaws(1200, 0.5).tolist(), strict=True):
        sensor.judged(rate, rate, yaw + sensor.latency * rate)
        reckoned.append(sensor.latency)
    assert max(reckoned) == 0.25
    assert np.abs(np.diff(reckoned)).max() <= 0.02 * SAMPLE + 1e-12


def test_a_sensor_that_is_late_itself_is_reckoned_with_as_far_as_it_is_sure() -> None:
    sensor, true = Sensor(), rates(1200)
    times = SAMPLE * np.arange(1200)
    for k, yaw in enumerate(late_yaws(1200, 0.0).tolist()):
        # what is reckoned with brings the yaw rate up to now
        measured = np.interp(times[k] - 0.2 - sensor.latency, times, true)
        sensor.judged(float(measured), float(true[k]), yaw)
    assert sensor.found[2] == pytest.approx(-0.2, abs=0.03)
    assert -0.22 <= sensor.latency <= -0.14


def test_a_lasting_curve_does_not_drive_the_lateness_of_a_sensor_on() -> None:
    sensor, yaw, before = Sensor(), 0.0, 0.0
    for k in range(400):
        rate = 0.06 * math.sin(0.9 * k * SAMPLE) if k < 60 else 0.25
        yaw += 0.5 * (rate + before) * SAMPLE
        before = rate
        # a rate that changes no more is the same at any age; the fixes seem to lead by 0.15 s
        sensor.judged(rate, rate, yaw + 0.15 * rate)
    assert sensor.found[2] == pytest.approx(-0.15, abs=0.01)
    assert -0.15 <= sensor.latency <= -0.08


def test_a_sensor_that_is_missing_at_every_third_sample_shows_no_latency_that_is_not_there() -> None:
    sensor, true = Sensor(), rates(1200)
    for k, yaw in enumerate(late_yaws(1200, 0.2).tolist()):
        measured = math.nan if k % 3 == 2 else float(true[k])
        sensor.judged(measured, float(true[k]), yaw + sensor.latency * float(true[k]))
    deviation = math.sqrt(sensor.live.array("sensor.covariance")[2, 2])
    assert abs(sensor.found[2] - 0.2) < 2.0 * deviation


def test_without_a_sensor_in_use_no_latency_is_corrected() -> None:
    sensor, true = Sensor(), rates(600)
    for rate, yaw in zip(true.tolist(), late_yaws(600, 0.2).tolist(), strict=True):
        assert math.isnan(sensor.judged(-rate, rate, yaw))
    assert sensor.latency == 0.0


@pytest.mark.parametrize("scale", [-1.0, 0.0, 0.5, 2.0])
def test_a_sensor_that_is_reversed_stuck_or_scaled_is_never_used(scale: float) -> None:
    assert np.isnan(answers(Sensor(), scale * rates(600))).all()


@pytest.mark.parametrize(
    "wrong",
    [
        pytest.param(lambda rate, k: -rate, id="reversed"),
        pytest.param(lambda rate, k: 0.0, id="stuck"),
        pytest.param(lambda rate, k: rate + 5.0 * DEGREE, id="offset"),
        pytest.param(lambda rate, k: rate + (-1) ** (k // 4) * 12.0 * DEGREE, id="noisy"),
    ],
)
def test_a_sensor_that_goes_wrong_is_dropped_within_two_seconds_and_for_a_minute(wrong) -> None:
    true = rates(700)
    measured = np.array([wrong(rate, k) if 200 <= k < 300 else rate for k, rate in enumerate(true.tolist())])
    found = answers(Sensor(), measured)
    assert np.isfinite(found[60:200]).all()
    assert np.isnan(found[210:500]).all()
    assert np.isfinite(found[690:]).all()


def test_single_false_yaw_rates_and_reference_yaws_cost_their_own_samples_only() -> None:
    sensor, alone, found = Sensor(), Sensor(), []
    for k, (rate, yaw) in enumerate(weaving(600, 3)):
        false_rate, false_yaw = (rate + 5.0 if k % 40 == 20 else rate), (yaw + 1.0 if k % 40 == 39 else yaw)
        seen, expected = sensor.judged(false_rate, rate, false_yaw), alone.judged(rate, rate, yaw)
        if k >= 60:
            assert math.isnan(seen) is (k % 40 == 20)
            found.append(seen - expected)
    assert np.nanmax(np.abs(found)) < 0.25 * DEGREE  # half of its deviation


def test_a_vehicle_that_turns_sooner_than_its_wheels_say_is_followed() -> None:
    """In and out of curves within a sample, a sample before the wheels show it: that is no latency of the fixes."""
    sensor, rng, yaw, before = Sensor(), np.random.default_rng(3), 0.0, 0.0
    for k in range(900):
        rate = (0.0, 10.0, 0.0, -10.0)[k // 10 % 4] * DEGREE
        yaw += 0.5 * (rate + before) * SAMPLE
        shown = math.remainder(yaw + rng.normal(0.0, DEGREE), 2.0 * math.pi)
        sensor.judged(rate, before, shown, turning=rate)
        before = rate
        if k >= 200:
            assert abs(sensor.found[2]) < 0.05


@pytest.mark.parametrize("wrong", [lambda rate: -rate, lambda rate: rate + 5.0 * DEGREE], ids=["reversed", "offset"])
def test_a_sensor_that_goes_wrong_in_a_curve_is_excluded_at_once(wrong) -> None:
    true = rates(300)
    k = 200 + int(np.argmax(np.abs(true[200:])))
    assert np.isfinite(answers(Sensor(), true)[60:]).all()
    assert np.isnan(answers(Sensor(), np.append(true[:k], wrong(true[k : k + 20])))[k:]).all()


def test_in_a_curve_that_is_wider_than_the_wheels_say_a_sudden_offset_is_excluded() -> None:
    """By what it lacks there, about 1.5°/s, the offset differs from the wheels by 3.5°/s only."""
    sensor, wrong = Sensor(), 255
    for k, (rate, yaw) in enumerate(weaving(400, 3)):
        found = sensor.judged(rate + 5.0 * DEGREE if k >= wrong else rate, 1.25 * rate, yaw)
        assert k < 100 or math.isnan(found) is (k >= wrong)


def test_a_sensor_that_becomes_noisy_is_left_out_for_a_minute() -> None:
    rng, true = np.random.default_rng(5), rates(700)
    measured = np.array(
        [rate + rng.normal(0.0, 5.0 * DEGREE) if 200 <= k < 300 else rate for k, rate in enumerate(true)]
    )
    found = answers(Sensor(), measured)
    assert np.isfinite(found[60:200]).all()
    assert np.isnan(found[215:500]).all()
    assert np.isfinite(found[690:]).all()


def test_on_ground_where_it_usually_differs_from_the_wheels_it_goes_on() -> None:
    sensor, rng = Sensor(), np.random.default_rng(5)
    found = [sensor.judged(rate, rate + rng.normal(0.0, 3.0 * DEGREE), yaw) for rate, yaw in weaving(600, 3)]
    assert np.isfinite(found[100:]).mean() > 0.99


def test_values_that_are_missing_or_of_no_time_are_none() -> None:
    sensor, true = Sensor(), rates(100)
    assert np.isfinite(answers(sensor, true)[-1])
    assert math.isnan(sensor.judged(math.nan, 0.1, 0.0))
    assert math.isnan(sensor.judged(math.inf, 0.1, 0.0))
    assert math.isnan(sensor.judged(0.1, 0.1, 0.0, elapsed=0.0))
    assert math.isnan(sensor.judged(0.1, math.nan, 0.0))


def test_without_positions_it_goes_on() -> None:
    sensor, true = Sensor(), rates(160)
    for k, (rate, yaw) in enumerate(weaving(160, 3)):
        found = sensor.judged(true[k], rate, yaw if k < 100 else math.nan)
    assert found == pytest.approx(true[-1], abs=0.4 * DEGREE)
