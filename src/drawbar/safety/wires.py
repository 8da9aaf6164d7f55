"""Wires: the transports to the actuators with their protocols; only the gate's process opens them."""

import traceback
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ParamSpec, TypeVar

from drawbar.protocols.actuator import SteeringActuator, SteeringReport, SteeringRequest
from drawbar.protocols.speed_actuator import SpeedActuator, SpeedReport, SpeedRequest
from drawbar.realtime import say
from drawbar.transports.base import CanBus, Transport

Result = TypeVar("Result")
Given = ParamSpec("Given")
Report = TypeVar("Report", SteeringReport, SpeedReport)


@dataclass(frozen=True, slots=True, kw_only=True)
class Wire:
    """One transport, and the actuators whose frames it carries."""

    transport: Transport | CanBus
    tractor: SteeringActuator[Any] | None = None
    trailer: SteeringActuator[Any] | None = None
    speed: SpeedActuator[Any] | None = None


class Wires:
    """All actuators. An error of one of them does not keep the others from being disengaged."""

    def __init__(self, wires: Sequence[Wire]) -> None:
        """Take the wires; each actuator is on one of them."""
        self._wires = wires
        self._complained: set[str] = set()
        self.failed = False
        """the program of an actuator or a transport raised an error"""

    @property
    def drives(self) -> bool:
        """Whether there is a speed actuator."""
        return any(wire.speed is not None for wire in self._wires)

    @property
    def dropped(self) -> int:
        """Frames that the actuators' protocols refused."""
        return sum(sum(device.dropped.values()) for wire in self._wires for device in _devices(wire))

    def descriptors(self) -> list[int]:
        """Return the descriptors to wait on; -1 for a transport that must be polled."""
        return [wire.transport.fileno() for wire in self._wires]

    def receive(self) -> None:
        """Give each actuator the frames that have arrived."""
        for wire in self._wires:
            for time, frame, source in self._guarded(_arrived, wire.transport) or []:
                for device in _devices(wire):
                    self._guarded(device.receive, time, frame, source)

    def send(self, time: float, steering: tuple[SteeringRequest, SteeringRequest], speed: SpeedRequest) -> bool:
        """Command all actuators; return whether every frame was sent."""
        sent = True
        for wire in self._wires:
            for frame in self._frames(wire, time, steering, speed):
                sent &= self._guarded(wire.transport.write, frame) is True
        return sent

    def _frames(
        self, wire: Wire, time: float, steering: tuple[SteeringRequest, SteeringRequest], speed: SpeedRequest
    ) -> list[Any]:
        frames: list[Any] = []
        for device, request in ((wire.tractor, steering[0]), (wire.trailer, steering[1])):
            if device is not None:
                frames += self._guarded(device.send, time, request) or []
        if wire.speed is not None:
            frames += self._guarded(wire.speed.send, time, speed) or []
        return frames

    def steering(self, time: float) -> tuple[SteeringReport | None, SteeringReport | None]:
        """Return what is known of the steering of tractor and trailer; None: there is no such actuator."""
        return self._report(time, "tractor", SteeringReport()), self._report(time, "trailer", SteeringReport())

    def speed(self, time: float) -> SpeedReport | None:
        """Return what is known of the speed actuator; None: there is none."""
        return self._report(time, "speed", SpeedReport())

    def close(self) -> None:
        """Give all devices back."""
        for wire in self._wires:
            self._guarded(wire.transport.close)

    def _report(self, time: float, name: str, unknown: Report) -> Report | None:
        device = next((each for wire in self._wires if (each := getattr(wire, name)) is not None), None)
        return None if device is None else self._guarded(device.report, time) or unknown

    def _guarded(self, call: Callable[Given, Result], *args: Given.args, **names: Given.kwargs) -> Result | None:
        """Return the result of a call; where it raises, None, and the error is printed, once for each kind."""
        try:
            return call(*args, **names)
        except Exception as error:
            self.failed = True
            kind = repr(error)
            if kind not in self._complained and len(self._complained) < 16:
                self._complained.add(kind)
                say(traceback.format_exc())
            return None


def _devices(wire: Wire) -> Iterator[SteeringActuator[Any] | SpeedActuator[Any]]:
    return (device for device in (wire.tractor, wire.trailer, wire.speed) if device is not None)


def _arrived(transport: Transport | CanBus) -> list[tuple[float, Any, str]]:
    if isinstance(transport, CanBus):
        return [(time, frame, "") for time, frame in transport.read()]
    return [(each.time, each.data, each.source) for each in transport.read()]
