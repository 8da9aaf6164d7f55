"""The random processes have the statistics theory gives them, whatever the step. Seeds are fixed."""

import math

import numpy as np
import pytest

from drawbar.machine.random_processes import OrnsteinUhlenbeck


def process(step: float, seed: int, count: int) -> OrnsteinUhlenbeck:
    return OrnsteinUhlenbeck(
        deviations=np.full(count, 0.4),
        time_constants=np.full(count, 5.0),
        step=step,
        rng=np.random.default_rng(seed),
    )


@pytest.mark.parametrize("step", [0.01, 1.0, 20.0])
def test_variance_is_stationary_from_the_first_value_and_independent_of_the_step(step: float) -> None:
    """20,000 independent processes of 3 values: the standard error of each deviation is 0.5 %."""
    values = process(step, seed=1, count=20_000).sample(3)
    assert values.std(axis=1) == pytest.approx(np.full(3, 0.4), rel=0.02)
    assert values.mean(axis=1) == pytest.approx(np.zeros(3), abs=4.0 * 0.4 / math.sqrt(20_000))


def test_correlation_decays_with_the_time_constant() -> None:
    """Over 1, 5 and 10 s the correlation is exp(-lag/5 s), to four standard errors of 20,000 pairs."""
    values = process(1.0, seed=2, count=20_000).sample(11)
    for lag in (1, 5, 10):
        measured = np.mean(values[0] * values[lag]) / 0.4**2
        assert measured == pytest.approx(math.exp(-lag / 5.0), abs=4.0 * math.sqrt(2.0 / 20_000))


def test_blocks_join_without_a_seam() -> None:
    """Two blocks are one long block: the recursion carries over."""
    whole, parts = process(0.1, seed=3, count=1), process(0.1, seed=3, count=1)
    assert np.concatenate([parts.sample(7), parts.sample(5)]) == pytest.approx(whole.sample(12), abs=1e-15)


def test_recursion_is_the_textbook_one() -> None:
    """Against the plain loop on the same draws."""
    rng = np.random.default_rng(4)
    value, decay = 0.4 * rng.standard_normal(1)[0], math.exp(-0.1 / 5.0)
    expected = []
    for noise in rng.standard_normal(50):
        value = decay * value + 0.4 * math.sqrt(1.0 - decay**2) * noise
        expected.append(value)
    assert process(0.1, seed=4, count=1).sample(50)[:, 0] == pytest.approx(np.array(expected), abs=1e-14)
