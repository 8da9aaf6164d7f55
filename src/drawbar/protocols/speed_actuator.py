"""A speed actuator behind its protocol: what the gate asks of it, and what it reports. Pure, without numpy."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Generic, TypeVar

from drawbar.protocols.actuator import Readiness

Frame = TypeVar("Frame")


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedRequest:
    """What the actuator is asked for now."""

    drive: bool
    """False: stop, and stay; sent on the wire, never by silence"""
    speed: float
    """set point, m/s, forward positive; ignored where `drive` is False"""
    deceleration: float
    """with which to stop where `drive` is False, m/s², positive"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedReport:
    """What is known of the actuator at an instant."""

    engaged: bool = False
    """the actuator reports that it drives as asked"""
    overridden: bool = False
    """the operator took over (pedal, lever, brake) since the last request to stop"""
    readiness: Readiness = Readiness.SILENT
    """whether it may be engaged, or why not"""


class SpeedActuator(ABC, Generic[Frame]):
    """One speed actuator behind its protocol; called as a `SteeringActuator` is. All times are monotonic, s."""

    dropped: dict[str, int]

    @abstractmethod
    def receive(self, time: float, frame: Frame, source: str = "") -> None:
        """Take in one frame, of any content and any sender."""

    @abstractmethod
    def send(self, time: float, request: SpeedRequest) -> list[Frame]:
        """Return the frames that send `request` now."""

    @abstractmethod
    def report(self, time: float) -> SpeedReport:
        """Return what is known now."""
