"""Wiggle: moves a steering a little to both sides, and judges whether it follows (docs/calibration.md).

`WiggleRun` is pure: what is known in, what to command out. Whatever looks like a runaway ends it with "off".
"""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing
from enum import Enum, auto

from drawbar.config import Configuration
from drawbar.driving.devices.actuators import gate_wires
from drawbar.driving.devices.gate_options import gate_options
from drawbar.driving.devices.receiver_transports import open_receivers
from drawbar.driving.messaging.socket_folder import SocketFolder
from drawbar.machine.calibration.wiggle import Wiggle, wiggle_command, wiggle_test
from drawbar.machine.hardware.receiver import Receiver
from drawbar.protocols.actuator import Readiness, SteeringReport, SteeringRequest
from drawbar.protocols.speed_actuator import SpeedRequest
from drawbar.safety.wires import Wires
from drawbar.vehicle.parameters import STEERINGS

SLOWEST, FASTEST = 0.2, 1.5
"""m/s, between which the vehicle must roll: a standing tyre is not turned"""
AMPLITUDE = math.radians(2.0)
"""to either side, rad"""
TRAVEL = math.radians(5.0)
"""from where it began, at which it has run away, rad"""
_SIDE = 1.0
"""for which each side is held, s"""
_SETTLED = 0.5
"""before the first motion, s"""
_RESTS = 1.0
"""after the last one, s"""
ROLLS = 30.0
"""within which the vehicle must roll, s"""
_READY, _TAKES = 5.0, 3.0
"""within which the actuator must be ready once it rolls, and then take over, s"""
_SILENCE = 0.3
"""oldest measured angle, s"""
_PAUSE = 0.2
"""without a tick, after which what is wrong may be this computer's: boards answer no sooner than they are asked, s"""
_STIFF, _LEAST = 0.8, math.radians(0.3)
"""time after a set point within which it must have moved by so much, s, rad: else its sensor may be stuck"""
_FRESH = 1.0
"""oldest speed, s"""
_TICK = 0.05
"""s"""
_OFF = 1.0
"""for which the release of the steering is commanded at the end, s"""


class Phase(Enum):
    """Where a wiggle is."""

    READYING = auto()
    TAKING = auto()
    MOVING = auto()
    ENDED = auto()


class WiggleRun:
    """The wiggle of one steering."""

    def __init__(self) -> None:
        """Begin with the first tick."""
        self.phase = Phase.READYING
        self.reason = ""
        """why it was broken off, and what to do"""
        self._since = self._ticked = self._rolls = self._taken = self._origin = self._turned = math.nan
        self._rows: list[tuple[float, float, float]] = []
        self._set_point = self._at_turn = 0.0

    def tick(self, now: float, report: SteeringReport, speed: float) -> SteeringRequest:
        """Return what to ask for at a time, s; speed of the vehicle in m/s, NaN: not known."""
        self._since = now if math.isnan(self._since) else self._since
        if self.phase is Phase.READYING:
            self._ready(now, report, speed)
        elif self.phase is not Phase.ENDED:
            self._go_on(now, report, speed)
        self._ticked = now
        if self.phase in (Phase.READYING, Phase.ENDED):
            return SteeringRequest(steer=False, angle=0.0, speed=0.0 if math.isnan(speed) else speed)
        return SteeringRequest(steer=True, angle=self._origin + self._set_point, speed=speed)

    def judged(self) -> Wiggle:
        """Return what the motion shows; one that was broken off is refused for that reason."""
        if self.reason or not self._rows:
            return Wiggle(gain=math.nan, delay=math.nan, explained=0.0, refusals=(self.reason or "it was not made",))
        return wiggle_test(*zip(*self._rows, strict=True))

    def end(self, reason: str) -> None:
        """Break it off for a reason."""
        if self.phase is not Phase.ENDED:
            self.phase, self.reason = Phase.ENDED, reason

    def _ready(self, now: float, report: SteeringReport, speed: float) -> None:
        if not SLOWEST <= speed <= FASTEST:
            self._rolls = math.nan
            if now - self._since > ROLLS:
                self.end(_rolling(speed))
            return
        self._rolls = now if math.isnan(self._rolls) else self._rolls
        if report.readiness is Readiness.READY:
            self.phase, self._since, self._origin = Phase.TAKING, now, report.angle
        elif now - self._rolls > _READY:
            self.end(f"the actuator {report.readiness.value}")

    def _go_on(self, now: float, report: SteeringReport, speed: float) -> None:
        if reason := self._wrong(now, report, speed):
            pause = now - self._ticked
            busy = f". This computer had paused for {pause:.1f} s: end other programs, then try again"
            self.end(reason + busy * (pause > _PAUSE))
            return
        if not self._rows or report.angle_time > self._rows[-1][0]:
            self._rows.append((report.angle_time, self._origin + self._set_point, report.angle))
        if self.phase is Phase.TAKING:
            self._taken = now if report.engaged and math.isnan(self._taken) else self._taken
            if now - self._taken >= _SETTLED:
                self.phase, self._since, self._origin = Phase.MOVING, now, report.angle
                self._rows = [(at, self._origin, angle) for at, _, angle in self._rows]
            return
        wanted = wiggle_command(now - self._since, amplitude=AMPLITUDE, duration=_SIDE)
        if wanted != self._set_point:
            self._set_point, self._turned, self._at_turn = wanted, now, report.angle
        if now - self._since >= 3.0 * _SIDE + _RESTS:
            self.phase = Phase.ENDED

    def _wrong(self, now: float, report: SteeringReport, speed: float) -> str:
        """Return what is wrong now, or nothing."""
        if report.overridden:
            return "the operator took over"
        if not (now - report.angle_time <= _SILENCE and math.isfinite(report.angle)):
            return "the measured angle is missing or old; check the sensor and the cable"
        if not SLOWEST <= speed <= FASTEST:
            return _rolling(speed)
        if not abs(report.angle - self._origin) <= TRAVEL:
            away = math.degrees(report.angle - self._origin)
            return f"runaway: it has turned {away:+.1f}° from where it began; switch it off and look"
        if math.isnan(self._taken):
            late = now - self._since > _TAKES
            return f"the actuator did not take over: it {report.readiness.value}" if late else ""
        if not report.engaged:
            return f"the actuator has released the steering: it {report.readiness.value}"
        if now - self._turned > _STIFF and not abs(report.angle - self._at_turn) >= _LEAST and self._set_point:
            return "it does not move, or its sensor does not see it; check valve, motor and sensor"
        return ""


