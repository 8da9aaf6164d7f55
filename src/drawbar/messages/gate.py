"""Gate: its state, and what it steers by."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated

from drawbar.messages.base import Message
from drawbar.messages.fields import Byte, Cell, Codes, Count, Known, Long, Number, Signed, Time


class SupervisorState(IntEnum):
    """Where the supervisor is (docs/safety.md)."""

    BOOT = 0
    """before the first update"""
    SELFTEST = 1
    """the gate tests itself, its connections and its settings"""
    STANDBY = 2
    """a condition of engaging is not met"""
    READY = 3
    """all conditions are met: the operator may engage"""
    ENGAGING = 4
    """it steers as soon as actuators and controller have taken over; rates and distances are halved"""
    ACTIVE = 5
    """it steers"""
    DEGRADED = 6
    """it steers, slower and for a limited time: see its cause"""
    STOPPING = 7
    """it steers until the vehicle stands"""
    STOPPED = 8
    """released after a stop; waits for the acknowledgement"""
    OVERRIDE = 9
    """released: the operator has taken over at an actuator; waits for the acknowledgement"""
    FAULT = 10
    """released at once for a cause; waits for the acknowledgement"""
    ESTOP = 11
    """released by an emergency stop; waits for the acknowledgement"""


@dataclass(frozen=True, slots=True, kw_only=True)
class GateState(Message):
    """What the gate does; gate to controller, recorder and front ends, at each of its ticks."""

    state: Annotated[SupervisorState, Cell("B")]
    """of the supervisor"""
    steers: Byte
    """1: the gate asks the actuators to steer"""
    engaged: Byte
    """which actuators report that they steer or drive; 1 tractor, 2 trailer, 4 speed"""
    stop: Byte
    """1: the vehicle is asked to stop; 2: as fast as possible. Without a speed actuator: the driver is to stop it"""
    armed: Byte
    """1: the operator may engage now"""
    cause: Annotated[int, Cell("H")]
    """code of what led to this state; 0: nothing"""
    answer: Annotated[int, Cell("H")]
    """to the last operator's message, PRESENT that is accepted left out: 0 accepted, else the code of why not"""
    answered: Long
    """nonce of that message"""
    lease: Long
    """who may engage; 0: nobody yet"""
    since: Time
    """when this state was entered, ns"""
    refusals: Codes
    """codes of what stands against engaging, or of causes while driving, the first eight; 0: no more"""
    remaining: Known
    """until this state is left by itself, s; NaN: it is not"""
    tractor_angle: Known
    """measured, rad"""
    tractor_angle_time: Time
    """when it was received, ns; 0: never"""
    trailer_angle: Known
    """measured, rad"""
    trailer_angle_time: Time
    """when it was received, ns; 0: never"""
    tractor_set_point: Known
    """given to the actuator, rad; NaN: none"""
    trailer_set_point: Known
    """given to the actuator, rad; NaN: none"""
    speed_limit: Number
    """fastest that the gate lets the vehicle drive now, m/s"""
    set_speed: Known
    """the operator's wish, m/s; NaN: none"""
    nudge: Number
    """the operator's shift of the line, m, to the left of the configured line's direction"""
    clips: Count
    """commands that were limited, since the start"""
    rejects: Count
    """commands that were refused, since the start"""
    dropped: Count
    """other records and frames that were refused, since the start"""
    line: Signed = 0
    """the operator's choice of the line: so many working widths to the left of the configured one"""
    concerned: Byte = 0
    """which actuators reported the cause of this state, as bits of `engaged`; 0: none of them did"""
