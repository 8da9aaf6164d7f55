"""Curvature: what ISO 11783-7 commands, and the steering angle that drawbar means by it."""

import math
from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Sequence
from itertools import pairwise

from drawbar.errors import ConfigurationError


class CurvatureMap(ABC):
    """The angle of a steered axle or joint, rad, and the curvature that its valve takes for it, 1/m; left positive."""

    @abstractmethod
    def curvature(self, angle: float) -> float:
        """Return the curvature of an angle, NaN where there is none."""

    @abstractmethod
    def angle(self, curvature: float) -> float:
        """Return the angle of a curvature, NaN where there is none; the exact inverse of `curvature`."""


class WheelbaseCurvature(CurvatureMap):
    """Front wheels: curvature = tan(angle) / wheelbase.

    Raises:
        ConfigurationError: the wheelbase is no positive length

    """

    def __init__(self, wheelbase: float) -> None:
        if not (0.0 < wheelbase < math.inf):
            raise ConfigurationError(f"wheelbase {wheelbase} m: give the distance of the axles, more than 0 m")
        self._wheelbase = wheelbase

    def curvature(self, angle: float) -> float:
        """Return tan(angle) / wheelbase, NaN at a right angle and beyond."""
        return math.tan(angle) / self._wheelbase if abs(angle) < math.pi / 2 else math.nan

    def angle(self, curvature: float) -> float:
        """Return atan(wheelbase curvature)."""
        return math.atan(self._wheelbase * curvature)


class TableCurvature(CurvatureMap):
    """A trailer's axle or joint: straight lines between calibrated pairs, nothing beyond the first and the last.

    What a maker means by the curvature of such an axle is his own; the pairs must therefore reach from stop to stop.

    Raises:
        ConfigurationError: fewer than two pairs, a number that is not finite, or angles or curvatures that do not rise

    """

    def __init__(self, pairs: Sequence[tuple[float, float]]) -> None:
        if len(pairs) < 2:
            raise ConfigurationError("curvature table has fewer than two pairs; give at least two, from stop to stop")
        for pair in pairs:
            if not all(map(math.isfinite, pair)):
                raise ConfigurationError(f"curvature table: {pair} is not a pair of finite numbers (rad, 1/m)")
        for before, after in pairwise(pairs):
            if not (before[0] < after[0] and before[1] < after[1]):
                raise ConfigurationError(
                    f"curvature table: from {before} to {after} angle (rad) and curvature (1/m) must both rise; "
                    "sort the pairs by angle, and turn the sign of all curvatures where they fall"
                )
        self._angles = [angle for angle, _ in pairs]
        self._curvatures = [curvature for _, curvature in pairs]

    def curvature(self, angle: float) -> float:
        """Return the curvature between the pairs, NaN beyond them."""
        return _between(self._angles, self._curvatures, angle)

    def angle(self, curvature: float) -> float:
        """Return the angle between the pairs, NaN beyond them."""
        return _between(self._curvatures, self._angles, curvature)


def _between(given: list[float], wanted: list[float], at: float) -> float:
    if not (given[0] <= at <= given[-1]):
        return math.nan
    left = min(bisect_right(given, at), len(given) - 1) - 1
    share = (at - given[left]) / (given[left + 1] - given[left])
    return wanted[left] * (1.0 - share) + wanted[left + 1] * share
