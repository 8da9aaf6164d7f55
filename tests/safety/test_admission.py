"""What of a measurement enters: numbers that a sensor can have meant."""

import math
from dataclasses import fields, replace

import pytest
from alone import Alone
from c_signals import given, room, taken

from drawbar.codegen import Unit
from drawbar.signals import FixQuality, Measurement

UNIT = """
#include "admission.h"
struct component { double none; };
#define COMPONENT_FIELDS
int UNIT(admit)(struct component *component, const struct drawbar_measurement *measurement,
                struct drawbar_measurement *seen)
{
    (void)component;
    return admit(measurement, seen);
}
"""
NAMES = [field.name for field in fields(Measurement)]
QUALITIES = [name for name in NAMES if name.endswith("quality")]
AGES = [name for name in NAMES if name.endswith("age")]
POSITIONS = ["tractor_x", "tractor_y", "trailer_x", "trailer_y", "tractor_fix_deviation", "trailer_fix_deviation"]
ANGLES = ["hitch_angle", "tractor_steering", "trailer_steering"]
ANGLES += ["tractor_yaw", *(f"{body}_{angle}" for body in ("tractor", "trailer") for angle in ("roll", "pitch"))]
RATES = ["speed", "tractor_yaw_rate", "trailer_yaw_rate"]
LIMITS = dict.fromkeys(POSITIONS, 1e7) | dict.fromkeys(ANGLES, 2.0 * math.pi) | dict.fromkeys(RATES, 50.0)
ORDINARY = Measurement(
    **{name: 0.1 * k for k, name in enumerate(NAMES) if name not in QUALITIES},
    tractor_fix_quality=FixQuality.FIXED,
    trailer_fix_quality=FixQuality.FLOAT,
)
"""every number another one"""


@pytest.fixture(scope="module")
def admitted():
    """Return a function from a measurement to what enters of it, and the number of absurd values."""
    admission = Alone(Unit(name="admission", source=UNIT, configure=lambda workspace: None))

    def admitted(measurement):
        seen = room(Measurement)
        count = admission.call("admit", given(measurement), seen)
        return taken(Measurement, seen), count

    return admitted


def assert_same_but(seen, measurement, missing):
    for name in NAMES:
        if name == missing:
            assert math.isnan(getattr(seen, name))
        else:
            assert getattr(seen, name) == getattr(measurement, name)


def test_every_number_has_its_limit():
    assert {"time", *LIMITS, *AGES, *QUALITIES} == set(NAMES)


def test_what_sensors_can_mean_enters_as_it_is(admitted):
    assert admitted(ORDINARY) == (ORDINARY, 0)


@pytest.mark.parametrize("name", LIMITS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_at_its_limit_a_number_enters_and_beyond_it_is_missing_and_counted(admitted, name, sign):
    largest = replace(ORDINARY, **{name: sign * LIMITS[name]})
    assert admitted(largest) == (largest, 0)
    for beyond in (math.nextafter(LIMITS[name], math.inf), 1e300, math.inf):
        seen, count = admitted(replace(ORDINARY, **{name: sign * beyond}))
        assert_same_but(seen, ORDINARY, name)
        assert count == 1


@pytest.mark.parametrize("name", [*LIMITS, *AGES])
def test_what_is_missing_stays_missing_and_is_not_counted(admitted, name):
    seen, count = admitted(replace(ORDINARY, **{name: math.nan}))
    assert_same_but(seen, ORDINARY, name)
    assert count == 0


@pytest.mark.parametrize("name", AGES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_age_that_is_infinite_is_missing_and_counted(admitted, name, sign):
    old = replace(ORDINARY, **{name: sign * 1e9})
    assert admitted(old) == (old, 0)
    seen, count = admitted(replace(ORDINARY, **{name: sign * math.inf}))
    assert_same_but(seen, ORDINARY, name)
    assert count == 1


def test_all_that_is_absurd_is_counted(admitted):
    absurd = replace(ORDINARY, **{name: 1e9 * (-1.0) ** k for k, name in enumerate(LIMITS)})
    seen, count = admitted(absurd)
    assert count == len(LIMITS)
    assert all(math.isnan(getattr(seen, name)) for name in LIMITS)
    assert seen.time == ORDINARY.time


@pytest.mark.parametrize("name", QUALITIES)
@pytest.mark.parametrize("quality", FixQuality)
def test_enumerations_are_untouched(admitted, name, quality):
    told = replace(ORDINARY, tractor_x=math.inf, **{name: quality})
    seen, count = admitted(told)
    assert count == 1
    assert [getattr(seen, each) for each in QUALITIES] == [getattr(told, each) for each in QUALITIES]
