"""Pushing calibration: a state machine that pushes an actuator, watches it, and always ends with off.

It takes what a sensor reports and returns what to drive; it reads no clock and owns no device. Whatever looks like a
runaway ends it: motion to the wrong side, faster or further than expected, none at all, or without a drive, or seen in
the vehicle's yaw rate but not by the sensor; and so does a vehicle that stands or drives too fast, a sensor that fails
or falls silent, and the operator.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

import numpy as np

from drawbar.machine.calibration.plans import NoMotion, Plan, Push
from drawbar.machine.calibration.valve import MOVED, PushRecord

_FIRST_PAUSE = 0.8
"""s, in which nothing may move before the first push"""
_DIES_OUT = 0.6
"""share of a pause after which the motion has died out"""
_AVERAGED = 0.5
"""s, over which the noise of a yaw rate is averaged"""
_UNKNOWN = 1.0
"""s, for which no yaw rate may come"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensed:
    """What is known of actuator and vehicle at an instant."""

    time: float
    """monotonic, s"""
    angle: float
    """measured by the sensor's rough or calibrated scale, rad, left positive; NaN: its fault"""
    speed: float
    """of the vehicle, m/s"""
    permitted: bool
    """the operator holds the switch that permits motion"""
    by_yaw: float = math.nan
    """steering angle by yaw rate and speed, atan(L omega / v), rad; NaN: unknown, for 1 s at most"""


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationLimits:
    """What a calibration may do, and what it takes for a runaway."""

    travel: float = math.radians(8.0)
    """largest way from where it began, rad"""
    rate: float = math.radians(12.0)
    """largest rate that is expected, rad/s"""
    wrong_way: float = math.radians(0.6)
    """motion against the drive's direction, rad"""
    unasked: float = math.radians(0.6)
    """motion while nothing is driven, rad"""
    unseen: float = math.radians(4.0)
    """by how much the angle from the yaw rate may exceed the sensor's, rad"""
    drive: float = 0.6
    """largest drive"""
    slowest: float = 0.3
    """of the vehicle, m/s: a standing tyre is not turned"""
    fastest: float = 1.5
    """m/s"""
    silence: float = 0.2
    """longest time between two reports, s"""
    time: float = 300.0
    """of the whole calibration, s"""


class State(Enum):
    """Where a calibration is."""

    PUSHING = "pushing"
    PAUSING = "pausing"
    DONE = "done"
    ABORTED = "aborted"


