"""Kinds: the number of each message in its record."""

from enum import IntEnum

from drawbar.messages.base import Message
from drawbar.messages.controller import CommandMessage, ControllerState
from drawbar.messages.fixes import Fixes
from drawbar.messages.gate import GateState
from drawbar.messages.heartbeat import Heartbeat
from drawbar.messages.operator import OperatorMessage


class Kind(IntEnum):
    """What a record is."""

    COMMAND = 1
    CONTROLLER_STATE = 2
    GATE_STATE = 3
    OPERATOR = 4
    HEARTBEAT = 5
    FIXES = 6


KINDS: dict[Kind, type[Message]] = {
    Kind.COMMAND: CommandMessage,
    Kind.CONTROLLER_STATE: ControllerState,
    Kind.GATE_STATE: GateState,
    Kind.OPERATOR: OperatorMessage,
    Kind.HEARTBEAT: Heartbeat,
    Kind.FIXES: Fixes,
}
KIND_OF = {cls: kind for kind, cls in KINDS.items()}
