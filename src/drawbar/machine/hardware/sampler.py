"""Sampler: joins the reports of receivers and actuators, each with its own time, into measurements at the samples.

A sample is taken when its epoch usually arrives, and holds the age of the epoch; the next one is due a sample time
later. Epochs in between (of a receiver that is faster than the controller) are not used. If no epoch comes, the sample
is taken without a fix, as late as the step can bear, so that the autopilot continues by prediction. If epochs continue
at other times than the samples, as after a burst that delayed a receiver's first epoch, the samples move to them. All
instants are monotonic, ns.
"""

import math
from collections import deque
from dataclasses import replace
from itertools import pairwise
from statistics import median_low

from drawbar.messages import Fixes, GateState, ReceiverReport
from drawbar.signals import FixQuality, Measurement

WAIT = 100_000_000
"""time after its sample at which an epoch is given up, ns: longer than one receiver's waits for the other's"""
_USUAL = 5
"""epochs, the median of whose delays is the usual one"""
_LONGEST_WAIT = 3 / 4
"""for an epoch, of a sample time: then the next sample is near"""
_AHEAD = 50_000_000
"""by which an epoch may come before its sample, ns"""
_EARLIEST, _LEAST_EARLIEST = 1 / 4, 1 / 20
"""by which an epoch may come before a sample time is over, of a sample time: half of the time between epochs, but no
more and no less than these"""
_MOVING_STEP = 3 / 4
"""shortest from a sample to the next where the samples move to an epoch with an antenna that the last ones lacked, of a
sample time: the estimator takes each step for a whole one, and half a one cost it 0.5 m at 2 m/s"""
_KEPT = 300_000_000
"""oldest report of the sensor board that came by itself, ns"""
_LACKED = 2
"""samples in a row without an antenna, after which they move to an epoch with it"""


