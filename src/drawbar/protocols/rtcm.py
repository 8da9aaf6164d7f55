"""RTCM 3 correction streams: frames with their checksum out of any bytes, and what a stream contains. Pure.

A frame is D3, six zero bits and ten bits of length, the payload, and CRC-24Q over all of that (RTCM 10403). The first
twelve bits of a payload are its message type.
"""

import math
from collections import Counter

from drawbar.protocols.crc24q import SpanChecksums, crc24q

PREAMBLE = 0xD3
LONGEST_PAYLOAD = 1023
HEAD, CHECKSUM = 3, 3
"""bytes before and after the payload"""
_WITH_STATION = frozenset((*range(1001, 1014), 1033, 1230, *range(1071, 1138)))
"""types whose second field, twelve bits, is the reference station"""
_MSM = frozenset(first + kind for first in range(1070, 1140, 10) for kind in range(1, 8))
_OBSERVATIONS = frozenset((*range(1001, 1005), *range(1009, 1013))) | _MSM
"""types that hold measurements: the older ones of GPS and GLONASS, and MSM1 to MSM7 of all systems"""


def rtcm_frame(payload: bytes) -> bytes:
    """Return the frame around a payload of 1023 bytes at most; ValueError: it is longer."""
    if len(payload) > LONGEST_PAYLOAD:
        raise ValueError(f"a payload of {len(payload)} bytes; RTCM 3 allows {LONGEST_PAYLOAD}")
    body = bytes((PREAMBLE, len(payload) >> 8, len(payload) & 0xFF)) + payload
    return body + crc24q(body).to_bytes(CHECKSUM, "big")


def message_type(frame: bytes) -> int:
    """Return the type of an intact frame, 0 where its payload is too short for one."""
    return frame[HEAD] << 4 | frame[HEAD + 1] >> 4 if len(frame) >= HEAD + 2 + CHECKSUM else 0


def station_of(frame: bytes) -> int | None:
    """Return the reference station that an intact frame names, or None where its type names none."""
    if message_type(frame) not in _WITH_STATION or len(frame) < HEAD + 3 + CHECKSUM:
        return None
    return (frame[HEAD + 1] & 0x0F) << 8 | frame[HEAD + 2]


class RtcmFramer:
    """Takes frames out of bytes that are cut anywhere. Bytes that belong to no intact frame are dropped and counted."""

    def __init__(self, dropped: Counter[str] | None = None) -> None:
        """Begin; where counts are given, continue them."""
        self.dropped: Counter[str] = Counter() if dropped is None else dropped
        """`bytes` outside frames, and frames whose `checksum` is wrong"""
        self._held = bytearray()

    def feed(self, data: bytes) -> list[bytes]:
        """Return the frames that these bytes complete."""
        self._held += data
        frames: list[bytes] = []
        start, checksums = 0, SpanChecksums(self._held)
        while True:
            found = self._held.find(PREAMBLE, start)
            self.dropped["bytes"] += (found if found >= 0 else len(self._held)) - start
            start = found if found >= 0 else len(self._held)
            end = self._end(start)
            if end is None:
                break
            if end > start and checksums.of(start, end) == 0:
                frames.append(bytes(self._held[start:end]))
                start = end
            else:
                self.dropped["checksum"] += end > start
                self.dropped["bytes"] += 1
                start += 1
        del self._held[:start]
        return frames

    def _end(self, start: int) -> int | None:
        """Return where the frame at `start` ends; `start` itself: none begins there; None: more bytes are needed."""
        if len(self._held) < start + HEAD:
            return None
        if self._held[start + 1] & 0xFC:
            return start
        length = self._held[start + 1] << 8 | self._held[start + 2]
        end = start + HEAD + length + CHECKSUM
        return end if len(self._held) >= end else None


class RtcmStatus:
    """What a stream of corrections has contained: types, age of the observations, reference station."""

    def __init__(self) -> None:
        self.types: Counter[int] = Counter()
        """frames of each message type"""
        self.station: int | None = None
        """reference station"""
        self._observed = -math.inf

    def take(self, time: float, frame: bytes) -> None:
        """Take in an intact frame that was received at a monotonic time, s."""
        kind, station = message_type(frame), station_of(frame)
        self.types[kind] += 1
        if kind in _OBSERVATIONS:
            self._observed = time
        self.station = self.station if station is None else station

    def observation_age(self, time: float) -> float:
        """Return how long ago the last observations came, s; inf: never."""
        return time - self._observed
