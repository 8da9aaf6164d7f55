"""Listened steering: an actuator whose reports are read and that is never commanded, for shadow drives."""

from dataclasses import replace

from drawbar.protocols.actuator import Frame, Readiness, SteeringActuator, SteeringReport, SteeringRequest


class ListenedSteering(SteeringActuator[Frame]):
    """An actuator of which only the measured angle is known; it cannot be engaged."""

    def __init__(self, actuator: SteeringActuator[Frame]) -> None:
        """Take the actuator, which is given all frames and asked for none."""
        self._actuator, self.dropped = actuator, actuator.dropped

    def receive(self, time: float, frame: Frame, source: str = "") -> None:
        """Take in one frame."""
        self._actuator.receive(time, frame, source)

    def send(self, time: float, request: SteeringRequest) -> list[Frame]:
        """Return nothing, whatever is requested."""
        return []

    def report(self, time: float) -> SteeringReport:
        """Return the measured angle."""
        return replace(self._actuator.report(time), engaged=False, overridden=False, readiness=Readiness.SHADOW)
