"""Stream of one NMEA 2000 receiver, the whole way from frames to epochs, as `gnss/stream.py` for bytes. Pure."""

import datetime
import math
from collections import Counter

from drawbar.protocols.gnss.assembly import Assembler
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.messages import (
    DAY,
    Attitude,
    Content,
    Date,
    InertialAttitude,
    Message,
    Position,
    Turn,
    Velocity,
)
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.protocols.gnss.values import LARGEST_SPEED
from drawbar.protocols.nmea2000.gnss import Nmea2000Epoch, Nmea2000Receiver
from drawbar.protocols.nmea2000.messages import FixMethod, GnssPosition, Motion
from drawbar.signals import FixQuality
from drawbar.transports.can_listener import unpacked

KIND = "NMEA 2000"
_QUALITIES: dict[int, FixQuality] = {
    FixMethod.SINGLE: FixQuality.SINGLE,
    FixMethod.DIFFERENTIAL: FixQuality.DIFFERENTIAL,
    FixMethod.RTK_FIXED: FixQuality.FIXED,
    FixMethod.RTK_FLOAT: FixQuality.FLOAT,
}
"""other methods are no fix to drive by, as with NMEA 0183"""
_SAFE = 1
"""integrity: 0 is not checked, 1 safe; from 2 on the receiver itself warns"""


class Nmea2000Stream:
    """One receiver's frames in, its epochs out. Call `poll` not later than at `due`."""

    def __init__(self, settings: EpochSettings, source: int | None = None) -> None:
        """Take the settings and the receiver's address; None: the first that sends a position."""
        self._receiver, self._assembler = Nmea2000Receiver(source), Assembler(settings)
        self._takes_heading = settings.antennas.baseline > 0.0
        self.kinds: Counter[str] = Counter()
        """epochs understood"""

    @property
    def dropped(self) -> Counter[str]:
        """What became of no epoch so far, by kind."""
        return self._receiver.drops() + self._assembler.dropped

    @property
    def frozen(self) -> int:
        """Epochs in a row that came with the time of the one before."""
        return self._assembler.frozen

    @property
    def due(self) -> float:
        """Monotonic time at which `poll` may have something to do, infinite while there is nothing, s."""
        return self._receiver.due

    def push(self, data: bytes, time: float) -> list[Epoch]:
        """Take one frame, packed, that came at a monotonic time (s), and return the epochs that it ends."""
        frame = unpacked(data)
        if frame is None:
            self._receiver.dropped["no frame"] += 1
        else:
            self._receiver.receive(time, frame)
        return self.poll(time)

    def poll(self, time: float) -> list[Epoch]:
        """Return the epochs that have ended until this monotonic time (s)."""
        ended: list[Epoch] = []
        for epoch in self._receiver.epochs(time):
            self.kinds[KIND] += 1
            ended += self._assembler.add(self._message(epoch), epoch.time)
            ended += self._assembler.close()
        return ended

    def _velocity(self, said: Motion) -> Velocity:
        if said.speed > LARGEST_SPEED:
            self._receiver.dropped["impossible speed"] += 1
            return Velocity()
        return Velocity(speed=said.speed, course=said.course)

    def _message(self, epoch: Nmea2000Epoch) -> Message:
        """Return all of an epoch as one message, in the conventions of `gnss/messages.py`."""
        utc, contents = epoch.position.utc, list[Content]([_position(epoch.position)])
        if epoch.motion is not None:
            contents.append(self._velocity(epoch.motion))
        if epoch.heading is not None and self._takes_heading:  # else it may be a compass's
            contents.append(Attitude(yaw=epoch.heading.yaw))
        if epoch.attitude is not None:
            contents.append(InertialAttitude(roll=epoch.attitude.roll, pitch=-epoch.attitude.pitch))  # there nose up
        if epoch.turn is not None:
            contents.append(Turn(yaw_rate=epoch.turn.yaw_rate))
        if math.isfinite(utc):
            contents.append(Date(day=datetime.datetime.fromtimestamp(utc, datetime.UTC).date()))
        return Message(kind=KIND, utc=utc % DAY if math.isfinite(utc) else None, contents=tuple(contents))


def _position(said: GnssPosition) -> Position:
    known = math.isfinite(said.latitude + said.longitude) and said.integrity <= _SAFE
    return Position(
        latitude=said.latitude,
        longitude=said.longitude,
        height=said.altitude + said.geoid_separation,
        altitude=said.altitude,
        separation=said.geoid_separation,
        quality=_QUALITIES.get(said.method, FixQuality.NONE) if known else FixQuality.NONE,
        code=said.method,
        satellites=said.satellites,
        hdop=said.hdop,
        correction_age=said.correction_age,
        station=said.station,
        resolution=1e-16,
    )
