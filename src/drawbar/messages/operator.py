"""Operator: what front ends send to the gate."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated

from drawbar.messages.base import Message
from drawbar.messages.fields import Cell, Count, Long, Number, Time


class Action(IntEnum):
    """What an operator asks for."""

    PRESENT = 0
    """nothing: the operator is there, and sees the gate's states; the first one subscribes its sender to them"""
    ARM = 1
    """first half of engaging, and takes the lease"""
    ENGAGE = 2
    """second half, within a few seconds"""
    RELEASE = 3
    """release the steering; accepted from everybody"""
    STOP = 4
    """stop the vehicle, then release the steering; accepted from everybody"""
    EMERGENCY = 5
    """release the steering and stop as fast as possible; accepted from everybody"""
    ACKNOWLEDGE = 6
    """leave a state that waits for the operator"""
    NUDGE = 7
    """move the line by `value`, m, to the left of the configured line's direction"""
    SET_SPEED = 8
    """drive at `value`, m/s"""
    LINE = 9
    """drive the line so many working widths to the left of the configured one as `value`, a whole number; while
    the vehicle is not steered. Takes the lease"""


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatorMessage(Message):
    """What an operator wants; front end to gate, one per datagram. All but PRESENT go to the recorder too."""

    action: Annotated[Action, Cell("B")]
    """what is asked for"""
    lease: Long
    """random number of this front end's session, not 0"""
    nonce: Long
    """larger than in any earlier message of this session"""
    seen_sequence: Count
    """of the gate's state that the operator sees"""
    seen_time: Time
    """of the gate's state that the operator sees, ns"""
    value: Number = 0.0
    """of NUDGE, SET_SPEED and LINE"""
