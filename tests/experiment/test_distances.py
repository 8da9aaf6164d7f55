"""Figures of a body's distance from the path: of the whole run, of its straights, and of each straight by itself."""

from types import SimpleNamespace

import numpy as np
import pytest

from drawbar.experiment.distances import distance_figures


def result(error, curvature, step=0.5):
    """Return a run with a sample every half metre."""
    columns = {
        "error.trailer": np.asarray(error, float),
        "progress.trailer": 3.0 + step * np.arange(len(error)),
        "reference.trailer.closest.3": np.asarray(curvature, float),
    }
    return SimpleNamespace(columns=columns)


def test_the_first_metres_do_not_count():
    error = np.where(np.arange(100) * 0.5 > 5.0, 0.02, 1.0)
    found = distance_figures(result(error, np.zeros(100)), "trailer")
    assert found["trailer mean"] == pytest.approx(2.0)
    assert found["trailer largest"] == found["trailer 95 %"] == pytest.approx(2.0)
    assert found["trailer SD"] == pytest.approx(0.0, abs=1e-12)


def test_straights_that_lie_aside_deviate_together_and_not_each_by_itself():
    aside = np.concatenate([np.full(100, 0.03), np.full(40, 0.5), np.full(100, -0.03)])
    aside += np.concatenate([np.zeros(140), np.where(np.arange(100) * 0.5 <= 5.0, 0.2, 0.0)])  # left by the curve
    curvature = np.concatenate([np.zeros(100), np.full(40, 0.125), np.zeros(100)])
    wave = 0.01 * np.tile([1.0, -1.0], 120)
    found = distance_figures(result(aside + wave, curvature), "trailer")
    assert found["trailer each straight SD"] == pytest.approx(1.0, rel=0.01)
    assert found["trailer straight SD"] > 3.0
    assert found["trailer SD"] > 10.0


def test_a_run_without_straights_has_no_deviation_on_them():
    found = distance_figures(result(np.full(100, 0.01), np.full(100, 0.1)), "trailer")
    assert np.isnan(found["trailer straight SD"])
    assert np.isnan(found["trailer each straight SD"])
    assert found["trailer mean"] == pytest.approx(1.0)


def test_a_run_that_ended_at_once_has_no_figures():
    assert all(map(np.isnan, distance_figures(result(np.zeros(4), np.zeros(4)), "trailer").values()))
