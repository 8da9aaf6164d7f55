"""The yaw-rate sensor: its bias, when it is used, and that it is dropped where it contradicts antennas or wheels."""

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
struct component { struct yaw_rate_sensor sensor; double believed, bias; };
#define COMPONENT_FIELDS FIELD(component, believed, 0, 1, 0, 0) FIELD(component, bias, 0, 1, 0, 0)
int UNIT(believed)(struct component *component, double told, double wheels, double yaw, double elapsed)
{
    component->believed = yaw_rate_believed(&component->sensor, told, wheels, yaw, elapsed);
    component->bias = component->sensor.bias;
    return 0;
}
"""
SAMPLE = 0.2
DEGREE = math.pi / 180.0


class Sensor(Alone):
    """The sensor's judge by itself."""

    def __init__(self) -> None:
        super().__init__(Unit(name="yaw_rate", source=UNIT, configure=lambda workspace: None))

    def believed(self, told: float, wheels: float, yaw: float, elapsed: float = SAMPLE) -> float:
        """Return the yaw rate to be believed, rad/s."""
        self.call("believed", Real(told), Real(wheels), Real(yaw), Real(elapsed))
        return float(self.live.array("believed").item())

    @property
    def bias(self) -> float:
        """rad/s."""
        return float(self.live.array("bias").item())


def weaving(samples: int, seed: int) -> Iterator[tuple[float, float]]:
    """Yield true yaw rates (rad/s) of a vehicle that weaves along an eight, and noisy yaws after them (rad)."""
    rng, yaw = np.random.default_rng(seed), 3.0
    for k in range(samples):
        lap = (k * SAMPLE + 35.0) % 40.0
        rate = 0.06 * math.sin(0.9 * k * SAMPLE) + (0.1 if lap < 15.0 else -0.1 if 20.0 <= lap < 35.0 else 0.0)
        yaw += rate * SAMPLE
        yield rate, math.remainder(yaw + rng.normal(0.0, 1.0 * DEGREE), 2.0 * math.pi)


def answers(sensor: Sensor, told: Floats, seed: int = 3) -> Floats:
    """Return what is believed (n,) of told yaw rates (n,) of the weaving vehicle, rad/s."""
    true = weaving(told.size, seed)
    return np.array([sensor.believed(each, rate, yaw) for each, (rate, yaw) in zip(told.tolist(), true, strict=True)])


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


def test_the_bias_is_that_of_a_kalman_filter_in_textbook_form() -> None:
    told, sensor = rates(100) + 0.02, Sensor()
    state, covariance, ahead = np.zeros(2), np.diag([2.0 * DEGREE, 2.0 * DEGREE]) ** 2, None
    for rate, (wheels, yaw) in zip(told.tolist(), weaving(100, 3), strict=True):
        sensor.believed(rate, wheels, yaw)
        if ahead is None:
            ahead = yaw
            continue
        ahead += rate * SAMPLE
        A = np.array([[1.0, 0.0], [SAMPLE, 1.0]])
        state = A @ state
        covariance = A @ covariance @ A.T + SAMPLE * np.diag([0.005 * DEGREE, 0.3 * DEGREE]) ** 2
        beyond = math.remainder(ahead - yaw - state[1], 2.0 * math.pi)
        gain = covariance[:, 1] / (covariance[1, 1] + (1.5 * DEGREE) ** 2)
        state = state + gain * beyond
        covariance = covariance - np.outer(gain, covariance[1])
        assert sensor.bias == pytest.approx(state[0], abs=1e-12)


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
    told = np.array([wrong(rate, k) if 200 <= k < 300 else rate for k, rate in enumerate(true.tolist())])
    found = answers(Sensor(), told)
    assert np.isfinite(found[60:200]).all()
    assert np.isnan(found[210:500]).all()
    assert np.isfinite(found[690:]).all()


@pytest.mark.parametrize("wrong", [lambda rate: -rate, lambda rate: rate + 12.0 * DEGREE], ids=["reversed", "offset"])
def test_a_sensor_that_goes_wrong_in_a_curve_is_not_believed_even_once(wrong) -> None:
    true = rates(300)
    k = 200 + int(np.argmax(np.abs(true[200:])))
    assert np.isfinite(answers(Sensor(), true)[60:]).all()
    assert np.isnan(answers(Sensor(), np.append(true[:k], wrong(true[k : k + 20])))[k:]).all()


def test_on_ground_where_it_usually_differs_from_the_wheels_it_goes_on() -> None:
    sensor, rng = Sensor(), np.random.default_rng(5)
    found = [sensor.believed(rate, rate + rng.normal(0.0, 3.0 * DEGREE), yaw) for rate, yaw in weaving(600, 3)]
    assert np.isfinite(found[100:]).mean() > 0.99


def test_values_that_are_missing_or_of_no_time_are_none() -> None:
    sensor, true = Sensor(), rates(100)
    assert np.isfinite(answers(sensor, true)[-1])
    assert math.isnan(sensor.believed(math.nan, 0.1, 0.0))
    assert math.isnan(sensor.believed(math.inf, 0.1, 0.0))
    assert math.isnan(sensor.believed(0.1, 0.1, 0.0, elapsed=0.0))
    assert math.isnan(sensor.believed(0.1, math.nan, 0.0))


def test_without_positions_it_goes_on() -> None:
    sensor, true = Sensor(), rates(160)
    for k, (rate, yaw) in enumerate(weaving(160, 3)):
        found = sensor.believed(true[k], rate, yaw if k < 100 else math.nan)
    assert found == pytest.approx(true[-1], abs=0.4 * DEGREE)
