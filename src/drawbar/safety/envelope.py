"""Envelope: what a command may be, whatever the controller thinks; the gate's process puts every command through it.

Two questions, in this order. May the record be obeyed at all (`admit`)? It is refused, never mended, if its sequence
is wrong, it has expired, or its time cannot be. Are its numbers allowed (`limit`)? What is beyond is limited, and said.
All numbers of a decoded record are finite (messages/records.py), and every comparison is written so that NaN fails it.

It is not `gate.h`, the last part of the control step, which answers for commands of one run by a model of the
actuators; this one is independent of the controller, and uses what is measured. Pure, without numpy.
"""

import math
from dataclasses import dataclass

from drawbar.messages import CommandMessage
from drawbar.nanoseconds import nanoseconds, seconds
from drawbar.safety.settings import SafetySettings

AHEAD = 0.005
"""by which a command or a request may be younger than `now`, s: it may be made while the gate already looks"""
LOST = 10
"""records of the controller that may be missing in a row, modulo 2³²"""
SEQUENCES = 2**32


def is_after(sequence: int, other: int) -> bool:
    """Return whether a record of a sequence was made after another one, modulo 2³²."""
    return 0 < (sequence - other) % SEQUENCES < SEQUENCES // 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """What the vehicle's steering can do, of its parameters."""

    wheelbase: float
    """L of the tractor, m"""
    tractor_limit: float
    """largest steering angle, rad"""
    trailer_limit: float
    """largest angle of the actuated joint, rad"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limited:
    """A command that may be sent."""

    angles: tuple[float, float]
    """of tractor and trailer, rad"""
    speed: float
    """m/s"""
    clipped: bool
    """it is not what the controller asked for"""


class Axis:
    """The set point of one steering: what it was, and an anchor that follows it no faster than its rate.

    A steering follows its set point with a lag, so that a set point may lead; how far, `steering_lead` seconds of the
    largest rate, is counted from the anchor: what lasts longer than that is no faster than the rate.
    """

    def __init__(self) -> None:
        """Begin straight ahead."""
        self.angle = self._anchor = 0.0

    def begin(self, measured: float) -> None:
        """Begin where the steering is, rad."""
        self.angle = self._anchor = measured

    def limit(self, wanted: float, measured: float, *, cap: float, move: float, lead: float, reach: float) -> None:
        """Move the set point to what is wanted, within all limits; where they contradict, the later one holds.

        The cap comes first: when it shrinks because the vehicle becomes faster, the set point walks there and does not
        jump. The reach from the measured angle comes last: it is what a wrong command can do at most.

        Args:
            wanted: by the controller, rad.
            measured: rad; NaN (not known) holds the last set point.
            cap: largest angle, rad.
            move: of the anchor since the last set point, rad.
            lead: farthest of the set point from the anchor, rad.
            reach: farthest of the set point from the measured angle, rad.
        """
        self._anchor = _towards(self._anchor, self.angle, move)
        if math.isfinite(measured):
            self.angle = _towards(measured, _towards(self._anchor, _clamped(wanted, cap), lead), reach)


class Envelope:
    """Remembers the last command: its sequence, its time and what was made of it."""

    def __init__(self, settings: SafetySettings, bounds: Bounds) -> None:
        """Begin without a command."""
        self._limits, self._timeout, self._bounds = settings.envelope, settings.timing.command, bounds
        self._sequence: int | None = None
        self._time = 0.0
        self._axes = (Axis(), Axis())

    @property
    def angles(self) -> tuple[float, float]:
        """Set points now: of the last command, or where the steering was when `begin` was called, rad."""
        return (self._axes[0].angle, self._axes[1].angle)

    def repeats(self, command: CommandMessage) -> bool:
        """Return whether a command has come before, or a later one has: a copy, which holds nothing new."""
        return self._sequence is not None and not is_after(command.sequence, self._sequence)

    def admit(self, command: CommandMessage, now: float) -> bool:
        """Return whether a command may be obeyed at all; `now` is the monotonic time, s."""
        ahead = 1 if self._sequence is None else (command.sequence - self._sequence) % SEQUENCES
        if not self.repeats(command):  # also of one that is refused, so that those that follow it may be obeyed
            self._sequence = command.sequence
        modest = command.valid_until - command.time <= nanoseconds(self._timeout)
        in_time = seconds(command.time) <= now + AHEAD and now <= seconds(command.valid_until)
        return 0 < ahead <= LOST and modest and in_time

    def begin(self, time: float, measured: tuple[float, float]) -> None:
        """Begin without a jump: the set points before the first command are where the steering is, rad."""
        self._time = time
        for axis, angle in zip(self._axes, measured, strict=True):
            axis.begin(angle)

    def limit(
        self, command: CommandMessage, measured: tuple[float, float], speed: float, *, eased: bool = False
    ) -> Limited:
        """Return the command within its limits.

        Args:
            command: one that was admitted.
            measured: angle of tractor and trailer, rad; NaN: not known.
            speed: largest that the vehicle may have, m/s.
            eased: rates and distances are halved, as in the first second after engaging.
        """
        share = 0.5 if eased else 1.0
        elapsed = min(max(seconds(command.time) - self._time, 0.0), self._timeout)
        self._time = seconds(command.time)
        reach, lead = share * self._limits.steering_reach, self._limits.steering_lead
        rates = (share * self.rate_cap(speed), share * self._limits.steering_rate)
        caps = (self.angle_cap(speed), self._bounds.trailer_limit)
        wanted = (command.tractor_angle, command.trailer_angle)
        for axis, angle, at, cap, rate in zip(self._axes, wanted, measured, caps, rates, strict=True):
            axis.limit(angle, at, cap=cap, move=rate * elapsed, lead=rate * lead, reach=reach)
        limited_speed = _clamped(command.speed, self._limits.speed)
        clipped = self.angles != wanted or limited_speed != command.speed
        return Limited(angles=self.angles, speed=limited_speed, clipped=clipped)

    def angle_cap(self, speed: float) -> float:
        """Return the largest angle of the front wheels at a speed, rad: lateral acceleration v² tan(delta) / L."""
        grip = self._limits.lateral_acceleration * self._bounds.wheelbase
        return min(self._bounds.tractor_limit, math.atan2(grip, speed * speed))

    def rate_cap(self, speed: float) -> float:
        """Return the fastest change of their set point at a speed, rad/s: lateral jerk v² delta' / L, delta small."""
        jerk = self._limits.lateral_jerk * self._bounds.wheelbase
        rate = self._limits.steering_rate
        return jerk / (speed * speed) if rate * speed * speed > jerk else rate


def _clamped(value: float, limit: float) -> float:
    """Return a finite value, at most as large as the limit."""
    return math.copysign(limit, value) if abs(value) > limit else value


def _towards(start: float, end: float, reach: float) -> float:
    """Return the finite end, or what lies towards it from the start as far as one may reach."""
    return start + math.copysign(reach, end - start) if abs(end - start) > reach else end
