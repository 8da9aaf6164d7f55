"""Bounded errors, of which only bounds are known: a tube is declared for them, and a simulation tests it with them."""

from enum import StrEnum
from typing import Annotated

import numpy as np
from pydantic import Field

from drawbar.geometry import Floats
from drawbar.settings import NonNegative, NonNegativeAngle, Settings


class Draw(StrEnum):
    """How errors are drawn from their bounds, anew for each sample."""

    RANDOM = "random"
    """uniformly"""
    VERTICES = "vertices"
    """at one end or the other"""
    ADVERSARIAL = "adversarial"
    """at the ends that drive the errors of both bodies outwards, in one direction after the other"""


class GroundErrors(Settings):
    """Bounds of what is added to the ground's effects, and that neither estimator nor truth contains."""

    longitudinal_slip: NonNegative = 0.0
    """of mu"""
    tractor_slip: NonNegative = 0.0
    """of kappa"""
    steering_offset: NonNegativeAngle = 0.0
    """of b, the angle of the front wheels, rad"""
    tractor_crab: NonNegativeAngle = 0.0
    """of alpha_r, rad"""
    trailer_crab: NonNegativeAngle = 0.0
    """of alpha_i, rad"""


class EstimateErrors(Settings):
    """Bounds of what is added to an ideal estimate."""

    tractor_lateral: NonNegative = 0.0
    """m"""
    tractor_yaw: NonNegativeAngle = 0.0
    """rad"""
    tractor_steering: NonNegativeAngle = 0.0
    """rad"""
    trailer_lateral: NonNegative = 0.0
    """m"""
    trailer_yaw: NonNegativeAngle = 0.0
    """rad"""
    trailer_steering: NonNegativeAngle = 0.0
    """rad"""


class BoundedErrors(Settings):
    """Errors within bounds, held over each sample, beside the random ones of the machine."""

    draw: Annotated[Draw, Field(strict=False)] = Draw.RANDOM
    """how errors are drawn from their bounds"""
    scale: NonNegative = 1.0
    """on all bounds: beyond 1 they are more than was declared"""
    ground: GroundErrors = GroundErrors()
    estimate: EstimateErrors = EstimateErrors()
    """with estimator.model = "ideal" only"""


class BoundedSequence:
    """One vector of errors after the other, none beyond its bounds. Same seed: the identical sequence."""

    def __init__(self, draw: Draw, bounds: Floats, *, seed: int, worst: Floats) -> None:
        """Take what the sequence is made of.

        Args:
            draw: how.
            bounds: (d,).
            seed: of the draw; where an adversary begins, alike for all sequences with as long a plan.
            worst: (m, d) signs that an adversary gives the errors of m samples, over and over.
        """
        self._draw, self._bounds = draw, bounds
        self._worst = np.roll(worst, np.random.default_rng(seed).integers(len(worst)), axis=0)
        self._rng = np.random.default_rng((seed, len(bounds)))  # not the stream that the machine draws from
        self._sample = 0

    def draw(self) -> Floats:
        """Return the errors (d,) of the next sample."""
        self._sample += 1
        if self._draw is Draw.ADVERSARIAL:
            signs = self._worst[(self._sample - 1) % len(self._worst)]
        elif self._draw is Draw.VERTICES:
            signs = self._rng.choice((-1.0, 1.0), len(self._bounds))
        else:
            signs = self._rng.uniform(-1.0, 1.0, len(self._bounds))
        drawn: Floats = self._bounds * signs
        return drawn
