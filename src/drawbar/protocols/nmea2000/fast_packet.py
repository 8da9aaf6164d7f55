"""Fast packet: messages of up to 223 bytes, joined from frames that may come out of order."""

from collections import Counter
from dataclasses import dataclass, field

from drawbar.protocols.isobus.identifier import Message

_FIRST = 6
"""bytes in frame 0, behind counter and length"""
_NEXT = 7
"""bytes in each later frame, behind the counter"""
_LONGEST = _FIRST + 31 * _NEXT
_PATIENCE = 0.08
"""after which an unfinished message is given up, s: a sender whose sequence number stands still begins the next one
after 0.1 s, and its frames must not be joined with what is left of the last"""
_OPEN = 32
"""unfinished messages at a time; the oldest gives way"""


@dataclass(slots=True)
class _Unfinished:
    start: float
    pieces: dict[int, bytes] = field(default_factory=dict)
    """what stands behind the counter, by the frame's number; in that of frame 0 the length comes first"""

    def whole(self) -> bytes | None:
        """Return the message once all of it is there."""
        if 0 not in self.pieces:
            return None
        length = self.pieces[0][0]
        frames = range(1 + max(0, -(-(length - _FIRST) // _NEXT)))
        if any(index not in self.pieces for index in frames):
            return None
        return b"".join(self.pieces[index] for index in frames)[1 : 1 + length]


class FastPackets:
    """Joins the frames of each sender, group and sequence; what stays unfinished is dropped and counted.

    A frame that differs from one of the same number begins another message.
    """

    def __init__(self) -> None:
        self.dropped: Counter[str] = Counter()
        self._open: dict[tuple[int, int, int], _Unfinished] = {}

    def join(self, time: float, message: Message) -> tuple[float, bytes] | None:
        """Take in one frame; return the time of the first frame and the whole message where this one finished it."""
        if len(message.data) != 8:
            self.dropped["fast packet: length"] += 1
            return None
        self._give_up(time)
        sequence, index, data = message.data[0] >> 5, message.data[0] & 31, message.data[1:]
        key = message.source, message.pgn, sequence
        if index == 0 and data[0] > _LONGEST:
            self.dropped["fast packet: length"] += 1
            self._open.pop(key, None)
            return None
        unfinished = self._open.setdefault(key, _Unfinished(time))
        if unfinished.pieces.get(index, data) != data:
            self.dropped["fast packet: two frames of one number"] += 1
            unfinished = self._open[key] = _Unfinished(time)
        unfinished.pieces[index] = data
        whole = unfinished.whole()
        if whole is None:
            return None
        del self._open[key]
        return unfinished.start, whole

    def _give_up(self, time: float) -> None:
        stale = [key for key, unfinished in self._open.items() if time - unfinished.start > _PATIENCE]
        stale = stale or list(self._open)[: max(0, len(self._open) - _OPEN + 1)]
        for key in stale:
            del self._open[key]
            self.dropped["fast packet: unfinished"] += 1
