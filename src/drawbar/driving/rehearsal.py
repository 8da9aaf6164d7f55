"""Rehearsal: everything of a drive in one process, with the real bytes between its parts and a clock of its own.

What runs on a machine runs here: receivers' bytes, navigation, control loop, gate, boards. Only the wires are memory,
and time is a number, so that a drive takes seconds and is the same each time.
"""

import math
from collections.abc import Iterator

from drawbar.config import Configuration
from drawbar.driving.control_loop import ControlLoop
from drawbar.driving.controller import Controller
from drawbar.driving.operator import DemonstrationOperator, Operator
from drawbar.driving.stand_ins import stand_in_machine
from drawbar.geometry import LocalFrame
from drawbar.guidance.path import Path
from drawbar.machine.hardware.navigation import Navigation
from drawbar.machine.hardware.receiver import Receiver, ReceiverSettings
from drawbar.machine.hardware.sampler import Sampler
from drawbar.machine.hardware.sensor_line import SensorBoardSettings, SensorLine
from drawbar.machine.stand_in.machine import BODIES, HITCH_ANGLES, HITCH_COUNTS, PULSES, SENSORS
from drawbar.messages import Action, GateState, Heartbeat, Message, Role, SupervisorState, decode, encode, seconds
from drawbar.protocols.agopengps.steer_board import SteerBoard
from drawbar.safety.envelope import Bounds
from drawbar.safety.machine_gate import Gate
from drawbar.safety.settings import SafetySettings
from drawbar.safety.wires import Wire
from drawbar.signals import StepRecord, Truth
from drawbar.transports.base import Received, Transport

STEP = 5_000_000
"""of the clock, ns"""
_LOOK = 0.2
"""between two looks of the operator, and two heartbeats, s"""


class MemoryTransport(Transport):
    """A wire in memory: `arrive` puts bytes in, `sent` holds what was written."""

    connected = True

    def __init__(self) -> None:
        """Begin empty."""
        self._arrived: list[Received] = []
        self.sent: list[bytes] = []

    def arrive(self, time: float, data: bytes, source: str = "") -> None:
        """Let bytes come at a time, s."""
        self._arrived.append(Received(time, data, source))

    def fileno(self) -> int:
        """Return -1: there is nothing to wait on."""
        return -1

    def read(self) -> list[Received]:
        """Return what has arrived."""
        arrived, self._arrived = self._arrived, []
        return arrived

    def write(self, data: bytes) -> bool:
        """Keep what is sent."""
        self.sent.append(data)
        return True

    def close(self) -> None:
        """Do nothing."""


class MemoryChannel:
    """The gate's channels to controller and operators, in memory: records in, records out."""

    def __init__(self) -> None:
        """Begin empty."""
        self.inbox: list[bytes] = []
        self.outbox: list[bytes] = []
        self.gone = False

    def receive(self, most: int) -> list[bytes]:
        """Return the controller's records."""
        records, self.inbox = self.inbox[:most], self.inbox[most:]
        return records

    def send(self, record: bytes) -> None:
        """Keep a record for the controller."""
        self.outbox.append(record)


class MemoryDesk(MemoryChannel):
    """As MemoryChannel, for operators."""

    def receive(self, most: int) -> list[tuple[bytes, str]]:  # type: ignore[override]
        """Return the operators' records."""
        return [(record, "") for record in super().receive(most)]

    def subscribe(self, sender: str) -> None:
        """Do nothing: everybody sees the outbox."""

    def publish(self, record: bytes) -> None:
        """Keep a record for the operators."""
        self.outbox.append(record)


