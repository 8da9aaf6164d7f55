"""Rehearsal: everything of a drive in one process, with the real bytes between its parts and a clock of its own.

What runs on a machine runs here: receivers' bytes, navigation, control loop, gate, boards or valves. Only the wires are
memory, and time is a number, so that a drive takes seconds and is the same each time.
"""

import math
from collections.abc import Iterator

from drawbar.config import Configuration
from drawbar.driving.actuators import isobus_wire, listened
from drawbar.driving.control_loop import ControlLoop
from drawbar.driving.controller import Controller
from drawbar.driving.memory import MemoryBus, MemoryChannel, MemoryDesk, MemoryTransport
from drawbar.driving.operator import DemonstrationOperator, Operator
from drawbar.driving.stand_ins import stand_in_machine
from drawbar.geometry import LocalFrame
from drawbar.guidance.path import Path
from drawbar.machine.hardware.devices import DeviceSettings
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

STEP = 5_000_000
"""of the clock, ns"""
_LOOK = 0.2
"""between two looks of the operator, and two heartbeats, s"""


class Rehearsal:
    """A drive of a configuration on stand-ins."""

    def __init__(
        self, configuration: Configuration, path: Path, seed: int, safety: SafetySettings, *, shadow: bool = False
    ) -> None:
        """Build everything.

        Args:
            configuration: of the run; its machine is the simulated one, behind the receivers and the ISOBUS that its
                devices name, or receivers and boards.
            path: to drive along.
            seed: of everything random.
            safety: of the gate.
            shadow: the gate only listens to the actuators.
        """
        vehicle, frame = configuration.vehicle, LocalFrame(latitude=50.87, longitude=4.7)
        self.now = 0
        """ns"""
        self.gate_state: GateState | None = None
        bus: list[MemoryBus] = []
        self.machine = stand_in_machine(configuration, path, frame, seed, MemoryBus(bus, lambda: self.time))
        self._lines = {line: MemoryTransport() for line in (*BODIES, SENSORS)}
        self._navigation = self._build_navigation(configuration.devices, frame)
        self._wires = {body: MemoryTransport() for body in self.machine.boards}
        wires = [self._board_wire(body) for body in self._wires]
        if configuration.devices is not None and configuration.devices.isobus is not None:
            limit = safety.envelope.speed if configuration.devices.speed == "isobus" else None
            wires.append(isobus_wire(configuration.devices.isobus, limit, MemoryBus(bus, lambda: self.time)))
        self._controller_channel, self._desk = MemoryChannel(), MemoryDesk()
        self.gate = Gate(
            safety,
            Bounds(
                wheelbase=vehicle.wheelbase,
                tractor_limit=vehicle.tractor_steering_limit,
                trailer_limit=vehicle.trailer_steering_limit,
            ),
            [listened(wire) for wire in wires] if shadow else wires,
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

    def _build_navigation(self, devices: DeviceSettings | None, frame: LocalFrame) -> Navigation:
        plain = ReceiverSettings(transport="memory")
        tractor, trailer = (
            Receiver(self._lines[body], getattr(devices, f"{body}_receiver") if devices else plain) for body in BODIES
        )
        board = SensorBoardSettings(
            transport="memory", hitch_counts=HITCH_COUNTS, hitch_angles=HITCH_ANGLES, pulses_per_metre=PULSES
        )
        return Navigation(tractor, trailer, frame, SensorLine(self._lines[SENSORS], board))

    def _board_wire(self, body: str) -> Wire:
        board = SteerBoard(board=f"192.168.{5 + BODIES.index(body)}.126", max_angle=math.radians(45.0))
        tractor, trailer = (board, None) if body == "tractor" else (None, board)
        return Wire(transport=self._wires[body], tractor=tractor, trailer=trailer)

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
