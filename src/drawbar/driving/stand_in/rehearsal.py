"""Rehearsal: everything of a drive in one process, with the real bytes between its participants and a clock of its own.

Elsewhere this is called software in the loop. What runs on a machine runs here: receivers' bytes, navigation, control
loop, gate, boards or valves. Only the wires are memory, and time is a number, so that a drive takes seconds and is the
same each time.
"""

import math
from collections.abc import Callable, Iterator
from enum import Enum, auto

from drawbar.config import Configuration
from drawbar.driving.devices.actuators import isobus_wire, listened
from drawbar.driving.loop.control_loop import ControlLoop
from drawbar.driving.loop.controller import Controller
from drawbar.driving.loop.field_fence import build_fence
from drawbar.driving.operator.requests import DemonstrationOperator, Operator
from drawbar.driving.processes.guard_main import OFF, Guard
from drawbar.driving.stand_in.memory_transports import MemoryBus, MemoryChannel, MemoryOperatorChannel, MemoryTransport
from drawbar.driving.stand_in.simulated_links import SimulatedLinks
from drawbar.driving.stand_in.stand_in_machine import stand_in_machine
from drawbar.geometry import LocalFrame
from drawbar.guidance.path import Path
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.navigation import Navigation
from drawbar.machine.hardware.receiver import Receiver, ReceiverSettings
from drawbar.machine.hardware.sampler import Sampler
from drawbar.machine.hardware.sensor_line import SensorBoardSettings, SensorLine
from drawbar.machine.stand_in.machine import HITCH_ANGLES, HITCH_COUNTS, PULSES, SENSORS
from drawbar.messages import Action, Fixes, GateState, Heartbeat, Message, Role, SupervisorState
from drawbar.messages.records import decode, encode
from drawbar.nanoseconds import seconds
from drawbar.protocols.agopengps.steer_board import SteerBoard
from drawbar.safety.envelope import Bounds
from drawbar.safety.gate_process import next_tick
from drawbar.safety.machine_gate import Gate
from drawbar.safety.settings import SafetySettings
from drawbar.safety.wires import Wire
from drawbar.signals import StepRecord, Truth
from drawbar.vehicle.parameters import BODIES, VehicleParameters

STEP = 5_000_000
"""of the clock, ns"""
LOOK = 0.2
"""between two looks of the operator, and two heartbeats, s"""


class Participant(Enum):
    """A process of a drive, or the person at its front end."""

    RECEIVERS = auto()
    CONTROLLER = auto()
    GATE = auto()
    RECORDER = auto()
    GUARD = auto()
    OPERATOR = auto()


