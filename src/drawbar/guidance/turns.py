"""Continuous-curvature turns: the shortest ways to turn for a steering of limited angle and limited rate.

A turn's curvature rises at the rate limit, stays at the curvature limit if it gets there, and falls back to zero:
clothoid, arc, clothoid (Fraichard and Scheuer 2004). A turn is symmetric about its middle, so it displaces the vehicle
along the mean of its first and last heading.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from drawbar.geometry import Floats
from drawbar.guidance.path import PIECE_LENGTH, Complexes

_POINT = 1e-6
"""a piece of a curve up to this long is a point, m"""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


@dataclass(frozen=True, slots=True, kw_only=True)
class TurnLimits:
    """How tight and how abrupt turns may be, and what follows for turns by given angles (rad, either sign)."""

    curvature: float
    """1/m"""
    rate: float
    """change of curvature per metre, 1/m²"""

    def peak(self, angle: Floats) -> Floats:
        """Return the largest curvature (...) of turns by these angles (...), without sign, 1/m."""
        return np.minimum(self.curvature, np.sqrt(self.rate * np.abs(angle)))

    def length(self, angle: Floats) -> Floats:
        """Return the lengths (...) of turns by these angles (...), m."""
        peak = self.peak(angle)
        arc = np.maximum(np.abs(angle) - peak**2 / self.rate, 0.0) / self.curvature
        return 2.0 * peak / self.rate + arc

    def chord(self, angle: Floats) -> Floats:
        """Return the distances (...) between the ends of turns by these angles (...), m; negative: backwards."""
        peak = self.peak(angle)
        ramp = peak / self.rate
        along = 0.5 * (_NODES + 1.0) * ramp[..., np.newaxis]
        # of each point of the clothoid, against the chord
        heading = 0.5 * (self.rate * along**2 - np.abs(angle)[..., np.newaxis])
        clothoid = 0.5 * ramp * (np.cos(heading) @ _WEIGHTS)
        half_arc = 0.5 * np.maximum(np.abs(angle) - peak * ramp, 0.0)
        chord: Floats = 2.0 * (clothoid + np.sin(half_arc) / self.curvature)
        return chord


@dataclass(frozen=True, slots=True, kw_only=True)
class Trace:
    """A curve by its nodes, from the origin on."""

    points: Complexes
    """(n,): m"""
    heading: Floats
    """(n,): continuous, rad"""


def trace(limits: TurnLimits, angles: Floats, *, heading: float, curvature: float) -> Trace:
    """Return the curve of turns by these angles (m,) one after the other, rad.

    It sets out from the origin at the heading (rad), and first brings the curvature (1/m) that the wheels have to zero.
    """
    lengths, bends = [abs(curvature) / limits.rate], [curvature, 0.0]
    for angle, peak, length in zip(angles, limits.peak(angles), limits.length(angles), strict=True):
        ramp = peak / limits.rate
        lengths += [ramp, length - 2.0 * ramp, ramp]
        bends += [math.copysign(peak, angle), math.copysign(peak, angle), 0.0]
    knots = np.concatenate([[0.0], np.cumsum(lengths)])
    between = [
        np.linspace(start, end, math.ceil((end - start) / PIECE_LENGTH), endpoint=False)
        for start, end in pairwise(knots)
        if end - start > _POINT
    ]
    arc_length = np.concatenate([*between, knots[-1:]])
    return _integrated(arc_length, np.interp(arc_length, knots, bends), heading)


def _integrated(arc_length: Floats, curvature: Floats, heading: float) -> Trace:
    """Integrate a curvature (n,), 1/m, that is linear between the nodes at arc_length (n,), m."""
    step, first, last = np.diff(arc_length), curvature[:-1], curvature[1:]
    headings = heading + np.concatenate([[0.0], np.cumsum(0.5 * (first + last) * step)])
    middle = headings[:-1] + 0.125 * (3.0 * first + last) * step
    # Simpson's rule for the mean direction
    directions = (np.exp(1j * headings[:-1]) + 4.0 * np.exp(1j * middle) + np.exp(1j * headings[1:])) / 6.0
    return Trace(points=np.concatenate([[0.0], np.cumsum(directions * step)]), heading=headings)
