"""Checksums of the receivers' protocols."""

import binascii
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