_ROLES = {
    Participant.RECEIVERS: Role.RECEIVERS,
    Participant.CONTROLLER: Role.CONTROLLER,
    Participant.RECORDER: Role.RECORDER,
    Participant.GUARD: Role.GUARD,
}


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
        frame = LocalFrame(latitude=50.87, longitude=4.7)
        self.now = 0
        """ns"""
        self.stopped: set[Participant] = set()
        """those that do not run now, as after SIGSTOP; what comes for them waits"""
        self.links = SimulatedLinks()
        """carry bytes; their names: of "tractor receiver", "sensors", "tractor board" and so on, "tractor set
        point" to its board, "controller" and "operator" to the gate"""
        self.gate_state: GateState | None = None
        bus: list[MemoryBus] = []
        self.machine = stand_in_machine(configuration, path, frame, seed, MemoryBus(bus, lambda: self.time))
        self._lines = {line: MemoryTransport() for line in (*BODIES, SENSORS)}
        self._navigation = self._build_navigation(configuration.devices, frame)
        self.wires = {body: MemoryTransport() for body in self.machine.boards}
        wires = self._build_wires(configuration.devices, safety, bus)
        self._controller_channel, self._operators = MemoryChannel(), MemoryOperatorChannel()
        self.gate = self._build_gate(
            safety, configuration.vehicle, [listened(wire) for wire in wires] if shadow else wires
        )
        self._guard = Guard(safety.timing)
        self._tick, self._due, self._look = safety.timing.tick, 0.0, 0.0
        self._ticked = -self._tick
        self._records: list[tuple[StepRecord, Truth]] = []
        self._fixes: list[Fixes] = []
        self._states: list[GateState] = []
        self.loop = ControlLoop(
            Controller(configuration, path, safety.fingerprint(), build_fence(configuration)),
            Sampler(configuration.sample_time, has_trailer=configuration.has_trailer_receiver),
            send=self._send,
            record=lambda record: self._records.append((record, self.machine.world.truth)),
            clock=lambda: self.now,
        )
        self.operator = DemonstrationOperator(Operator(1, self._tell_gate))

    def _build_navigation(self, devices: DeviceSettings | None, frame: LocalFrame) -> Navigation:
        plain = ReceiverSettings(transport="file:memory")
        settings = devices.receivers if devices else (plain, plain)
        receivers = [Receiver(self._lines[body], each) for body, each in zip(BODIES, settings, strict=False)]
        board = SensorBoardSettings(
            transport="file:memory", hitch_counts=HITCH_COUNTS, hitch_angles=HITCH_ANGLES, pulses_per_metre=PULSES
        )
        return Navigation(receivers, frame, SensorLine(self._lines[SENSORS], board))

    def _build_wires(self, devices: DeviceSettings | None, safety: SafetySettings, bus: list[MemoryBus]) -> list[Wire]:
        """Return the gate's wires to the boards, and to the valves where there is an ISOBUS."""
        wires = [self._board_wire(body) for body in self.wires]
        if devices is not None and devices.isobus is not None:
            limit = safety.envelope.speed if devices.speed == "isobus" else None
            wires.append(isobus_wire(devices.isobus, limit, MemoryBus(bus, lambda: self.time)))
        return wires

    def _build_gate(self, safety: SafetySettings, vehicle: VehicleParameters, wires: list[Wire]) -> Gate:
        bounds = Bounds(
            wheelbase=vehicle.wheelbase,
            tractor_limit=vehicle.tractor_steering_limit,
            trailer_limit=vehicle.trailer_steering_limit,
        )
        return Gate(safety, bounds, wires, self._controller_channel, self._operators)  # type: ignore[arg-type]

    def _board_wire(self, body: str) -> Wire:
        board = SteerBoard(board=f"192.168.{5 + BODIES.index(body)}.126", max_angle=math.radians(45.0))
        tractor, trailer = (board, None) if body == "tractor" else (None, board)
        return Wire(transport=self.wires[body], tractor=tractor, trailer=trailer)

    @property
    def time(self) -> float:
        """Time of the clock, s."""
        return seconds(self.now)

    def _send(self, message: Message) -> None:
        self.links.send(self.time, "controller", encode(message), self._controller_channel.put)

    def _tell_gate(self, message: Message) -> None:
        self.links.send(self.time, "operator", encode(message), self._operators.put)

    def end(self, participant: Participant) -> None:
        """Let a process end, or the operator be gone; the gate sees the end of the controller's."""
        self.stopped.add(participant)
        self._controller_channel.gone |= participant is Participant.CONTROLLER

    def run(self, duration: float) -> Iterator[tuple[StepRecord, Truth]]:
        """Yield each step with the truth at that time, for a time, s."""
        end = self.time + duration
        while self.time < end:
            self.advance()
            records, self._records = self._records, []
            yield from records

    def ask(self, action: Action, value: float = 0.0) -> None:
        """Let the operator ask for something now."""
        self.operator.operator.ask(action, self.now, value)

    def advance(self) -> None:
        """Let a step of the clock pass."""
        self.now += STEP
        streamed, sent = self.machine.advance(self.time)
        for line, data in streamed:
            self.links.send(self.time, line if line == SENSORS else f"{line} receiver", data, self._receive(line))
        for body, output in sent:
            self._arrive(body, output.data)
        self.links.deliver(self.time)
        if Participant.RECEIVERS not in self.stopped:
            self._fixes += self._navigation.poll(self.time)
        if Participant.CONTROLLER not in self.stopped:
            self._control()
        if self.time >= self._look:
            self._look = self.time + LOOK
            self._look_around()
        if Participant.GATE not in self.stopped:
            self._run_gate()
        self._deliver()
        if self._guard.says_off(self.time):
            for body in self.wires:
                self._obey(body)(OFF)

    def _run_gate(self) -> None:
        urgent = self.gate.receive(lambda: self.time)
        if urgent or self.time >= self._due:
            self.gate.tick(self.time, max(self.time - self._ticked - self._tick - seconds(STEP), 0.0))
            self._due = next_tick(self.time, self._tick, self.time - self._ticked, urgent=urgent)
            self._ticked = self.time

    def _receive(self, line: str) -> Callable[[bytes], None]:
        return lambda data: self._lines[line].arrive(self.time, data)

    def _control(self) -> None:
        """Give the controller what it has been sent."""
        states, self._states = self._states, []
        for state in states:
            self.loop.receive_gate(state)
        fixes, self._fixes = self._fixes, []
        for each in fixes:
            self.loop.receive_fixes(each)
        if self.now >= self.loop.due:
            self.loop.pass_time(self.now)

    def _deliver(self) -> None:
        """Hand over what the gate has sent."""
        for body, wire in self.wires.items():
            frames, wire.sent = wire.sent, []
            for frame in frames:
                self.links.send(self.time, f"{body} set point", frame, self._obey(body))
        for record in self._controller_channel.outbox:
            state = decode(record, GateState)
            if isinstance(state, GateState):
                self.gate_state = state
                self._guard.receive_state(self.time, state)
                self._states.append(state)
                self.operator.see(state)
                self.machine.driver.stop_requested = bool(state.stop) and state.state is not SupervisorState.STANDBY
        self._controller_channel.outbox.clear()
        self._operators.outbox.clear()

    def _obey(self, body: str) -> Callable[[bytes], None]:
        def obey(frame: bytes) -> None:
            for _, output in self.machine.receive(self.time, body, frame, 9999):
                self._arrive(body, output.data)

        return obey

    def _arrive(self, body: str, data: bytes) -> None:
        sender = f"192.168.{5 + BODIES.index(body)}.126:8888"
        wire = self.wires[body]
        self.links.send(self.time, f"{body} board", data, lambda each: wire.arrive(self.time, each, sender))

    def _look_around(self) -> None:
        now = self.now
        if Participant.OPERATOR not in self.stopped:
            self.operator.look(now)
        state = self.gate_state.state if self.gate_state else SupervisorState.BOOT
        for participant, role in _ROLES.items():
            if participant not in self.stopped:
                heartbeat = Heartbeat(sequence=0, time=now, valid_until=now + 10**9, role=role, healthy=1, state=state)
                self._tell_gate(heartbeat)