class Rehearsal:
    """A drive of a configuration on stand-ins."""

    def __init__(self, configuration: Configuration, path: Path, seed: int, safety: SafetySettings) -> None:
        """Build everything.

        Args:
            configuration: of the run; its machine is the simulated one.
            path: to drive along.
            seed: of everything random.
            safety: of the gate.
        """
        vehicle, frame = configuration.vehicle, LocalFrame(latitude=50.87, longitude=4.7)
        self.now = 0
        """ns"""
        self.gate_state: GateState | None = None
        self.machine = stand_in_machine(configuration, path, frame, seed)
        self._lines = {body: MemoryTransport() for body in BODIES}
        receivers = (Receiver(self._lines[body], ReceiverSettings(transport="memory")) for body in BODIES)
        self._lines[SENSORS] = MemoryTransport()
        board = SensorBoardSettings(
            transport="memory", hitch_counts=HITCH_COUNTS, hitch_angles=HITCH_ANGLES, pulses_per_metre=PULSES
        )
        sensors = SensorLine(self._lines[SENSORS], board)
        self._navigation = Navigation(next(receivers), next(receivers), frame, sensors)
        self._wires = {body: MemoryTransport() for body in BODIES}
        boards = {
            body: SteerBoard(board=f"192.168.{5 + index}.126", max_angle=math.radians(45.0))
            for index, body in enumerate(BODIES)
        }
        self._controller_channel, self._desk = MemoryChannel(), MemoryDesk()
        self.gate = Gate(
            safety,
            Bounds(
                wheelbase=vehicle.wheelbase,
                tractor_limit=vehicle.tractor_steering_limit,
                trailer_limit=vehicle.trailer_steering_limit,
            ),
            [
                Wire(transport=self._wires["tractor"], tractor=boards["tractor"]),
                Wire(transport=self._wires["trailer"], trailer=boards["trailer"]),
            ],
            self._controller_channel,  # type: ignore[arg-type]
            self._desk,  # type: ignore[arg-type]
        )
        self._tick, self._due, self._look = safety.timing.tick, 0.0, 0.0
        self._records: list[tuple[StepRecord, Truth]] = []
        self.loop = ControlLoop(
            Controller(configuration, path, safety.fingerprint()),
            Sampler(configuration.sample_time),
            send=self._send,
            record=lambda record: self._records.append((record, self.machine.world.truth)),
            clock=lambda: self.now,
        )
        self.operator = DemonstrationOperator(Operator(1, lambda message: self._desk.inbox.append(encode(message))))

    @property
    def time(self) -> float:
        """Time of the clock, s."""
        return seconds(self.now)

    def _send(self, message: Message) -> None:
        self._controller_channel.inbox.append(encode(message))

    def run(self, duration: float) -> Iterator[tuple[StepRecord, Truth]]:
        """Yield each step with the truth at that time, for a time, s."""
        end = self.time + duration
        while self.time < end:
            self.advance()
            records, self._records = self._records, []
            yield from records

    def ask(self, action: Action) -> None:
        """Let the operator ask for something now."""
        self.operator.operator.ask(action, self.now)

    def advance(self) -> None:
        """Let a step of the clock pass."""
        self.now += STEP
        heard, sent = self.machine.advance(self.time)
        for body, data in heard:
            self._lines[body].arrive(self.time, data)
        for body, output in sent:
            self._arrive(body, output.data)
        for fixes in self._navigation.poll(self.time):
            self.loop.hear_fixes(fixes)
        if self.now >= self.loop.due:
            self.loop.pass_time(self.now)
        if self.time >= self._look:
            self._look = self.time + _LOOK
            self._look_around()
        if self.gate.hear(self.time) or self.time >= self._due:
            self.gate.tick(self.time, max(self.time - self._due - seconds(STEP), 0.0))
            self._due = self.time + self._tick
        self._deliver()

    def _deliver(self) -> None:
        """Hand over what the gate has sent."""
        for body, wire in self._wires.items():
            frames, wire.sent = wire.sent, []
            for frame in frames:
                for _, output in self.machine.receive(self.time, body, frame, 9999):
                    self._arrive(body, output.data)
        for record in self._controller_channel.outbox:
            state = decode(record, GateState)
            if isinstance(state, GateState):
                self.gate_state = state
                self.loop.hear_gate(state)
                self.operator.see(state)
                self.machine.driver.told_to_stop = bool(state.stop) and state.state is not SupervisorState.STANDBY
        self._controller_channel.outbox.clear()
        self._desk.outbox.clear()

    def _arrive(self, body: str, data: bytes) -> None:
        index = BODIES.index(body)
        self._wires[body].arrive(self.time, data, f"192.168.{5 + index}.126:8888")

    def _look_around(self) -> None:
        now = self.now
        self.operator.look(now)
        state = self.gate_state.state if self.gate_state else SupervisorState.BOOT
        for role in (Role.RECEIVERS, Role.CONTROLLER, Role.RECORDER):
            beat = Heartbeat(sequence=0, time=now, valid_until=now + 10**9, role=role, healthy=1, state=state)
            self._desk.inbox.append(encode(beat))
