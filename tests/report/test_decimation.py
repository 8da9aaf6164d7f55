"""A decimated curve hides no extreme and no gap."""

import numpy as np
import pytest

from drawbar.report.decimation import POINTS, extremes, thinned


@pytest.mark.parametrize("count", [0, 1, POINTS])
def test_short_curves_are_whole(count: int) -> None:
    np.testing.assert_array_equal(extremes(np.zeros(count)), np.arange(count))


@pytest.mark.parametrize("count", [POINTS + 1, 50_001, 500_000])
def test_long_curves_are_few_points_with_every_spike_and_gap(count: int) -> None:
    rng = np.random.default_rng(count)
    values = rng.normal(size=count)
    spikes = rng.choice(count, 50, replace=False)
    values[spikes[:20]], values[spikes[20:40]], values[spikes[40:]] = 100.0, -100.0, np.nan
    kept = extremes(values)
    assert len(kept) <= POINTS + 2
    assert (np.diff(kept) > 0).all()
    assert (kept[0], kept[-1]) == (0, count - 1)
    size = -(-count // (POINTS // 3))
    for spike in spikes:
        near = kept[(kept >= spike - size) & (kept <= spike + size)]
        drawn = values[near]
        assert np.isnan(drawn).any() if np.isnan(values[spike]) else (drawn == values[spike]).any()


def test_all_missing_is_a_gap() -> None:
    assert np.isnan(np.full(50_000, np.nan)[extremes(np.full(50_000, np.nan))]).all()


@pytest.mark.parametrize("count", [0, 1, 10_000, 10_001, 500_000])
def test_thinned_indices_are_few_and_end_with_the_last(count: int) -> None:
    kept = thinned(count)
    assert len(kept) <= 10_001
    assert (np.diff(kept) > 0).all()
    assert not count or (kept[0], kept[-1]) == (0, count - 1)
