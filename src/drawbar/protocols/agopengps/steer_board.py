"""Steer board: an AIO v4 or AiO_26 board as a steering actuator, with the rules that make its firmware safe to use.

A board begins to steer when the status goes from 0 to 1. An AIO v4 that starts while it receives status 1 steers by
itself, both resume after a silence, and an AIO v4 whose operator took over keeps the motor on until the next frame.
So status 1 is sent only after an edge of the request, to a board that has replied for a second and was off during
three frames with status 0; and whatever is wrong, status 0 is sent at once and from then on, until the request has
been taken back.
"""

import math
from collections.abc import Collection

from drawbar.errors import ConfigurationError
from drawbar.protocols.actuator import Readiness, SteeringActuator, SteeringReport, SteeringRequest
from drawbar.protocols.agopengps.board_replies import LARGEST_ANGLE, BoardReplies
from drawbar.protocols.agopengps.frame import COMPUTER, PREFIX, Pgn, Refusal, parse
from drawbar.protocols.agopengps.network import HELLO, HELLO_PERIOD
from drawbar.protocols.agopengps.steering import SteerCommand, decode_steer_reply

FASTEST = 25.0 / 3.6
"""speed above which boards release, m/s"""
PERIOD = 0.045
"""least time between two equal set points, s: 20 Hz from a caller at 20 Hz whose ticks are not exact, 22 Hz at most"""
NEWS_PERIOD = 0.05
"""least time in which two further set points follow one, s, where the last is a new one, which need not wait for its
turn: below 40 Hz in the mean"""
NEWS_GAP = 0.01
"""least time between any set point and a new one, s"""
NEWS = math.radians(0.01)
"""by so much a new set point differs from the one before, rad: a step on the wire"""
EDGE_PERIOD = 0.09
"""least time between the first set point with status 1 and the next, s: the board must look at it between the two"""
PATIENCE = 0.5
"""for the board to report that it steers, from the first frame with status 1, s; it needs two replies"""
OWN_GAP = 1.0
"""own silence after which status 0 must be sent, s"""
OFF_TIME = 1.0
"""status 0 before any status 1, s"""
OFF_FRAMES = 3
"""frames with status 0, with the board off, before any status 1"""
MASTER_GONE = 2.0
"""silence of another computer after which it counts as gone, s"""

SET_POINT = PREFIX + bytes((COMPUTER, Pgn.STEER))
"""how a datagram with a set point begins"""
_EXPECTED = frozenset((Pgn.STEER_HELLO_REPLY, Pgn.SCAN_REPLY, Pgn.SENSOR, Pgn.TEXT))