class Sampler:
    """Makes a measurement of each sample; `dropped` counts the epochs that none was made of."""

    def __init__(self, sample_time: float, *, has_trailer: bool = True) -> None:
        """Take the sample time, s, and whether the trailer has a receiver."""
        self._has_trailer = has_trailer
        self._period = round(sample_time * 1e9)
        self._wait = min(WAIT, round(_LONGEST_WAIT * self._period))
        self._start: int | None = None
        self._last = self._due = 0
        self._delays: deque[int] = deque(maxlen=_USUAL)
        self._epochs: deque[int] = deque(maxlen=_USUAL)
        self._without = [0, 0]  # samples in a row without tractor's and trailer's antenna
        self._gate: GateState | None = None
        self._sensors: Fixes | None = None
        """the newest report of the sensor board that came by itself, or with no sample"""
        self.dropped = 0

    @property
    def deadline(self) -> int | None:
        """When to take the next sample without its epoch, ns; None before the first epoch."""
        return None if self._start is None else self._due + self._wait

    def receive_gate(self, state: GateState) -> None:
        """Take in the gate's measurements of the actuators."""
        self._gate = state

    def take(self, fixes: Fixes) -> Measurement | None:
        """Return the measurement of an epoch's sample, None if the epoch is of none."""
        if _is_of_sensors(fixes):
            self._sensors = fixes
            return None
        self._epochs.append(fixes.epoch)
        known = (math.isfinite(fixes.tractor.x), not self._has_trailer or math.isfinite(fixes.trailer.x))
        if all(known) or max(self._without) >= _USUAL or not self._delays:  # one alone was held back for the other
            self._delays.append(fixes.time - fixes.epoch)
        sample = min(fixes.epoch + median_low(self._delays), fixes.time + _AHEAD)
        moves = any(has and lacks >= _LACKED for has, lacks in zip(known, self._without, strict=True))
        if self._start is None:
            self._start = sample
        elif sample < (self._last + self._period * _MOVING_STEP if moves else self._due - self._earliest()):
            if moves and sample > self._last:  # too soon after the last sample: its successor is the next one
                self._due = sample + self._period
            self._sensors = _without_antennas(fixes)
            self.dropped += 1
            return None
        self._last, self._due = sample, sample + self._period
        self._count(known)
        return self._measured(fixes)

    def miss(self) -> Measurement:
        """Return the measurement of the sample that is due, without a fix."""
        self._last += self._period
        self._due = self._last + self._period
        self._count((False, False))
        sensors = self._sensors
        return self._measured(sensors) if sensors and self._last - sensors.time <= _KEPT else self._without_fix()

    def _earliest(self) -> float:
        """Return by how much an epoch may come before the next sample, ns: the nearest one counts."""
        interval = min((later - earlier for earlier, later in pairwise(self._epochs)), default=self._period)
        return max(min(interval / 2, self._period * _EARLIEST), self._period * _LEAST_EARLIEST)

    def _count(self, known: tuple[bool, bool]) -> None:
        self._without = [0 if has else lacks + 1 for has, lacks in zip(known, self._without, strict=True)]

    def _without_fix(self) -> Measurement:
        """Return what is known at the sample besides the receivers' values: the steering."""
        assert self._start is not None
        nan, gate = math.nan, self._gate
        return Measurement(
            time=(self._last - self._start) * 1e-9,
            tractor_x=nan,
            tractor_y=nan,
            trailer_x=nan,
            trailer_y=nan,
            hitch_angle=nan,
            speed=nan,
            tractor_steering=gate.tractor_angle if gate else nan,
            trailer_steering=gate.trailer_angle if gate else nan,
            tractor_steering_age=self._age(gate.tractor_angle_time) if gate else 0.0,
            trailer_steering_age=self._age(gate.trailer_angle_time) if gate else 0.0,
            tractor_fix_quality=FixQuality.NONE,
            trailer_fix_quality=FixQuality.NONE,
        )

    def _measured(self, fixes: Fixes) -> Measurement:
        """Return the measurement of a sample that has an epoch."""
        return replace(
            self._without_fix(),
            tractor_x=fixes.tractor.x,
            tractor_y=fixes.tractor.y,
            trailer_x=fixes.trailer.x,
            trailer_y=fixes.trailer.y,
            hitch_angle=fixes.hitch_angle,
            hitch_angle_age=self._age(fixes.hitch_angle_time),
            speed=_speed(fixes),
            speed_age=self._age(fixes.wheel_speed_time),
            tractor_fix_age=self._age(fixes.epoch),
            trailer_fix_age=self._age(fixes.epoch),
            tractor_fix_deviation=fixes.tractor.deviation,
            trailer_fix_deviation=fixes.trailer.deviation,
            tractor_roll=fixes.tractor.roll,
            tractor_pitch=fixes.tractor.pitch,
            tractor_yaw=fixes.tractor.yaw,
            tractor_yaw_rate=fixes.tractor.yaw_rate,
            tractor_attitude_age=self._age(fixes.tractor.attitude_time),
            trailer_roll=fixes.trailer.roll,
            trailer_pitch=fixes.trailer.pitch,
            trailer_yaw_rate=fixes.trailer.yaw_rate,
            trailer_attitude_age=self._age(fixes.trailer.attitude_time),
            tractor_fix_quality=FixQuality(fixes.tractor.quality),
            trailer_fix_quality=FixQuality(fixes.trailer.quality),
        )

    def _age(self, time: int) -> float:
        """Return how old a value of an instant is at the sample, s; what is newer is not old."""
        return max(self._last - time, 0) * 1e-9 if time else 0.0


def _is_of_sensors(fixes: Fixes) -> bool:
    """Return whether it is a report of the sensor board that came by itself, and no epoch."""
    places = math.isfinite(fixes.tractor.x) or math.isfinite(fixes.trailer.x)
    return not places and fixes.epoch in (fixes.hitch_angle_time, fixes.wheel_speed_time)


def _without_antennas(fixes: Fixes) -> Fixes:
    """Return what an epoch of no sample holds besides its positions: a sample that has none may need the speed."""
    return replace(fixes, tractor=_without_antenna(fixes.tractor), trailer=_without_antenna(fixes.trailer))


def _without_antenna(report: ReceiverReport) -> ReceiverReport:
    return replace(report, x=math.nan, y=math.nan, quality=FixQuality.NONE)


def ground_speed(fixes: Fixes) -> float:
    """Return the speed over ground of the tractor's receiver, or of the trailer's where that one reports none, m/s."""
    return fixes.tractor.speed if math.isfinite(fixes.tractor.speed) else fixes.trailer.speed


def _speed(fixes: Fixes) -> float:
    """Return the speed of the wheels, or over ground where they are not measured, m/s."""
    return fixes.wheel_speed if math.isfinite(fixes.wheel_speed) else ground_speed(fixes)
