"""Tractor messages: speeds, hitches and power take-offs of ISO 11783-7 to SI and back."""

import math
from dataclasses import dataclass
from enum import IntEnum

from drawbar.protocols.isobus.fields import bits, flag, packed_flag, packed_u16, scaled_u16

WHEEL_SPEED = 0xFE48
GROUND_SPEED = 0xFE49
SELECTED_SPEED = 0xF022
SELECTED_SPEED_COMMAND = 0xFD43
REAR_HITCH = 0xFE45
FRONT_HITCH = 0xFE46
REAR_PTO = 0xFE43
FRONT_PTO = 0xFE44
_MILLI = 1e-3
_NO_DISTANCE = 0xFFFFFFFF
_DISTANCE_ERROR = 0xFE000000
_DISTANCE_ROUND = 0xFB000000
"""where the counter of ISO 11783-7 restarts; some run on to 2^32"""
_PTO_RESOLUTION = 0.125 * 2.0 * math.pi / 60.0
_HITCH_RESOLUTION = 0.004
_LAST_VALID_U8 = 250


class SpeedSource(IntEnum):
    """Where the machine's selected speed comes from."""

    WHEEL = 0
    GROUND = 1
    NAVIGATION = 2
    BLENDED = 3
    SIMULATED = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class WheelOrGroundSpeed:
    """What the wheels (0xFE48) or the radar (0xFE49) measure."""

    speed: float = math.nan
    """m/s, reverse negative; NaN: not available, in error, or moving in a direction that is not reported"""
    distance: float = math.nan
    """m, reverse counted as forward; restarts every 4295 km"""


@dataclass(frozen=True, slots=True, kw_only=True)
class WheelStates:
    """The switches beside the wheel-based speed."""

    key_on: bool | None = None
    operations: bool | None = None
    """implements are to start (True) or stop"""
    reversed_by_operator: bool | None = None
    """the operator's station is turned round"""
    power_time: float = math.nan
    """longest time for which the tractor still gives power, s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SelectedSpeed:
    """The speed that the machine itself goes by (0xF022)."""

    speed: float = math.nan
    """m/s, reverse negative; NaN as in `WheelOrGroundSpeed`"""
    distance: float = math.nan
    """m"""
    source: int = 7
    """a `SpeedSource`, or a reserved number; 7: not available"""
    exit_reason: int = 63
    """why a speed command was left; 0: none, 63: not available"""
    limit: int = 7
    """0: not limited, 1: by the operator, 2: high, 3: low, 6: not recoverable, 7: not available"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hitch:
    """One three-point hitch (0xFE45 rear, 0xFE46 front)."""

    position: float = math.nan
    """share of the stroke, 1: up"""
    in_work: bool | None = None
    limit: int = 7
    """0: not limited, 7: not available"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PowerTakeOff:
    """One power take-off (0xFE43 rear, 0xFE44 front)."""

    speed: float = math.nan
    """of the shaft, rad/s"""
    set_point: float = math.nan
    """rad/s"""


def decode_speed(data: bytes) -> WheelOrGroundSpeed | None:
    """Return a wheel- or ground-based speed, None where there are not 8 bytes."""
    if len(data) != 8:
        return None
    return WheelOrGroundSpeed(speed=_signed_speed(data), distance=_distance(data))


def encode_speed(value: WheelOrGroundSpeed, states: WheelStates | None = None) -> bytes:
    """Return the 8 bytes of 0xFE48 (with states) or 0xFE49; ValueError where a number does not fit."""
    power_time, tail = 0xFF, 0xFC
    if states is not None:
        power_time = 0xFF if math.isnan(states.power_time) else round(states.power_time / 60.0)
        flags = (states.key_on, states.operations, states.reversed_by_operator)
        tail = sum(packed_flag(state, 2 * place) for place, state in enumerate(flags, 1))
    return _speed_and_distance(value.speed, value.distance) + bytes([power_time, tail | _direction(value.speed)])


def decode_selected_speed(data: bytes) -> SelectedSpeed | None:
    """Return the machine's selected speed, None where there are not 8 bytes."""
    if len(data) != 8:
        return None
    return SelectedSpeed(
        speed=_signed_speed(data),
        distance=_distance(data),
        source=bits(data[7], 2, 3),
        exit_reason=bits(data[6], 0, 6),
        limit=bits(data[7], 5, 3),
    )


def encode_selected_speed(value: SelectedSpeed) -> bytes:
    """Return the 8 bytes of 0xF022; ValueError where a number does not fit."""
    # The reserved bits beside the exit reason are 1, as AgIsoStack++ sends them.
    tail = bytes([0xC0 | value.exit_reason, _direction(value.speed) | value.source << 2 | value.limit << 5])
    return _speed_and_distance(value.speed, value.distance) + tail


def encode_speed_command(speed: float, limit: float = math.nan) -> bytes:
    """Return the 8 bytes of 0xFD43: set point, m/s, reverse negative, and limit of its amount, m/s; NaN: none.

    Raises:
        ValueError: a speed that the 16 bits cannot hold (64.255 m/s)

    """
    return packed_u16(abs(speed), _MILLI) + packed_u16(limit, _MILLI) + b"\xff" * 3 + bytes([0xFC | _direction(speed)])


def decode_speed_command(data: bytes) -> tuple[float, float] | None:
    """Return set point, m/s, reverse negative, and limit, m/s, of 0xFD43; None where there are not 8 bytes."""
    if len(data) != 8:
        return None
    return _signed_speed(data), scaled_u16(data, 2, _MILLI)


def decode_hitch(data: bytes) -> Hitch | None:
    """Return a hitch, None where there are not 8 bytes."""
    if len(data) != 8:
        return None
    position = data[0] * _HITCH_RESOLUTION if data[0] <= _LAST_VALID_U8 else math.nan
    return Hitch(position=position, in_work=flag(data[1], 6), limit=bits(data[1], 3, 3))


def decode_power_take_off(data: bytes) -> PowerTakeOff | None:
    """Return a power take-off, None where there are not 8 bytes."""
    if len(data) != 8:
        return None
    return PowerTakeOff(speed=scaled_u16(data, 0, _PTO_RESOLUTION), set_point=scaled_u16(data, 2, _PTO_RESOLUTION))


def _signed_speed(data: bytes) -> float:
    """Return the speed with the sign of the direction flag; without one only standstill is known."""
    amount, forward = scaled_u16(data, 0, _MILLI), flag(data[7], 0)
    if forward is None and amount != 0.0:
        return math.nan
    return -amount if forward is False and amount else amount


def _direction(speed: float) -> int:
    return packed_flag(None if math.isnan(speed) else speed >= 0.0, 0)


def _distance(data: bytes) -> float:
    raw = int.from_bytes(data[2:6], "little")
    return raw * _MILLI if raw < _DISTANCE_ERROR else math.nan


def _speed_and_distance(speed: float, distance: float) -> bytes:
    raw = _NO_DISTANCE if math.isnan(distance) else round(distance / _MILLI) % _DISTANCE_ROUND
    return packed_u16(abs(speed), _MILLI) + raw.to_bytes(4, "little")
