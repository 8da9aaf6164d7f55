"""Sensor errors have the deviations of their settings; GPS events touch what they name, when they say."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.machine.events import Event, GpsJump, GpsLoss
from drawbar.machine.sensor_errors import SensorErrors
from drawbar.machine.sensor_settings import SensorSettings

TIMES = 0.2 * np.arange(5000.0)


def block(*events: Event, settings: SensorSettings | None = None, seed: int = 6) -> tuple[Floats, NDArray[np.bool_]]:
    return SensorErrors(settings or SensorSettings(), events, 0.2, np.random.default_rng(seed)).block(TIMES)


def test_deviations_are_those_of_the_settings() -> None:
    """5,000 samples: four standard errors of a deviation are 4 %."""
    errors, held = block(settings=SensorSettings(steering=0.01))
    expected = [0.03, 0.03, 0.03, 0.03, 0.0175, 0.1, 0.01, 0.01]
    assert errors.std(axis=0) == pytest.approx(expected, rel=0.04)
    assert np.abs(np.corrcoef(errors.T) - np.eye(8)).max() < 4.0 / math.sqrt(5000)
    assert not held.any()


def test_default_position_error_is_white_and_drift_is_correlated() -> None:
    white = block()[0][:, 0]
    assert abs(np.corrcoef(white[:-1], white[1:])[0, 1]) < 4.0 / math.sqrt(5000)
    drift = SensorSettings(position=0.0, position_drift=0.02, drift_time=1.0)
    errors = block(settings=drift)[0][:, :4]
    assert errors.std(axis=0) == pytest.approx(np.full(4, 0.02), rel=0.12)
    for column in errors.T:
        correlation = np.corrcoef(column[:-1], column[1:])[0, 1]
        assert correlation == pytest.approx(math.exp(-0.2), abs=0.035)


@pytest.mark.parametrize(("antenna", "touched"), [("tractor", [0, 1]), ("trailer", [2, 3]), ("both", [0, 1, 2, 3])])
def test_events_touch_their_antenna_during_their_time_only(antenna: str, touched: list[int]) -> None:
    """8.6 s to 9.2 s are samples 43, 44 and 45, although 43 · 0.2 is not exactly 8.6 in a double."""
    window = {"start": 8.6, "duration": 0.6, "antenna": antenna}
    calm, _ = block()
    masked, _ = block(GpsLoss.model_validate(window))
    held_errors, held = block(GpsLoss.model_validate({**window, "report": "held"}))
    jumped, _ = block(GpsJump.model_validate({**window, "east": 0.5, "north": -0.25}))
    expected = np.zeros((len(TIMES), 8), dtype=bool)
    expected[43:46, touched] = True
    assert np.array_equal(np.isnan(masked), expected)
    assert np.array_equal(masked[~expected], calm[~expected])
    assert np.array_equal(held, expected[:, :4])
    assert np.array_equal(held_errors, calm)
    shift = np.where(expected, [0.5, -0.25, 0.5, -0.25, 0.0, 0.0, 0.0, 0.0], 0.0)
    assert jumped - calm == pytest.approx(shift, abs=1e-14)