class SteerBoard(SteeringActuator[bytes]):
    """One board behind one address.

    Set points go out at 10 to 22 Hz, however often `send` is called; a release goes out with the next call, and so does
    a new set point to a board that steers, below 40 Hz in the mean. While another computer is seen to send set points
    to the board, drawbar releases for a second and then keeps silent: its zeros between the other's ones would be edges
    that make the board steer again after its operator took over.
    """

    def __init__(self, *, board: str, max_angle: float, inverted: bool = False, own: Collection[str] = ()) -> None:
        """Make the actuator of the board that answers from `board`, an IPv4 address with or without `:port`.

        Args:
            board: where replies come from; all else is dropped.
            max_angle: largest set point either way, rad; larger ones are clamped.
            inverted: the board's positive angle is to the left, as a joint's sensor may be mounted.
            own: `address:port` of this computer's own sockets, whose broadcasts it may hear itself.

        Raises:
            ConfigurationError: `max_angle` is not between 0 and 50°, beyond which boards release.
        """
        if not 0.0 < max_angle < LARGEST_ANGLE:
            raise ConfigurationError(
                f"max_angle is {max_angle} rad; boards steer below 0.8727 rad (50°) only; give the machine's own limit"
            )
        self.dropped: dict[str, int] = {}
        self.releases: dict[str, int] = {}
        """how often the steering was released unasked, by cause"""
        self._replies = BoardReplies(address=board, inverted=inverted, own=frozenset(own))
        self._max_angle = max_angle
        self._sign = -1.0 if inverted else 1.0
        self._asked = False
        self._steering = False
        self._cause: Readiness | None = None
        self._speed = 0.0
        self._sent = -math.inf
        self._interval = 0.0
        self._last_sent = math.nan
        self._status = False
        self._edge = math.inf
        self._released = -math.inf
        self._off_since = math.inf
        self._off_frames = 0
        self._hello = -math.inf

    def is_board(self, source: str) -> bool:
        """Return whether `source`, an `address:port`, is the board."""
        return self._replies.is_board(source)

    @property
    def swings(self) -> int:
        """How often the board's angle was away and back again within three replies, as of two boards at one address."""
        return self._replies.swings.count

    # What comes in

    def receive(self, time: float, frame: bytes, source: str = "") -> None:
        """Take in one datagram of any content from `source`, an `address:port`."""
        if frame[:4] == SET_POINT:  # whatever follows: AIO v4 obeys broken ones too
            self._count_unless(self._replies.take_master(time, source), "set point for another network")
        elif not self._replies.is_board(source):
            self._count_unless(False, "other sender")
        else:
            self._take_reply(time, frame)

    def _take_reply(self, time: float, frame: bytes) -> None:
        message = parse(frame)
        if isinstance(message, Refusal):
            self._count_unless(False, message.value)
            return
        reply = decode_steer_reply(message)
        if reply is None:
            self._count_unless(message.pgn in _EXPECTED, "unknown message")
            return
        was_on = not self._replies.steer_off and self._replies.time >= self._edge
        plausible = self._replies.take_reply(time, reply)
        if not reply.steer_off:
            self._off_frames = 0
        if self._steering and not plausible:
            self._release("implausible angle", Readiness.FAULT)
        elif self._steering and was_on and reply.steer_off:
            self._release("operator took over", Readiness.OVERRIDDEN)

    def _count_unless(self, taken: bool, kind: str) -> None:
        if not taken:
            self.dropped[kind] = self.dropped.get(kind, 0) + 1

    # What is decided

    def _release(self, reason: str, cause: Readiness) -> None:
        self._steering, self._cause = False, cause
        self.releases[reason] = self.releases.get(reason, 0) + 1

    def _decide(self, time: float, request: SteeringRequest) -> None:
        """Begin on an edge of a fit request, release for any fault; a cause stays until the request is taken back."""
        rising, self._asked = request.steer and not self._asked, request.steer
        self._speed = request.speed
        if not request.steer:
            self._steering, self._cause = False, None
        elif rising:
            readiness = self._readiness(time) if math.isfinite(request.angle) else Readiness.NOT_READY
            self._steering, self._edge = readiness is Readiness.READY, math.inf
            self._cause = None if self._steering else readiness
        elif self._steering:
            fault = self._fault(time, request)
            if fault is not None:
                self._release(*fault)

    def _fault(self, time: float, request: SteeringRequest) -> tuple[str, Readiness] | None:
        """Return why steering cannot continue, or None."""
        if not (math.isfinite(request.angle) and abs(request.speed) <= FASTEST):
            return "set point or speed not allowed", Readiness.NOT_READY
        if self._replies.master_within(time, MASTER_GONE):
            return "another computer commands", Readiness.OTHER_MASTER
        if time - self._sent >= OWN_GAP:
            return "own gap", Readiness.NOT_READY
        if self._replies.silent(time, self._interval):
            return "no reply", Readiness.SILENT
        waited = time - self._edge > PATIENCE
        if waited and (self._replies.steer_off or self._replies.time < self._edge):
            return "did not begin", Readiness.NOT_READY
        return None

    def _readiness(self, time: float) -> Readiness:
        """Return whether an edge would be followed now."""
        replies = self._replies
        if replies.master_within(time, MASTER_GONE):
            return Readiness.OTHER_MASTER
        if not replies.fresh(time):
            return Readiness.SILENT
        if replies.duration(time) < OFF_TIME:
            return Readiness.TOO_NEW
        if not replies.plausible or replies.jumped_within(time, OFF_TIME):
            return Readiness.FAULT
        if not replies.steer_off:
            return Readiness.TOO_NEW if time - self._released < OFF_TIME else Readiness.SWITCHED_ON
        if not abs(self._speed) <= FASTEST:
            return Readiness.NOT_READY
        prepared = self._off_frames >= OFF_FRAMES and time - self._off_since >= OFF_TIME
        return Readiness.READY if prepared and time - self._sent < OWN_GAP else Readiness.TOO_NEW

    # What goes out

    def send(self, time: float, request: SteeringRequest) -> list[bytes]:
        """Return the datagrams due now: the set point, and every 2 s a hello."""
        self._decide(time, request)
        frames = []
        command = self._set_point(request)
        if self._due(time, command.angle) and not self._yields(time):
            frames.append(command.encode())
            self._last_sent = command.angle
            self._note_sent(time)
        if time - self._hello >= HELLO_PERIOD:
            frames.append(HELLO)
            self._hello = time
        return frames

    def _due(self, time: float, angle: float) -> bool:
        if self._status and not self._steering:
            return True
        if self._status and self._sent == self._edge:
            return time - self._sent >= EDGE_PERIOD
        news = self._status and not self._replies.steer_off and abs(angle - self._last_sent) >= NEWS
        if news and time - self._sent + self._interval >= NEWS_PERIOD:
            return time - self._sent >= NEWS_GAP
        return time - self._sent >= PERIOD

    def _yields(self, time: float) -> bool:
        """Whether another computer has the board, and drawbar has sent its release for long enough, or need not."""
        releasing = self._status or time - self._released < OFF_TIME
        return self._replies.master_within(time, MASTER_GONE) and not self._steering and not releasing

    def _set_point(self, request: SteeringRequest) -> SteerCommand:
        speed = request.speed if abs(request.speed) <= 0xFFFF / 36.0 else 0.0
        if not self._steering:  # where the wheel is: a board that steered all the same would not move it
            return SteerCommand(steer=False, angle=self._replies.wire_angle, speed=speed)
        angle = min(max(request.angle, -self._max_angle), self._max_angle)
        return SteerCommand(steer=True, angle=self._sign * angle, speed=speed)

    def _note_sent(self, time: float) -> None:
        gap = time - self._sent
        if self._steering:
            self._edge = self._edge if self._status else time
            self._off_frames = 0
        else:
            self._released = time if self._status else self._released
            if self._status or gap >= OWN_GAP:
                self._off_since, self._off_frames = time, 0
            self._off_frames += self._replies.steer_off and self._replies.fresh(time)
        self._replies.ask(time)
        self._sent, self._interval, self._status = time, gap, self._steering

    def report(self, time: float) -> SteeringReport:
        """Return what is known now. `engaged`: asked for, sent to the board, and confirmed by it."""
        replies = self._replies
        confirmed = not replies.steer_off and replies.time >= self._edge
        return SteeringReport(
            angle=replies.angle,
            angle_time=replies.time,
            engaged=self._steering and self._status and confirmed,
            overridden=self._cause is Readiness.OVERRIDDEN,
            readiness=self._cause or (Readiness.READY if self._steering else self._readiness(time)),
        )
