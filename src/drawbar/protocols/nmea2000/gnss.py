"""GNSS: the epochs of one NMEA 2000 receiver, its messages joined by their sequence identifier."""

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

from drawbar.protocols.isobus.identifier import Message, decode
from drawbar.protocols.isobus.node import Component
from drawbar.protocols.nmea2000.fast_packet import FastPackets
from drawbar.protocols.nmea2000.messages import (
    ATTITUDE,
    COURSE_SPEED,
    GNSS_POSITION,
    HEADING,
    POSITION_RAPID,
    RATE_OF_TURN,
    Attitude,
    GnssPosition,
    Heading,
    Motion,
    RapidPosition,
    Turn,
    decode_attitude,
    decode_gnss_position,
    decode_heading,
    decode_motion,
    decode_rapid_position,
    decode_turn,
)
from drawbar.transports.base import CanFrame

_HOLD = 0.03
"""for how long an epoch waits for what came with the one before, s"""
_SILENCE = 2.0
"""after which another receiver may take the place of the one that sent first, s"""
_OPEN = 8
"""epochs open at a time; the oldest gives way"""
_KEPT = 64
"""finished epochs kept until they are asked for"""

Joined = Motion | Heading | Turn | Attitude
_JOINED: dict[int, Callable[[bytes], Joined | None]] = {
    COURSE_SPEED: decode_motion,
    HEADING: decode_heading,
    RATE_OF_TURN: decode_turn,
    ATTITUDE: decode_attitude,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Nmea2000Epoch:
    """All that a receiver has reported of one instant; the rest is None."""

    time: float
    """monotonic time at which the first frame of it was received, s"""
    position: GnssPosition
    motion: Motion | None = None
    heading: Heading | None = None
    turn: Turn | None = None
    attitude: Attitude | None = None


class _Open:
    """One epoch whose messages are coming in."""

    def __init__(self, time: float) -> None:
        self.time = time
        self.complete_by = math.inf
        self.position: GnssPosition | None = None
        self.joined: dict[type[Joined], Joined] = {}


class Nmea2000Receiver(Component):
    """One receiver; hand it frames of a bus by `receive`, or attach it to a node.

    `source` is the address to listen to; None: the first that sends a position, until it has been silent for 2 s.
    """

    def __init__(self, source: int | None = None) -> None:
        self.dropped: Counter[str] = Counter()
        self.rapid: tuple[float, RapidPosition] | None = None
        """the latest position of 129025 and when it was received; it belongs to no epoch"""
        self._wanted = source
        self._source = source
        self._received = -math.inf
        self._packets = FastPackets()
        self._open: dict[int, _Open] = {}
        self._finished: list[Nmea2000Epoch] = []
        self._last_sid: int | None = None
        self._usual: set[type[Joined]] = {Motion, Heading, Turn, Attitude}
        """kinds that came with the last epoch, or too late for it; at first any may come"""

    def receive(self, time: float, frame: CanFrame) -> None:
        """Take in one frame of any content."""
        message = decode(frame)
        if message is None:
            self.dropped["not NMEA 2000"] += 1
        else:
            self.receive_message(time, message)

    def receive_message(self, time: float, message: Message) -> None:
        """Take in one message."""
        if message.pgn in (POSITION_RAPID, GNSS_POSITION) or message.pgn in _JOINED:
            if self._listens_to(time, message):
                self._receive(time, message)
            else:
                self.dropped["other receiver"] += 1

    @property
    def due(self) -> float:
        """Monotonic time at which an open epoch ends without more of it, infinite while there is none, s."""
        return min((epoch.complete_by for epoch in self._open.values()), default=math.inf)

    def epochs(self, time: float) -> list[Nmea2000Epoch]:
        """Return the epochs finished since the last call, oldest first."""
        self._finish_due(time)
        finished, self._finished = self._finished, []
        return finished

    def drops(self) -> Counter[str]:
        """Return all that was dropped, that of the fast packets included, by kind."""
        return self.dropped + self._packets.dropped

    def _listens_to(self, time: float, message: Message) -> bool:
        position = message.pgn in (POSITION_RAPID, GNSS_POSITION)
        if self._wanted is None and position and time - self._received > _SILENCE and message.source != self._source:
            self._source = message.source
            self._open.clear()
        if message.source != self._source:
            return False
        self._received = time if position else self._received
        return True

    def _receive(self, time: float, message: Message) -> None:
        self._finish_due(time)
        if message.pgn == GNSS_POSITION:
            packet = self._packets.join(time, message)
            if packet is not None:
                self._take_position(packet[0], decode_gnss_position(packet[1]))
        elif message.pgn == POSITION_RAPID:
            self._take_rapid(time, decode_rapid_position(message.data))
        else:
            self._take(time, _JOINED[message.pgn](message.data))

    def _take_rapid(self, time: float, rapid: RapidPosition | None) -> None:
        if rapid is None:
            self.dropped["length"] += 1
        else:
            self.rapid = time, rapid

    def _take_position(self, time: float, position: GnssPosition | None) -> None:
        if position is None:
            self.dropped["length"] += 1
        elif position.sid is None:
            self._keep(Nmea2000Epoch(time=time, position=position))
        else:
            epoch = self._epoch(time, position.sid)
            epoch.position, epoch.complete_by = position, time + _HOLD
            self._settle(position.sid)

    def _take(self, time: float, joined: Joined | None) -> None:
        if joined is None:
            self.dropped["length"] += 1
        elif joined.sid is None:
            self.dropped["belongs to no epoch"] += 1
        elif joined.sid == self._last_sid and joined.sid not in self._open:
            self._usual.add(type(joined))
            self.dropped["late"] += 1
        else:
            self._epoch(time, joined.sid).joined[type(joined)] = joined
            self._settle(joined.sid)

    def _epoch(self, time: float, sid: int) -> _Open:
        """Return the open epoch of a sequence identifier; one that has grown old without a position is restarted."""
        epoch = self._open.get(sid)
        if epoch is not None and time - epoch.time > _SILENCE:
            del self._open[sid]
            self.dropped["epoch without a position"] += 1
        while sid not in self._open and len(self._open) >= _OPEN:
            oldest = next(iter(self._open))
            self.dropped["epoch without a position"] += 1
            del self._open[oldest]
        epoch = self._open.setdefault(sid, _Open(time))
        epoch.time = min(epoch.time, time)
        return epoch

    def _settle(self, sid: int) -> None:
        """Finish an epoch as soon as all is there that usually is."""
        epoch = self._open[sid]
        if epoch.position is not None and epoch.joined.keys() >= self._usual:
            self._finish(sid)

    def _finish_due(self, time: float) -> None:
        for sid, epoch in list(self._open.items()):
            if time >= epoch.complete_by:
                self._finish(sid)

    def _finish(self, sid: int) -> None:
        epoch = self._open.pop(sid)
        if epoch.position is None:
            return
        found = epoch.joined
        motion, heading = found.get(Motion), found.get(Heading)
        turn, attitude = found.get(Turn), found.get(Attitude)
        self._last_sid, self._usual = sid, set(found)
        self._keep(
            Nmea2000Epoch(
                time=epoch.time,
                position=epoch.position,
                motion=motion if isinstance(motion, Motion) else None,
                heading=heading if isinstance(heading, Heading) else None,
                turn=turn if isinstance(turn, Turn) else None,
                attitude=attitude if isinstance(attitude, Attitude) else None,
            )
        )

    def _keep(self, epoch: Nmea2000Epoch) -> None:
        if len(self._finished) == _KEPT:
            del self._finished[0]
            self.dropped["epochs not asked for"] += 1
        self._finished.append(epoch)
