"""Where both antennas are reported and where they are expected, and what lies between the two."""

import math

from drawbar.signals import Measurement

Point = tuple[float, float]
"""east and north, or ahead and to the left, m"""
Antennas = tuple[Point, Point]
"""of the tractor's antenna and of the trailer's"""


def reported(measurement: Measurement) -> Antennas:
    """Return the measured positions, NaN where missing."""
    return (measurement.tractor_x, measurement.tractor_y), (measurement.trailer_x, measurement.trailer_y)


def offsets(fixes: Antennas, expected: Antennas) -> Antennas:
    """Return how far each fix lies ahead and to the left of where it is expected, seen along the line of both."""
    (tractor_x, tractor_y), (trailer_x, trailer_y) = expected
    length = math.dist(*expected)
    c, s = (tractor_x - trailer_x) / length, (tractor_y - trailer_y) / length
    gaps = [(fix[0] - place[0], fix[1] - place[1]) for fix, place in zip(fixes, expected, strict=True)]
    tractor, trailer = ((c * east + s * north, c * north - s * east) for east, north in gaps)
    return tractor, trailer


def length_error(fixes: Antennas, expected: Antennas) -> float:
    """Return by how much the antennas are further from each other than expected, m."""
    return math.dist(*fixes) - math.dist(*expected)
