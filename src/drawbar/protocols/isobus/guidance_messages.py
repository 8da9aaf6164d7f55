"""Guidance messages: the curvature asked of a steering valve (0xAD00) and the valve's own state (0xAC00)."""

import math
from dataclasses import dataclass
from enum import IntEnum

from drawbar.protocols.isobus.fields import bits, fits_u16, flag, packed_flag, packed_u16, scaled_u16

SYSTEM_COMMAND = 0xAD00
MACHINE_INFO = 0xAC00
_PER_METRE = -0.25e-3
"""of one bit, 1/m; on the wire right is positive, inside left is"""
_STRAIGHT = 32128


class Intention(IntEnum):
    """Whether the sender of a command wants to steer."""

    NOT_INTENDED = 0
    INTENDED = 1
    ERROR = 2
    NOT_AVAILABLE = 3


class LimitStatus(IntEnum):
    """What bounds the valve."""

    NOT_LIMITED = 0
    OPERATOR = 1
    LIMITED_HIGH = 2
    LIMITED_LOW = 3
    NON_RECOVERABLE = 6
    NOT_AVAILABLE = 7


class ExitReason(IntEnum):
    """Why the valve has last released the steering, or does not take it."""

    NONE = 0
    OPERATOR_PRESENCE = 1
    IMPLEMENT_RELEASED = 2
    OPERATOR_OVERRIDE = 3
    CONTROL_NOT_IN_POSITION = 4
    COMMAND_TIMEOUT = 5
    OUT_OF_RANGE = 6
    NOT_CALIBRATED = 7
    CONTROL_FAULT = 8
    FUNCTION_FAULT = 9
    OIL_LEVEL = 20
    OIL_TEMPERATURE = 21
    GEAR = 22
    TOO_SLOW = 23
    TOO_FAST = 24
    OTHER_GUIDANCE = 25
    DIAGNOSIS = 26
    ERROR = 62
    NOT_AVAILABLE = 63


PASSING_EXITS = (
    ExitReason.OPERATOR_PRESENCE,
    ExitReason.IMPLEMENT_RELEASED,
    ExitReason.OPERATOR_OVERRIDE,
    ExitReason.CONTROL_NOT_IN_POSITION,
    ExitReason.COMMAND_TIMEOUT,
    ExitReason.OUT_OF_RANGE,
    ExitReason.GEAR,
    ExitReason.TOO_SLOW,
    ExitReason.TOO_FAST,
)
"""reasons that may be over while a valve or tractor still sends them"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SystemCommand:
    """The guidance system's command."""

    curvature: float
    """1/m, left positive; NaN: not available"""
    intention: Intention


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineInfo:
    """The valve's own state; None and NaN are what it does not report, or reports to be in error."""

    curvature: float = math.nan
    """estimated, 1/m, left positive"""
    locked_out: bool | None = None
    ready: bool | None = None
    in_position: bool | None = None
    """the operator's controls are where steering by command is allowed"""
    reset_required: bool | None = None
    """wants a command "not intended" first"""
    limit: int = LimitStatus.NOT_AVAILABLE
    """a `LimitStatus`, or a reserved number"""
    exit_reason: int = ExitReason.NOT_AVAILABLE
    """an `ExitReason`, or a reserved number"""
    engage_switch: bool | None = None
    """the operator's switch asks for steering"""


def encodable(curvature: float) -> bool:
    """Return whether a curvature, 1/m, can be sent on the wire: finite and within ±8 /m."""
    return fits_u16(curvature, _PER_METRE, _STRAIGHT)


def encode_command(command: SystemCommand) -> bytes:
    """Return the 8 bytes of a command; ValueError where the curvature does not fit."""
    return packed_u16(command.curvature, _PER_METRE, _STRAIGHT) + bytes([0xFC | command.intention]) + b"\xff" * 5


def decode_command(data: bytes) -> SystemCommand | None:
    """Return the command of 8 bytes, None where there are not 8."""
    if len(data) != 8:
        return None
    return SystemCommand(curvature=scaled_u16(data, 0, _PER_METRE, _STRAIGHT), intention=Intention(bits(data[2], 0, 2)))


def encode_machine_info(info: MachineInfo) -> bytes:
    """Return the 8 bytes of a machine's information; ValueError where the curvature does not fit."""
    states = (info.locked_out, info.ready, info.in_position, info.reset_required)
    packed = sum(packed_flag(state, 2 * place) for place, state in enumerate(states))
    switch = packed_flag(info.engage_switch, 6)
    # The reserved bits beside the limit status are 0, as AgIsoStack++ sends them.
    tail = bytes([packed, info.limit << 5, switch | info.exit_reason]) + b"\xff" * 3
    return packed_u16(info.curvature, _PER_METRE, _STRAIGHT) + tail


def decode_machine_info(data: bytes) -> MachineInfo | None:
    """Return the information of 8 bytes, None where there are not 8."""
    if len(data) != 8:
        return None
    return MachineInfo(
        curvature=scaled_u16(data, 0, _PER_METRE, _STRAIGHT),
        locked_out=flag(data[2], 0),
        ready=flag(data[2], 2),
        in_position=flag(data[2], 4),
        reset_required=flag(data[2], 6),
        limit=bits(data[3], 5, 3),
        exit_reason=bits(data[4], 0, 6),
        engage_switch=flag(data[4], 6),
    )
