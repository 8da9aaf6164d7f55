"""Heartbeat: a process is alive."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated

from drawbar.messages.base import Message
from drawbar.messages.fields import Byte, Cell
from drawbar.messages.gate import SupervisorState


class Role(IntEnum):
    """Which process a heartbeat is of."""

    RECEIVERS = 0
    """reads the receivers and sensors"""
    CONTROLLER = 1
    """estimates and plans"""
    RECORDER = 2
    """writes the log"""
    FRONT_END = 3
    """shows the drive to an operator"""
    GUARD = 4
    """releases the boards where the gate falls silent"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Heartbeat(Message):
    """A process is alive; at least at 4 Hz, to the gate's Unix socket."""

    role: Annotated[Role, Cell("B")]
    """which process this is of"""
    healthy: Byte
    """1: it does all that it is there for; the recorder: what it writes reaches the disk"""
    state: Annotated[SupervisorState, Cell("B")]
    """of the gate, as this process received it last"""
