"""What a log says of declared bounds: magnitudes, proposals, and how much the largest of many samples tells."""

import numpy as np
import pytest

from drawbar.report.tube.recorded import CONFIDENCE, Finding, coverage


def finding(*magnitudes, declared=0.0):
    return Finding(section="disturbances", name="speed", unit="m/s", magnitudes=np.array(magnitudes), declared=declared)


@pytest.mark.parametrize(
    ("largest", "proposed"), [(0.0301, 0.031), (0.03, 0.03), (1.0, 1.0), (99.1, 100.0), (0.0, 0.0)]
)
def test_a_proposal_is_the_largest_sample_rounded_up(largest, proposed):
    assert finding(0.0, largest).proposed == proposed


def test_proposals_hold_for_every_sample_they_come_from():
    rng = np.random.default_rng(1)
    for scale in (1e-6, 0.01, 3.0, 1e4):
        one = finding(*np.abs(scale * rng.normal(size=50)))
        assert one.magnitudes.max() <= one.proposed <= 1.1 * one.magnitudes.max()


def test_samples_beyond_the_declared_bound_are_counted():
    assert finding(0.1, 0.2, 0.3, declared=0.2).beyond == 1
    assert finding(0.1, 0.2, 0.3, declared=0.3).beyond == 0


def test_the_largest_of_many_samples_covers_the_stated_share_as_often_as_stated():
    # of uniform samples the share below the largest one is that sample itself
    largest = np.random.default_rng(2).uniform(size=(20_000, 60)).max(axis=1)
    assert np.mean(largest >= coverage(60)) == pytest.approx(CONFIDENCE, abs=0.006)
