"""Mean and interval over seeds, against scipy's own, and what is missing."""

import math

import numpy as np
import pytest
from scipy import stats

from drawbar.experiment.statistics import Statistic


@pytest.mark.parametrize("count", [2, 5, 20])
def test_interval_is_students(count: int) -> None:
    values = np.random.default_rng(count).normal(3.0, 2.0, count)
    statistic = Statistic.of(values.tolist())
    low, high = stats.t.interval(0.95, count - 1, values.mean(), stats.sem(values))
    assert statistic.mean == pytest.approx((low + high) / 2)
    assert statistic.half_width == pytest.approx((high - low) / 2)
    assert statistic.largest == values.max()
    assert statistic.count == count


def test_interval_covers_the_true_mean_in_95_percent_of_samples() -> None:
    samples = np.random.default_rng(0).normal(1.0, 0.5, (4000, 5))
    statistics = [Statistic.of(sample.tolist()) for sample in samples]
    covered = np.mean([abs(each.mean - 1.0) <= each.half_width for each in statistics])
    assert covered == pytest.approx(0.95, abs=0.01)


def test_what_is_missing_is_not_made_up() -> None:
    assert Statistic.of([]).text() == "–"
    assert Statistic.of([1.0, math.nan]).text() == "–"
    assert math.isnan(Statistic.of([2.0]).half_width)
    assert Statistic.of([2.04]).text() == "2.0"
    assert Statistic.of([1.0, 3.0]).text(0) == "2 ± 13"
