"""A drive of real processes over real sockets in real time, on stand-ins that this process moves.

It is what a Trial watches instead of a Rehearsal, so that the same alterations say what breaks.
"""

import signal
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, suppress
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

from drawbar.config import Configuration
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.driving.devices.path_frame import local_frame
from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.process_options import FRONT_END, GATE
from drawbar.driving.operator.requests import DemonstrationOperator, Operator
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.driving.stand_in.demonstration import with_isobus, with_stand_ins
from drawbar.driving.stand_in.device_transports import BoardLine, CanLine, DataLine, SerialLine
from drawbar.driving.stand_in.rehearsal import LOOK, STEP, Participant
from drawbar.driving.stand_in.simulated_links import SimulatedLinks
from drawbar.driving.stand_in.stand_in_machine import stand_in_machine
from drawbar.driving.stand_in.stand_in_main import PRIORITY
from drawbar.driving.stand_in.stand_ins import StandIns
from drawbar.guidance.path import Path as DrivenPath
from drawbar.machine.stand_in.board import Output
from drawbar.machine.stand_in.machine import SENSORS
from drawbar.messages import Action, GateState, Message, SupervisorState
from drawbar.messages.records import decode, encode
from drawbar.nanoseconds import seconds
from drawbar.realtime import schedule_first
from drawbar.safety.channels import LARGEST, controller_pair
from drawbar.transports.clock import MachineClock
from drawbar.transports.open import open_can

FOREIGN = "127.0.0.9"
"""address of another program that commands a board"""


class NotDrivenError(Exception):
    """A fault that this drive cannot have; says why."""


class SocketDrive:
    """A drive with those attributes of a Rehearsal that a Trial and its alterations use.

    The controller's records to the gate pass through this process, where they can be lost or spoilt.
    """

    def __init__(self, configuration: Configuration, path: DrivenPath, seed: int, run: Path) -> None:
        """Start the processes, then the machine.

        Args:
            configuration: of a case; stand-ins on this computer take the places of its devices.
            path: to drive along.
            seed: of the stand-in machine.
            run: folder of the log, which exists.

        Raises:
            HardwareError: a process did not start.
        """
        on_bus = configuration.devices is not None and configuration.devices.isobus is not None
        configuration = with_isobus(configuration) if on_bus else with_stand_ins(configuration)
        devices = configuration.devices
        (run / CONFIGURATION_NAME).write_text(configuration.to_toml(), "utf-8")
        self.links, self.now, self._look = SimulatedLinks(), 0, 0.0
        self.gate_state: GateState | None = None
        self.late, self._in_time = 0.0, False
        """by which the stand-in itself came late at most, s, once it has caught up with its start"""
        with ExitStack() as opened:
            of_controller, self._controller = controller_pair()
            self._gate, of_gate = controller_pair()
            for end in (self._controller, self._gate):
                opened.enter_context(end).setblocking(False)
            processes = DriveProcesses(configuration, run, stand_ins=False, pair=lambda: (of_controller, of_gate))
            opened.enter_context(processes)
            self.stopped = StoppedParticipants(processes)
            opened.callback(self.stopped.clear)  # what is frozen does not end
            self._processes, self._gate_socket = processes.by_name, processes.options.socket(GATE)
            self._endpoint = opened.enter_context(closing(Endpoint(processes.options.socket(FRONT_END))))
            self.operator = DemonstrationOperator(Operator(1, self._tell_gate))
            self._clock = MachineClock().from_now()
            bus = opened.enter_context(closing(open_can(devices.isobus.bus, self._clock))) if on_bus else None
            self.machine = stand_in_machine(configuration, path, local_frame(configuration), seed, bus)
            self._stand_ins = opened.enter_context(closing(StandIns(configuration, self.machine, pace=1)))
            boards = {"tractor": devices.tractor_board, "trailer": devices.trailer_board}
            listening = {body: board.listening for body, board in boards.items() if board is not None}
            self.wires = {body: opened.enter_context(closing(Foreign(place))) for body, place in listening.items()}
            self._opened = opened.pop_all()
        self._break_lines()
        schedule_first(PRIORITY)

    def _break_lines(self) -> None:
        """Let what the stand-ins send and receive pass over the links."""
        lines, boards = self._stand_ins._lines, self._stand_ins.boards
        for name in lines:
            lines[name] = BreakableLine(self, name if name == SENSORS else f"{name} receiver", lines[name])
        for body in boards:
            boards[body] = BreakableBoard(self, body, boards[body])

    def close(self) -> None:
        """End the processes and close all sockets."""
        self._opened.close()

    @property
    def time(self) -> float:
        """Time of the machine, s."""
        return seconds(self.now)

    @property
    def gate(self) -> NoReturn:
        """Raise NotDrivenError: the gate's inside is another process's."""
        raise NotDrivenError("it changes the inside of the gate, here a process of its own")

    def ask(self, action: Action, value: float = 0.0) -> None:
        """Let the operator ask for something now."""
        self.operator.operator.ask(action, time.monotonic_ns(), value)

    def end(self, participant: Participant) -> None:
        """Let a process be killed, or the operator be gone."""
        if participant is Participant.OPERATOR:
            self.stopped.add(participant)
        else:
            self._processes[participant.name.lower()].kill()

    def run(self, duration: float) -> tuple[()]:
        """Let a time pass, s; the steps are in the log."""
        end = self.now + round(1e9 * duration)
        while self.now < end:
            self.advance()
        return ()

    def advance(self) -> None:
        """Let a step of the clock pass; one that comes late is followed by the next at once."""
        self.now += STEP
        behind = self._clock() - self.time
        self._in_time |= behind < 0.0
        self.late = max(self.late, behind) if self._in_time else 0.0
        self._receive()
        while (left := self.time - self._clock()) > 0.0:
            self._clock.wait([self._endpoint, *self._ends()], left)
            self._receive()
        self._stand_ins.advance(self.time)
        self.links.deliver(self.time)
        if self.time >= self._look:
            self._look = self.time + LOOK
            if Participant.OPERATOR not in self.stopped:
                self.operator.look(time.monotonic_ns())

    def _receive(self) -> None:
        """Take in the gate's states, and pass on what controller and gate tell each other."""
        for data in self._endpoint.receive():
            state = decode(data, GateState)
            if isinstance(state, GateState):
                self.gate_state = state
                self.operator.see(state)
                self.machine.driver.stop_requested = bool(state.stop) and state.state is not SupervisorState.STANDBY
        for record in self._taken(self._controller, self._gate):
            self.links.send(self.time, "controller", record, lambda each: _offer(self._gate, each))
        for record in self._taken(self._gate, self._controller):
            _offer(self._controller, record)

    def _ends(self) -> list[socket.socket]:
        return [each for each in (self._controller, self._gate) if each.fileno() >= 0]

    def _taken(self, end: socket.socket, other: socket.socket) -> Iterator[bytes]:
        """Yield what has come to one end; where its process has ended, close both."""
        while end.fileno() >= 0:
            try:
                record = end.recv(LARGEST)
            except BlockingIOError:
                return
            except OSError:
                record = b""
            if not record:
                end.close()
                other.close()
                return
            yield record

    def _tell_gate(self, message: Message) -> None:
        self.links.send(
            self.time, "operator", encode(message), lambda each: self._endpoint.send(self._gate_socket, each)
        )


