"""Checksums of the receivers' protocols."""

import binascii
from collections.abc import Sequence
from functools import reduce
from itertools import accumulate
from operator import xor as _xor

Bytes = bytes | bytearray


def xor(body: Bytes) -> int:
    """Return NMEA's checksum of what stands between $ and *."""
    return reduce(_xor, body, 0)


def fletcher(data: Bytes) -> bytes:
    """Return UBX's two bytes for class, id, length and payload: the sum, and the sum of the sums, modulo 256."""
    return bytes((sum(data) & 0xFF, sum(accumulate(data)) & 0xFF))


def crc_ccitt(data: Bytes) -> int:
    """Return SBF's CRC of a block from its id to its end: polynomial 0x1021, start 0."""
    return binascii.crc_hqx(data, 0)


def crc24q(data: Bytes) -> int:
    """Return RTCM's CRC of a frame from D3 to its payload's end: polynomial 0x1864CFB, start 0."""
    crc = 0
    for byte in data:
        crc = (crc << 8) & 0xFFFFFF ^ _CRC24Q[crc >> 16 ^ byte]
    return crc


def _crc24q_table() -> Sequence[int]:
    table = []
    for byte in range(256):
        crc = byte << 16
        for _ in range(8):
            crc = crc << 1 ^ (0x1864CFB if crc & 0x800000 else 0)
        table.append(crc & 0xFFFFFF)
    return tuple(table)


_CRC24Q = _crc24q_table()