def wiggle_both(configuration: Configuration) -> Iterator[tuple[str, Wiggle]]:
    """Wiggle the front wheels and then the joint of a machine, and yield what each has shown.

    Where the front wheels' was broken off, as by an operator who took over, the joint is not moved.

    Raises:
        DrawbarError: a transport cannot be opened.
    """
    assert configuration.devices is not None
    with ExitStack() as opened:
        options = gate_options(configuration, folder=opened.enter_context(SocketFolder()), controller=-1)
        tractor, *others = open_receivers(configuration.devices, options.sentences)
        for each in others:
            opened.callback(each.close)
        receiver = opened.enter_context(closing(Receiver(tractor, configuration.devices.tractor_receiver)))
        wires = opened.enter_context(closing(Wires(gate_wires(options))))
        for body, name in enumerate(STEERINGS.values()):
            found = carry_out(wires, body, lambda now: _speed(receiver, now))
            yield name, found
            if math.isnan(found.gain):
                return


def _speed(receiver: Receiver, now: float) -> float:
    """Return the newest speed over ground, m/s; NaN where there is no fresh one."""
    receiver.poll(now)
    epoch = receiver.last
    return epoch.speed if epoch is not None and now - epoch.time <= _FRESH else math.nan


def _rolling(speed: float) -> str:
    known = "is not known" if math.isnan(speed) else f"is {speed:.2f} m/s"
    return f"the vehicle's speed {known}; roll straight ahead at {SLOWEST} to {FASTEST} m/s"


def carry_out(wires: Wires, body: int, speed: Callable[[float], float]) -> Wiggle:
    """Wiggle one steering in real time, and let all actuators go afterwards, whatever happens.

    Args:
        wires: to all actuators.
        body: 0: front wheels, 1: the joint.
        speed: returns that of the vehicle at a monotonic time, m/s; NaN: not known.
    """
    run = WiggleRun()
    try:
        while run.phase is not Phase.ENDED:
            now = time.monotonic()
            wires.receive()
            report = wires.steering(now)[body] or SteeringReport()
            _tell(wires, now, body, run.tick(now, report, speed(now)))
            time.sleep(_TICK)
    finally:
        end = time.monotonic() + _OFF
        while (now := time.monotonic()) < end:
            wires.receive()
            _tell(wires, now, body, SteeringRequest(steer=False, angle=0.0, speed=0.0))
            time.sleep(_TICK)
    return run.judged()


def _tell(wires: Wires, now: float, body: int, request: SteeringRequest) -> None:
    off = SteeringRequest(steer=False, angle=0.0, speed=request.speed)
    both: Sequence[SteeringRequest] = (request, off) if body == 0 else (off, request)
    wires.send(now, (both[0], both[1]), SpeedRequest(drive=False, speed=0.0, deceleration=1.0))
