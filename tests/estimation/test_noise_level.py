import numpy as np
import pytest

from drawbar.estimation.noise_level import NoiseLevel


def level(series, limit=10.0):
    noise = NoiseLevel(memory=10_000)
    for disagreement in series:
        noise.update(tuple(disagreement), limit)
    return noise.deviation


def test_the_deviation_is_that_of_one_coordinate_of_one_antenna():
    tractor, trailer = np.random.default_rng(1).normal(scale=0.03, size=(2, 10_000, 2))
    assert level(tractor - trailer) == pytest.approx(0.03, rel=0.03)


def test_it_does_not_see_what_lasts_or_grows_slowly():
    tractor, trailer = np.random.default_rng(2).normal(scale=0.03, size=(2, 10_000, 2))
    honest = level(tractor - trailer)
    drifting = tractor - trailer + np.linspace(0.0, 50.0, 10_000)[:, None]
    drifting[5000:] += 3.0
    assert level(drifting, limit=0.3) == pytest.approx(honest, rel=0.03)


def test_nothing_is_known_at_first_and_across_an_interruption():
    noise = NoiseLevel(memory=10)
    noise.update((1.0, 0.0), 10.0)
    noise.interrupt()
    noise.update((5.0, 0.0), 10.0)
    assert noise.deviation == 0.0