def _offer(end: socket.socket, record: bytes) -> None:
    with suppress(OSError):  # it has ended, or does not read
        end.send(record)


class StoppedParticipants(set[Participant]):
    """Parts that stand still: processes are frozen, the operator says nothing."""

    def __init__(self, processes: DriveProcesses) -> None:
        self._processes = processes.by_name

    def add(self, participant: Participant) -> None:
        """Freeze a participant that runs."""
        if participant not in self:
            self._signal(participant, signal.SIGSTOP)
        super().add(participant)

    def discard(self, participant: Participant) -> None:
        """Let a frozen participant continue."""
        if participant in self:
            self._signal(participant, signal.SIGCONT)
        super().discard(participant)

    def clear(self) -> None:
        """Let all continue."""
        for participant in list(self):
            self.discard(participant)

    def _signal(self, participant: Participant, number: signal.Signals) -> None:
        if participant is not Participant.OPERATOR:
            self._processes[participant.name.lower()].send_signal(number)


class BreakableLine:
    """A line of a receiver or the sensor board whose bytes pass over a link."""

    def __init__(self, drive: SocketDrive, link: str, line: DataLine | SerialLine | CanLine) -> None:
        self._drive, self._link, self._line = drive, link, line

    def send(self, data: bytes) -> None:
        """Send as the link's fault has it."""
        self._drive.links.send(self._drive.time, self._link, data, self._line.send)


class BreakableBoard:
    """A board's socket whose datagrams pass over two links."""

    def __init__(self, drive: SocketDrive, body: str, line: BoardLine) -> None:
        self._drive, self._body, self._line = drive, body, line
        self._came: list[tuple[bytes, int]] = []

    def send(self, output: Output) -> None:
        """Send a reply as its link's fault has it."""

        def sent(data: bytes) -> None:
            self._line.send(replace(output, data=data))

        self._drive.links.send(self._drive.time, f"{self._body} board", output.data, sent)

    def receive(self) -> list[tuple[bytes, int]]:
        """Return what has come as its link's fault has it."""
        for data, port in self._line.receive():
            self._drive.links.send(
                self._drive.time,
                f"{self._body} set point",
                data,
                lambda each, port=port: self._came.append((each, port)),
            )
        came, self._came = self._came, []
        return came


class Foreign:
    """Another computer, whose datagrams the gate hears."""

    def __init__(self, listening: tuple[str, int]) -> None:
        self._place = ("127.0.0.1", listening[1])
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind((FOREIGN, 0))

    def arrive(self, now: float, data: bytes, source: str) -> None:
        """Send a datagram to the gate; from an address of its own."""
        self._socket.sendto(data, self._place)

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()
