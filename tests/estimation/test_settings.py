import pytest
from pydantic import ValidationError

from drawbar.estimation.settings import ArticulatedEstimatorSettings, SlipBounds, TricycleEstimatorSettings
from drawbar.signals import Estimate


def test_bounds_must_not_cross_or_touch():
    for lower, upper in ((1.0, 0.5), (0.5, 0.5)):
        with pytest.raises(ValidationError, match="must be below"):
            SlipBounds(lower=lower, upper=upper)


@pytest.mark.parametrize("first_slip", [0.2, 0.4999, 1.01])
def test_first_slip_lies_within_every_bound(first_slip):
    with pytest.raises(ValidationError, match=f"first_slip = {first_slip} must be within"):
        ArticulatedEstimatorSettings(model="articulated", first_slip=first_slip)


def test_first_slip_of_the_tricycle_lies_within_its_bounds():
    with pytest.raises(ValidationError, match=r"must be within 0\.25 \.\. 1\.0"):
        TricycleEstimatorSettings(model="tricycle", first_slip=1.2)


@pytest.mark.parametrize(
    "settings", [ArticulatedEstimatorSettings(model="articulated"), TricycleEstimatorSettings(model="tricycle")]
)
def test_bounds_are_reported_by_the_names_of_an_estimate(settings):
    bounds = settings.bounds_by_estimate()
    assert set(bounds) <= set(Estimate.__dataclass_fields__)
    assert all(lower < upper for lower, upper in bounds.values())
