"""Fields: numbers and states within the 8 bytes of a message; what is in error or not available is NaN or None."""

import math

_LAST_VALID_U16 = 0xFAFF
"""above: indicators, errors, not available (ISO 11783-7)"""


def u16(data: bytes, offset: int) -> int:
    """Return two bytes, least significant first."""
    return data[offset] | data[offset + 1] << 8


def scaled_u16(data: bytes, offset: int, resolution: float, zero: int = 0) -> float:
    """Return (raw - zero) resolution, or NaN where raw is in error or not available."""
    raw = u16(data, offset)
    return (raw - zero) * resolution if raw <= _LAST_VALID_U16 else math.nan


def packed_u16(value: float, resolution: float, zero: int = 0) -> bytes:
    """Return `value` / resolution + zero rounded, as two bytes; NaN becomes "not available".

    Raises:
        ValueError: the field cannot hold the value

    """
    if math.isnan(value):
        return b"\xff\xff"
    if not fits_u16(value, resolution, zero):
        low, high = -zero * resolution, (_LAST_VALID_U16 - zero) * resolution
        raise ValueError(f"{value} does not fit the field of 16 bits, which holds {low} to {high}")
    return (round(value / resolution) + zero).to_bytes(2, "little")


def fits_u16(value: float, resolution: float, zero: int = 0) -> bool:
    """Return whether the field can hold the value, which NaN and infinity are not."""
    return math.isfinite(value) and 0 <= round(value / resolution) + zero <= _LAST_VALID_U16


def bits(byte: int, first: int, width: int) -> int:
    """Return `width` bits from bit `first` on."""
    return (byte >> first) & ((1 << width) - 1)


def flag(byte: int, first: int) -> bool | None:
    """Return a state of two bits: False, True, or None where it is in error or not available."""
    return {0: False, 1: True}.get(bits(byte, first, 2))


def packed_flag(state: bool | None, first: int) -> int:
    """Return a state of two bits at its place; None becomes "not available"."""
    return (3 if state is None else int(state)) << first
