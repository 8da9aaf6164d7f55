"""Framing: whole frames out of a stream that mixes NMEA, UBX, SBF and RTCM with anything else.

The libraries' own readers swallow up to 65 kB after one corrupted length. Here a candidate that fails costs its first
byte alone: the search continues at the next, so every intact frame comes out, however the stream was cut.
"""

import re
from collections import Counter, deque
from dataclasses import dataclass
from enum import Enum

from drawbar.protocols.crc24q import SpanChecksums
from drawbar.protocols.gnss.checksums import crc_ccitt, fletcher, xor

_SYNC = re.compile(rb"[$\xb5\xd3]")
_SENTENCE_END = re.compile(rb"[^ -#%-)+-~]")
"""what cannot stand in the body of a sentence: the asterisk, a new start, and all that is not printable"""
_HEXADECIMAL = re.compile(rb"[0-9A-Fa-f]{2}")
_LINE_END = b"\r\n"

LONGEST_NMEA = 200
"""characters; the standard has 82, and KSXT with its base vector 150"""
LONGEST_UBX = 1024
LONGEST_SBF = 2048


class Protocol(Enum):
    """What a frame is of."""

    NMEA = "NMEA"
    UBX = "UBX"
    SBF = "SBF"
    RTCM = "RTCM"


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """One intact frame, its checksum proved."""

    protocol: Protocol
    data: bytes
    """from the first byte of the frame to the last of its checksum, without line ends"""
    time: float
    """monotonic, when its first byte was there, s"""


class _Broken(Exception):  # noqa: N818 -- the usual way of most bytes of noise
    """No frame of this kind begins here."""


class _Incomplete(Exception):  # noqa: N818 -- not an error
    """The frame that may begin here is not all there."""


class Framer:
    """A state machine over a buffer of at most one candidate; `dropped` counts bytes and candidates by kind."""

    dropped: Counter[str]

    def __init__(self) -> None:
        self.dropped = Counter()
        self._buffer = bytearray()
        self._taken = 0
        self._arrivals: deque[tuple[int, float]] = deque()  # (index of the byte behind a piece, its time)

    @property
    def is_waiting(self) -> bool:
        """Whether a frame may have begun that is not all there."""
        return bool(self._buffer)

    def push(self, data: bytes, time: float) -> list[Frame]:
        """Take in bytes that came at a monotonic time (s), and return the frames that they complete."""
        self._buffer += data
        self._arrivals.append((self._taken + len(self._buffer), time))
        return self._frames(last=False)

    def settle(self) -> list[Frame]:
        """Give up the candidate that waits for bytes, after a silence, and return the intact frames behind it."""
        return self._frames(last=True)

    def _frames(self, *, last: bool) -> list[Frame]:
        found: list[Frame] = []
        buffer, position, checksums = self._buffer, 0, SpanChecksums(self._buffer)
        while match := _SYNC.search(buffer, position):
            self._drop_noise(buffer[position : match.start()])
            position = match.start()
            try:
                protocol, end = _candidate(buffer, position, checksums)
            except _Incomplete:
                if not last:
                    break
                self.dropped["incomplete"] += 1
                end = 0
            except _Broken as broken:
                self.dropped[str(broken)] += 1
                end = 0
            if end:
                found.append(Frame(protocol=protocol, data=bytes(buffer[position:end]), time=self._time(position)))
            position = end or position + 1
        else:
            self._drop_noise(buffer[position:])
            position = len(buffer)
        self._forget(position)
        return found

    def _drop_noise(self, skipped: bytearray) -> None:
        """Count bytes in which no frame begins; line ends belong to the sentences before them."""
        if skipped and (count := len(skipped.translate(None, _LINE_END))):
            self.dropped["noise bytes"] += count

    def _time(self, position: int) -> float:
        """Return when the byte at a position of the buffer came."""
        return next(time for end, time in self._arrivals if self._taken + position < end)

    def _forget(self, count: int) -> None:
        """Take the first bytes off the buffer."""
        del self._buffer[:count]
        self._taken += count
        while self._arrivals and self._arrivals[0][0] <= self._taken:
            self._arrivals.popleft()


def _candidate(buffer: bytearray, start: int, checksums: SpanChecksums) -> tuple[Protocol, int]:
    """Return the protocol of the intact frame at a byte of synchronisation, and where it ends."""
    first = buffer[start]
    _need(buffer, start + 2)
    second = buffer[start + 1]
    if first == 0x24:
        return (Protocol.SBF, _sbf(buffer, start)) if second == 0x40 else (Protocol.NMEA, _nmea(buffer, start))
    if first == 0xB5 and second == 0x62:
        return Protocol.UBX, _ubx(buffer, start)
    if first == 0xD3 and second < 4:
        return Protocol.RTCM, _rtcm(buffer, start, checksums)
    raise _Broken("noise bytes")


def _nmea(buffer: bytearray, start: int) -> int:
    """Return the end of $body*hh."""
    limit = start + LONGEST_NMEA - 3
    match = _SENTENCE_END.search(buffer, start + 1, limit + 1)
    if not match:
        if len(buffer) > limit:
            raise _Broken("NMEA length")
        raise _Incomplete
    star = match.start()
    if match[0] in (b"\r", b"\n"):
        raise _Broken("NMEA without checksum")
    if match[0] != b"*":
        raise _Broken("NMEA character")
    _need(buffer, star + 3)
    digits = bytes(buffer[star + 1 : star + 3])
    if not _HEXADECIMAL.fullmatch(digits) or int(digits, 16) != xor(buffer[start + 1 : star]):
        raise _Broken("NMEA checksum")
    return star + 3


def _ubx(buffer: bytearray, start: int) -> int:
    """Return the end of B5 62, class, id, length u16, payload, two bytes of Fletcher's checksum."""
    _need(buffer, start + 6)
    end = start + 8 + int.from_bytes(buffer[start + 4 : start + 6], "little")
    if end - start > LONGEST_UBX:
        raise _Broken("UBX length")
    _need(buffer, end)
    if fletcher(buffer[start + 2 : end - 2]) != bytes(buffer[end - 2 : end]):
        raise _Broken("UBX checksum")
    return end


def _sbf(buffer: bytearray, start: int) -> int:
    """Return the end of $@, CRC u16, id u16, length u16 of the whole block, time, body."""
    _need(buffer, start + 8)
    length = int.from_bytes(buffer[start + 6 : start + 8], "little")
    if length % 4 or not 16 <= length <= LONGEST_SBF:
        raise _Broken("SBF length")
    end = start + length
    _need(buffer, end)
    if crc_ccitt(buffer[start + 4 : end]) != int.from_bytes(buffer[start + 2 : start + 4], "little"):
        raise _Broken("SBF checksum")
    return end


def _rtcm(buffer: bytearray, start: int, checksums: SpanChecksums) -> int:
    """Return the end of D3, 6 zero bits, 10 bits of length, payload, CRC of 24 bits."""
    _need(buffer, start + 3)
    end = start + 6 + int.from_bytes(buffer[start + 1 : start + 3], "big")
    _need(buffer, end)
    if checksums.of(start, end):
        raise _Broken("RTCM checksum")
    return end


def _need(buffer: bytearray, end: int) -> None:
    if len(buffer) < end:
        raise _Incomplete
