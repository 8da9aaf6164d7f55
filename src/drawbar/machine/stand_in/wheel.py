"""Wheel: what a stand-in board turns and measures, a steered wheel or the joint of a drawbar."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable


class Wheel(ABC):
    """Something that a motor turns; `angle` is the true one, rad, left positive."""

    angle: float

    @abstractmethod
    def turn(self, pwm: float, duration: float) -> None:
        """Move on by `duration`, s, with the motor at `pwm`, -255 to 255, positive to the left."""


class HeldWheel(Wheel):
    """A wheel whose angle another one sets: a test, or a simulated machine whose steering follows the board.

    `angle` is what its sensor measures.
    """

    def __init__(self, angle: float = 0.0) -> None:
        self.angle = angle
        self.shows: Callable[[float], float] = lambda true: true
        """what its sensor measures, given its true angle, rad"""

    def hold(self, true: float) -> None:
        """Put it at its true angle, rad."""
        self.angle = self.shows(true)

    def turn(self, pwm: float, duration: float) -> None:
        """Leave the angle to who sets it."""


class MotorWheel(Wheel):
    """A wheel turned by a motor with friction: rate' = (wanted - rate) / lag, stopped by its ends."""

    def __init__(
        self, *, rate: float = math.radians(30.0), lag: float = 0.1, stiction: int = 6, stop: float = math.radians(40.0)
    ) -> None:
        """Start straight and at rest.

        Args:
            rate: with the motor at full PWM, rad/s.
            lag: of the rate behind the PWM, s.
            stiction: PWM that does not move it yet.
            stop: mechanical end either way, rad.
        """
        self.angle = 0.0
        self._rate, self._lag, self._stiction, self._stop = rate, lag, stiction, stop
        self._speed = 0.0

    def place(self, angle: float) -> None:
        """Put it at an angle, rad, at rest."""
        self.angle, self._speed = angle, 0.0

    def turn(self, pwm: float, duration: float) -> None:
        """Move on by `duration`, s: exact for the lag."""
        effective = max(abs(pwm) - self._stiction, 0) / (255 - self._stiction)
        wanted = math.copysign(effective * self._rate, pwm)
        decay = math.exp(-duration / self._lag)
        self.angle += wanted * duration + (self._speed - wanted) * self._lag * (1.0 - decay)
        self._speed = wanted + (self._speed - wanted) * decay
        if not abs(self.angle) < self._stop:
            self.angle, self._speed = math.copysign(self._stop, self.angle), 0.0
