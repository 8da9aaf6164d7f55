"""Fast packet: messages of up to 223 bytes, joined from frames that may come out of order."""

from collections import Counter
from dataclasses import dataclass, field

from drawbar.protocols.isobus.identifier import Message

_FIRST = 6
"""bytes in frame 0, behind counter and length"""
_NEXT = 7
"""bytes in each later frame, behind the counter"""
_LONGEST = _FIRST + 31 * _NEXT
_PATIENCE = 0.25
"""after which an unfinished message is given up, s; a sequence returns after 8 messages, at 10 Hz 0.8 s"""
_OPEN = 32
"""unfinished messages at a time; the oldest gives way"""


@dataclass(slots=True)
class _Unfinished:
    start: float
    length: int | None = None
    pieces: dict[int, bytes] = field(default_factory=dict)

    def whole(self) -> bytes | None:
        """Return the message once all of it is there."""
        if self.length is None:
            return None
        frames = range(1 + max(0, -(-(self.length - _FIRST) // _NEXT)))
        if any(index not in self.pieces for index in frames):
            return None
        return b"".join(self.pieces[index] for index in frames)[: self.length]


class FastPackets:
    """Joins the frames of each sender, group and sequence; what stays unfinished is dropped and counted."""

    def __init__(self) -> None:
        self.dropped: Counter[str] = Counter()
        self._open: dict[tuple[int, int, int], _Unfinished] = {}

    def join(self, time: float, message: Message) -> tuple[float, bytes] | None:
        """Take in one frame; return the time of the first frame and the whole message where this one finished it."""
        if len(message.data) != 8:
            self.dropped["fast packet: length"] += 1
            return None
        self._give_up(time)
        sequence, index = message.data[0] >> 5, message.data[0] & 31
        key = message.source, message.pgn, sequence
        unfinished = self._open.setdefault(key, _Unfinished(time))
        if not self._add(unfinished, index, message.data[1:]):
            del self._open[key]
            return None
        whole = unfinished.whole()
        if whole is None:
            return None
        del self._open[key]
        return unfinished.start, whole

    def _add(self, unfinished: _Unfinished, index: int, data: bytes) -> bool:
        """Add one frame; return False where the message is spoilt."""
        known = unfinished.pieces.get(index)
        piece = data[1:] if index == 0 else data
        if known is not None and (known != piece or (index == 0 and unfinished.length != data[0])):
            self.dropped["fast packet: two frames of one number"] += 1
            return False
        if index == 0:
            if data[0] > _LONGEST:
                self.dropped["fast packet: length"] += 1
                return False
            unfinished.length = data[0]
        unfinished.pieces[index] = piece
        return True

    def _give_up(self, time: float) -> None:
        stale = [key for key, unfinished in self._open.items() if time - unfinished.start > _PATIENCE]
        stale = stale or list(self._open)[: max(0, len(self._open) - _OPEN + 1)]
        for key in stale:
            del self._open[key]
            self.dropped["fast packet: unfinished"] += 1
