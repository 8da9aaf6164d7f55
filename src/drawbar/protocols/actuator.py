"""A steering actuator behind its protocol: what the gate asks of it, and what it reports. Pure, without numpy."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum
from typing import Generic, TypeVar

Frame = TypeVar("Frame")


@dataclass(frozen=True, slots=True, kw_only=True)
class SteeringRequest:
    """What one actuator is asked for now."""

    steer: bool
    """False: release the steering, sent on the wire, never by silence"""
    angle: float
    """set point, rad, left positive; finite whenever `steer`, else ignored"""
    speed: float
    """of the vehicle, m/s, forward positive; some actuators release the steering outside of a range of it"""


class Readiness(Enum):
    """Whether an actuator can be engaged; the text of each is what the operator is to do."""

    READY = "ready"
    SILENT = "reports nothing; check its power, its cable and its address"
    TOO_NEW = "has reported for less than a second; wait"
    SWITCHED_ON = "already steers, or its switch is on; turn it off"
    OVERRIDDEN = "the operator took over; engage again when ready"
    LOCKED_OUT = "is locked out; see the machine's own display"
    NOT_READY = "reports that it is not ready; see the machine's own display"
    OTHER_MASTER = "another program commands it too; stop that program"
    ADDRESS_LOST = "drawbar has no address on the bus; see who else claims it"
    SHADOW = "is only listened to: drawbar looks on; start it without --shadow"
    FAULT = "reports a fault; see the machine's own display"


@dataclass(frozen=True, slots=True, kw_only=True)
class SteeringReport:
    """What is known of one actuator at an instant."""

    angle: float = math.nan
    """measured steering angle, rad, left positive; NaN: not measured"""
    angle_time: float = -math.inf
    """monotonic time at which `angle` was received, s; -inf: never"""
    engaged: bool = False
    """the actuator reports that it steers as asked"""
    overridden: bool = False
    """the operator took over since the last request to release the steering; stays until drawbar has released it"""
    readiness: Readiness = Readiness.SILENT
    """whether it may be engaged, or why not"""
    switch: bool | None = None
    """the operator's own engage switch at the actuator is on; None: it has none, or none was received.
    Turning it on asks to engage, turning it off to release; never what the actuator itself has switched"""


class SteeringActuator(ABC, Generic[Frame]):
    """One steering actuator behind its protocol. All times are monotonic, s; frames are datagrams or CAN frames.

    The gate calls `receive` for each frame that arrives and `send` at each of its ticks, and puts on the wire what
    `send` returns. An actuator never raises on what it receives; it counts what it drops in `dropped`, by kind.
    """

    dropped: dict[str, int]

    @abstractmethod
    def receive(self, time: float, frame: Frame, source: str = "") -> None:
        """Take in one frame, of any content and any sender; `source` is the sender's address, if it has one."""

    @abstractmethod
    def send(self, time: float, request: SteeringRequest) -> list[Frame]:
        """Return the frames that send `request` now, those of the protocol's own sequences (edges, hello) included."""

    @abstractmethod
    def report(self, time: float) -> SteeringReport:
        """Return what is known now."""
