"""Screening by itself, and the fixes of a straight drive that it judges."""

import math
from dataclasses import dataclass, replace

import numpy as np
from alone import Alone
from c_signals import given, room, taken

from drawbar.codegen import Unit
from drawbar.estimation.settings import ScreeningSettings
from drawbar.signals import FixStatus, Measurement

DEVIATION, LENGTH, STEP = 0.03, 2.15, 0.2
NAMES = ("tractor_x", "tractor_y", "trailer_x", "trailer_y")
OK, MISSING, STALE, REJECTED = FixStatus
LATER = 100
"""sample by which the estimate has long been confirmed"""


def toward(angle):
    """Return the unit vector in a direction, rad."""
    return np.array([math.cos(angle), math.sin(angle)])


HEADING = 0.4
AHEAD, LEFT = toward(HEADING), toward(HEADING + math.pi / 2.0)

UNIT = """
#include "screening.h"
struct component { struct screening screening; double expected[4], yaw_rate; struct screened screened; };
#define COMPONENT_FIELDS SCREENING_FIELDS(component, screening.) FIELD(component, expected, 0, 2, 2, 0) \\
    FIELD(component, yaw_rate, 0, 1, 0, 0) \\
    FIELD(component, screened.fixes, 1, 2, 0, 0) FIELD(component, screened.exposed, 1, 1, 0, 0) \\
    FIELD(component, screened.restart, 1, 1, 0, 0)
int UNIT(judge)(struct component *component, const struct drawbar_measurement *measurement,
                struct drawbar_measurement *believed)
{
    screening_judge(&component->screening, measurement, component->expected, component->yaw_rate,
                    &component->screened);
    *believed = component->screened.measurement;
    return 0;
}
int UNIT(as_long_as_stated)(struct component *component, struct drawbar_measurement *believed)
{
    screening_lengths(&component->screening, component->expected, &component->screened);
    *believed = component->screened.measurement;
    return 0;
}
"""


@dataclass(frozen=True, slots=True)
class Screened:
    measurement: Measurement
    fixes: tuple[FixStatus, FixStatus]
    exposed: int
    """0 neither, 1 the tractor's antenna, 2 the trailer's"""
    restart: bool


class Screening(Alone):
    def __init__(self, settings, deviation):
        values = {f"screening.{name}": value for name, value in settings} | {"screening.deviation": deviation}
        super().__init__(Unit(name="screening", source=UNIT, configure=lambda workspace: workspace.write(values)))

    def screen(self, measurement, expected, yaw_rate=0.0, *, lengths=False):
        believed = room(Measurement)
        self.live.array("expected")[:] = expected
        self.live.array("yaw_rate")[:] = yaw_rate
        self.call("judge", given(measurement), believed)
        fixes, exposed, restart = (
            self.live.array(f"screened.{name}").tolist() for name in ("fixes", "exposed", "restart")
        )
        if lengths:
            self.call("as_long_as_stated", believed)
        return Screened(taken(Measurement, believed), tuple(map(FixStatus, fixes)), exposed[0], bool(restart[0]))


def place(k):
    """Return where both antennas are expected at sample k, 0.2 m further along the heading with each."""
    tractor = 5.0 + STEP * k * AHEAD
    return tuple(tractor.tolist()), tuple((tractor - LENGTH * AHEAD).tolist())


def drive(count, errors=None, *, noise=DEVIATION, seed=1, speed=1.0):
    """Return measurements that lie around the expected places; errors (count, 4) are added, m."""
    rng = np.random.default_rng(seed)
    positions = np.array([np.ravel(place(speed * k)) for k in range(count)])
    positions += noise * rng.normal(size=positions.shape) + (0.0 if errors is None else errors)
    others = dict.fromkeys(("hitch_angle", "speed", "tractor_steering", "trailer_steering"), 0.0)
    return [
        Measurement(time=STEP * k, **dict(zip(NAMES, row.tolist(), strict=True)), **others)
        for k, row in enumerate(positions)
    ]


def screened(measurements, *, speed=1.0):
    """Return what is believed of each measurement of a drive."""
    screening = Screening(ScreeningSettings(), DEVIATION)
    return [screening.screen(measurement, place(speed * k)) for k, measurement in enumerate(measurements)]


def shift(count, first, last, tractor=(0.0, 0.0), trailer=(0.0, 0.0)):
    """Return errors (count, 4) by which both antennas are off from a sample until another, m."""
    errors = np.zeros((count, 4))
    errors[first:last] = [*tractor, *trailer]
    return errors


def lost(measurements, first, last):
    """Return measurements without fixes from a sample until another."""
    nothing = dict.fromkeys(NAMES, math.nan)
    return [replace(m, **nothing) if first <= k < last else m for k, m in enumerate(measurements)]


def held(measurements, first, last, names=NAMES):
    """Return measurements that repeat fixes from a sample until another."""
    old = {name: getattr(measurements[first - 1], name) for name in names}
    return [replace(m, **old) if first <= k < last else m for k, m in enumerate(measurements)]
