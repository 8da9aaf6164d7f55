"""Navigation: joins the receivers of both bodies; what they report of one instant becomes one record.

Each record holds the sensor board's last report. While the receivers are silent, the reports become records alone.
"""

import math
from collections.abc import Sequence
from typing import Any

from drawbar.geometry import LocalFrame
from drawbar.machine.hardware.receiver import Receiver
from drawbar.machine.hardware.sensor_line import SensorLine
from drawbar.messages import Fixes, ReceiverReport
from drawbar.nanoseconds import nanoseconds
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.pairing import Body, Pair, Pairing
from drawbar.signals import FixQuality

_FRESH = 0.5
"""oldest report of the sensor board, s"""
_SILENT, _APART = 0.35, 0.04
"""after which receivers count as silent, and the shortest time between two records of the sensor board alone, s"""
_VALID = 1.0
"""for how long fixes mean something, s"""
_MOST_SATELLITES = 255
"""that a record can hold"""
_NOTHING = ReceiverReport(
    heard=0,
    x=math.nan,
    y=math.nan,
    deviation=math.nan,
    quality=FixQuality.NONE,
    speed=math.nan,
    course=math.nan,
    roll=math.nan,
    pitch=math.nan,
    correction_age=math.nan,
)
"""of a receiver that reports nothing"""


class Navigation:
    """Polls both receivers, pairs their epochs and places them in the frame of the path."""

    def __init__(self, receivers: Sequence[Receiver], frame: LocalFrame, sensors: SensorLine | None = None) -> None:
        """Take the tractor's receiver and, where there is one, the trailer's; the frame; the sensor board, if any."""
        self._sensors = sensors
        self._receivers = dict(zip(Body, receivers, strict=False))
        self._pairing, self._frame, self._sequence = Pairing(), frame, 0
        self._last_epochs, self._published = math.inf, -math.inf
        """when the receivers last reported, and the time of the sensor board's last report that became a record, s"""

    @property
    def due(self) -> float:
        """Monotonic time at which to poll even if nothing comes, s."""
        return min(self._pairing.due, self._alone_due, *(receiver.due for receiver in self._receivers.values()))

    @property
    def _alone_due(self) -> float:
        """When the sensor board's newest report becomes a record of its own, infinite: it is in one already, s."""
        return self._last_epochs + _SILENT if self._reported - self._published >= _APART else math.inf

    def poll(self, time: float) -> list[Fixes]:
        """Read what has come until this monotonic time (s), and return what is complete."""
        if self._sensors is not None:
            self._sensors.poll()
        pairs: list[Pair] = []
        for body, receiver in self._receivers.items():
            for epoch in receiver.poll(time):
                pairs += [self._alone(epoch)] if len(self._receivers) == 1 else self._pairing.add(body, epoch, time)
        pairs += self._pairing.poll(time)
        if pairs:
            self._last_epochs = time
        elif time >= self._alone_due:
            pairs = [Pair(tractor=None, trailer=None)]
        return [self._fixes(pair, time) for pair in pairs]

    @property
    def _reported(self) -> float:
        """When the sensor board made its last report, s."""
        return self._sensors.last.time if self._sensors is not None else -math.inf

    @property
    def _came(self) -> float:
        """When that came, s."""
        return self._sensors.last.received if self._sensors is not None else -math.inf

    @staticmethod
    def _alone(epoch: Epoch) -> Pair:
        return Pair(tractor=epoch, trailer=None)

    def _fixes(self, pair: Pair, time: float) -> Fixes:
        self._sequence, self._published = (self._sequence + 1) % 2**32, self._reported
        epochs = [epoch for epoch in (pair.tractor, pair.trailer) if epoch is not None]
        return Fixes(
            sequence=self._sequence,
            time=nanoseconds(time),
            valid_until=nanoseconds(time + _VALID),
            epoch=nanoseconds(min((epoch.time for epoch in epochs), default=self._reported)),
            first_byte=nanoseconds(min((epoch.received for epoch in epochs), default=self._came)),
            **self._sensed(time),
            tractor=self._report(pair.tractor),
            trailer=self._report(pair.trailer),
        )

    def _sensed(self, time: float) -> dict[str, Any]:
        """Return the sensor board's last report, unless that is old."""
        hitch_angle, wheel_speed, stamp = math.nan, math.nan, 0
        if self._sensors is not None and time - self._sensors.last.time <= _FRESH:
            report = self._sensors.last
            hitch_angle, wheel_speed, stamp = report.hitch_angle, report.wheel_speed, nanoseconds(report.time)
        return {
            "hitch_angle": hitch_angle,
            "hitch_angle_time": stamp,
            "wheel_speed": wheel_speed,
            "wheel_speed_time": stamp,
        }

    def _report(self, epoch: Epoch | None) -> ReceiverReport:
        """Return what the receiver of one body reports; None: nothing for this instant."""
        if epoch is None:
            return _NOTHING
        x, y = math.nan, math.nan
        if epoch.has_fix:
            x, y = (float(each) for each in self._frame.east_north(epoch.latitude, epoch.longitude))
        return ReceiverReport(
            x=x,
            y=y,
            deviation=max(epoch.sigma_east, epoch.sigma_north),
            quality=epoch.quality,
            speed=epoch.speed,
            course=epoch.course,
            roll=epoch.roll,
            pitch=-epoch.pitch,  # nose up positive
            yaw=epoch.yaw,
            yaw_rate=epoch.yaw_rate,
            attitude_time=nanoseconds(epoch.time - epoch.attitude_age),
            correction_age=epoch.correction_age,
            satellites=min(epoch.satellites or 0, _MOST_SATELLITES),
        )
