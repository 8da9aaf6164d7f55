"""CRC-24Q, the checksum of RTCM 3: of some bytes, and of any number of spans of one buffer at little cost each. Pure.

Whoever writes `D3 03 FF` again and again begins a frame of 1029 bytes at every third byte. Their checksums one by one
would take 340 steps for each byte that comes; from the running checksum of the whole buffer each takes at most 24.
"""

from functools import reduce
from itertools import accumulate

Bytes = bytes | bytearray

_POLYNOMIAL = 0x1864CFB
_DEGREE = 24
_LONGEST = 1029
"""bytes of a span: a frame of RTCM 3"""


def _powers(count: int) -> tuple[int, ...]:
    """Return x^0, x^1 ... modulo the polynomial."""
    value, powers = 1, []
    for _ in range(count):
        powers.append(value)
        value = value << 1 ^ (_POLYNOMIAL if value >> (_DEGREE - 1) else 0)
    return tuple(powers)


_POWERS = _powers(8 * _LONGEST + _DEGREE)


def _behind(remainder: int, count: int) -> int:
    """Return what a remainder becomes behind so many zero bytes."""
    value = 0
    for power in _POWERS[8 * count : 8 * count + _DEGREE]:
        if remainder & 1:
            value ^= power
        remainder >>= 1
    return value


_REMAINDERS = tuple(_behind(byte, _DEGREE // 8) for byte in range(256))


def _step(remainder: int, byte: int) -> int:
    return (remainder << 8) & 0xFFFFFF ^ _REMAINDERS[remainder >> 16 ^ byte]


def crc24q(data: Bytes) -> int:
    """Return the CRC-24Q of some bytes, starting from zero."""
    return reduce(_step, data, 0)


class SpanChecksums:
    """CRC-24Q of spans of one buffer, which must not change meanwhile."""

    def __init__(self, buffer: Bytes) -> None:
        """Take the buffer; nothing is computed yet."""
        self._buffer = buffer
        self._begin = 0
        self._running: list[int] = []
        """remainders of the bytes from `_begin` to each place"""

    def of(self, begin: int, end: int) -> int:
        """Return the checksum of a span of at most 1029 bytes, which begins no earlier than the first one asked for."""
        if not self._running:
            self._begin, self._running = begin, [0]
        known = self._begin + len(self._running) - 1
        if end > known:
            last = self._running.pop()
            self._running += accumulate(self._buffer[known:end], _step, initial=last)
        before, behind = self._running[begin - self._begin], self._running[end - self._begin]
        return behind ^ _behind(before, end - begin)