class Calibration:
    """Carries out a plan, push by push, under limits."""

    def __init__(self, plan: Plan, limits: CalibrationLimits | None = None, *, direction: int = 0) -> None:
        """Begin with the first report.

        Args:
            plan: the pushes.
            limits: None: the default ones.
            direction: 1 where a positive drive turns left, -1 to the right; 0: the first push that moves shows it.
        """
        self.direction = direction
        """what is known of it so far"""
        self.state = State.PAUSING
        self.reason = ""
        """why it was aborted, and what to do"""
        self.records: list[PushRecord] = []
        """of all pushes"""
        self.rests: list[tuple[float, float]] = []
        """behind each push, at rest: angle by the sensor, and by the vehicle's yaw rate, rad"""
        self._resting: list[tuple[float, float]] = []
        self._plan, self._limits = plan, limits or CalibrationLimits()
        self._push = Push(drive=0.0, duration=0.0, pause=_FIRST_PAUSE)
        self._still = self._apart = math.nan
        self._curved: list[tuple[float, float]] = []
        self._started = self._origin = math.nan
        self._begun = self._from = self._held = 0.0
        self._last: Sensed | None = None
        self._seen: list[tuple[float, float]] = []

    @property
    def ended(self) -> bool:
        """Whether it is over; then every drive is 0."""
        return self.state in (State.DONE, State.ABORTED)

    def tick(self, sensed: Sensed) -> float:
        """Return the drive for now, -1 to 1; 0 is off. Call it at every report, and again when there is none."""
        if self.ended:
            return 0.0
        if reason := self._wrong(sensed):
            return self.abort(reason)
        if self._last is None:
            self._started, self._origin = sensed.time, sensed.angle
            self._enter(State.PAUSING, sensed)
        else:
            self._seen.append((sensed.time, sensed.angle))
        self._last = sensed
        passed = sensed.time - self._begun
        resting = self.state is State.PAUSING and passed >= self._held + _DIES_OUT * self._push.pause
        if resting:
            self._still = sensed.angle if math.isnan(self._still) else self._still
            if math.isfinite(sensed.by_yaw):
                self._resting.append((sensed.angle, sensed.by_yaw))
        if self.state is State.PUSHING:
            if passed >= self._push.duration or abs(sensed.angle - self._from) >= self._push.enough:
                self.state, self._held = State.PAUSING, passed
        elif passed >= self._held + self._push.pause:
            self._go_on(sensed)
        return self._push.drive if self.state is State.PUSHING else 0.0

    def abort(self, reason: str) -> float:
        """End it now, for a reason; return the drive, 0."""
        if not self.ended:
            self.state, self.reason = State.ABORTED, reason
        return 0.0

    def _enter(self, state: State, sensed: Sensed) -> None:
        self.state, self._begun, self._from = state, sensed.time, sensed.angle
        self._seen, self._still = [(sensed.time, sensed.angle)], math.nan

    def _go_on(self, sensed: Sensed) -> None:
        """Keep the record of the push that is over, and begin the next one."""
        record = self._record() if self._held > 0.0 else None
        if self._resting:
            angles, by_yaw = zip(*self._resting, strict=True)
            self.rests.append((sum(angles) / len(angles), sum(by_yaw) / len(by_yaw)))
            self._resting.clear()
        if record is not None:
            self.records.append(record)
            if self.direction == 0 and abs(record.moved) > MOVED:
                self.direction = 1 if record.moved * record.drive > 0.0 else -1
        try:
            push = self._plan.next_push(record)
        except NoMotion as seen:
            self.abort(str(seen))
            return
        if push is None:
            self.state = State.DONE
            return
        if not (abs(push.drive) <= self._limits.drive):
            self.abort(f"a drive of {push.drive:.0%} is beyond the {self._limits.drive:.0%} that are allowed")
            return
        self._push = push
        self._enter(State.PUSHING, sensed)

    def _record(self) -> PushRecord:
        times, angles = (np.array(column) for column in zip(*self._seen, strict=True))
        return PushRecord(
            drive=self._push.drive, duration=self._held, times=times - self._begun, angles=angles - self._from
        )

    def _wrong(self, sensed: Sensed) -> str:
        """Return what is wrong with the machine now, or nothing."""
        if not (math.isfinite(sensed.time) and math.isfinite(sensed.angle)):
            return "the angle sensor reports nothing or is outside its range; check its cable"
        if not sensed.permitted:
            return "stopped by the operator"
        limits = self._limits
        if math.isnan(sensed.speed):
            return "the vehicle's speed is unknown; check the receiver"
        if not (limits.slowest <= sensed.speed <= limits.fastest):
            return (
                f"the vehicle drives at {sensed.speed:.2f} m/s; keep it between {limits.slowest} and {limits.fastest} "
                f"m/s: standing tyres are not turned"
            )
        return self._silent(sensed) or self._runaway(sensed)

    def _silent(self, sensed: Sensed) -> str:
        if self._last is None:
            return ""
        passed = sensed.time - self._last.time
        if not (0.0 < passed <= self._limits.silence):
            return f"{passed:.2f} s between two reports of the sensor, {self._limits.silence} s at most; check its link"
        if not (sensed.time - self._started <= self._limits.time):
            return f"it has taken more than {self._limits.time:.0f} s; begin again"
        return ""

    def _runaway(self, sensed: Sensed) -> str:
        """Return how the actuator runs away, or nothing."""
        if self._last is None:
            return ""
        limits, moved = self._limits, sensed.angle - self._from
        away = sensed.angle - self._origin
        if not (abs(away) <= limits.travel):
            return f"runaway: it has turned {math.degrees(away):+.1f}° from where it began; shut the valve off and look"
        if not (abs(self._rate(sensed)) <= limits.rate):
            return f"runaway: it turns faster than {math.degrees(limits.rate):.0f}°/s; shut the valve off and look"
        unasked = sensed.angle - self._still
        if abs(unasked) > limits.unasked:  # NaN until it has come to rest
            return (
                f"runaway: it turns without a drive, {math.degrees(unasked):+.1f}°; the valve leaks, or another drives"
            )
        if self.direction * self._push.drive * moved < 0.0 and not (abs(moved) <= limits.wrong_way):
            return (
                f"runaway: it has turned {math.degrees(moved):+.1f}° against the drive; check for a valve that sticks "
                "or leaks, and for a swapped sensor"
            )
        return self._unseen(sensed)

    def _unseen(self, sensed: Sensed) -> str:
        """Return how far the vehicle turns as if steered while the sensor shows nothing, or nothing."""
        self._curved.append((sensed.time, sensed.by_yaw - sensed.angle))
        self._curved = [(t, each) for t, each in self._curved if sensed.time - t <= _UNKNOWN and math.isfinite(each)]
        if sensed.time - self._started < _AVERAGED:
            return ""
        if not self._curved:
            return (
                "the vehicle's yaw rate is unknown: a sensor that is stuck would not be seen; let the tractor's "
                "receiver report it (docs/receivers.md)"
            )
        newest = [each for t, each in self._curved if sensed.time - t <= _AVERAGED] or [self._curved[-1][1]]
        mean = sum(newest) / len(newest)
        if math.isnan(self._apart):
            self._apart = mean
        apart = mean - self._apart
        if abs(apart) > self._limits.unseen:
            return (
                f"runaway: by its yaw rate the vehicle is steered {math.degrees(apart):+.1f}° further than "
                f"the sensor says; the sensor is stuck or its lever is loose"
            )
        return ""

    def _rate(self, sensed: Sensed) -> float:
        """Return the rate over the last tenth of a second or so, rad/s: one step of the sensor is no rate."""
        earlier = next(((t, a) for t, a in reversed(self._seen) if sensed.time - t >= 0.1), None)
        if earlier is None:
            return 0.0
        return (sensed.angle - earlier[1]) / (sensed.time - earlier[0])


class CalibratedMachine(ABC):
    """What a calibration needs of a machine."""

    @abstractmethod
    def sense(self) -> Sensed:
        """Wait for the next report, no longer than `CalibrationLimits.silence`; NaN as angle where none came."""

    @abstractmethod
    def drive(self, drive: float) -> None:
        """Drive the actuator, -1 to 1, until the next call."""

    @abstractmethod
    def off(self) -> None:
        """Switch the actuator off; always possible."""


def carry_out(
    calibration: Calibration,
    machine: CalibratedMachine,
    watch: Callable[[Sensed, float], str] = lambda sensed, drive: "",
) -> Calibration:
    """Carry a calibration out on a machine, which is off afterwards whatever happens; return it, ended.

    Args:
        calibration: to carry out.
        machine: that it moves.
        watch: is given what is sensed and the drive for it, and answers why to end now, or nothing.
    """
    try:
        while not calibration.ended:
            sensed = machine.sense()
            drive = calibration.tick(sensed)
            if reason := watch(sensed, drive):
                drive = calibration.abort(reason)
            if drive == 0.0:
                machine.off()
            else:
                machine.drive(drive)
    finally:
        machine.off()
    return calibration
