import math

import pytest

from drawbar.report.tube.units import shown


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.0123, "m", "1.23 cm"),
        (math.radians(2.5), "rad", "2.5°"),
        (math.radians(25.0), "rad/s", "25°/s"),
        (0.05, "m/s", "5 cm/s"),
        (0.4, "1", "0.4"),
        (3e-9, "rad", "0°"),
        (math.inf, "m", "unbounded"),
        (math.nan, "m", "–"),
    ],
)
def test_quantities_read_as_people_say_them(value, unit, text):
    assert shown(value, unit) == text
