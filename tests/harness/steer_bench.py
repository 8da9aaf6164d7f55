"""Steer bench: the adapter of a steer board and a stand-in of it, joined by lossy wires, with an injected clock."""

import math
from dataclasses import dataclass, field

from drawbar.machine.stand_in.aio_26 import Aio26
from drawbar.machine.stand_in.aio_v4 import AioV4
from drawbar.machine.stand_in.board import Output, StandInBoard
from drawbar.machine.stand_in.wheel import HeldWheel, Wheel
from drawbar.protocols.actuator import Readiness, SteeringReport, SteeringRequest
from drawbar.protocols.agopengps.frame import Frame, Pgn, parse
from drawbar.protocols.agopengps.steer_board import SteerBoard
from drawbar.protocols.agopengps.steering import SteerCommand, decode_steer

HOST = "192.168.5.126:8888"
BOARDS: dict[str, type[StandInBoard]] = {"v4": AioV4, "v26": Aio26}


@dataclass
class Bench:
    """Calls the adapter `rate` times a second and carries its datagrams, 1 ms under way, to the stand-in and back."""

    firmware: str = "v4"
    rate: float = 20.0
    wheel: Wheel = field(default_factory=HeldWheel)
    start: float = 100.0

    def __post_init__(self) -> None:
        self.time = self.start
        self.ask(steer=False)
        self.board = BOARDS[self.firmware](self.wheel, start=self.start)
        self.adapter = SteerBoard(board="192.168.5.126", max_angle=math.radians(35.0), own=("192.168.5.10:9999",))
        self.replies_pass = self.set_points_pass = True
        self.sent: list[tuple[float, SteerCommand]] = []
        self.driven: list[tuple[float, bool]] = []
        self.ticks = 0

    def tick(self) -> None:
        """One call of the gate."""
        self.time = self.start + self.ticks / self.rate
        self.ticks += 1
        self.carry(self.board.advance(self.time))
        for datagram in self.adapter.send(self.time, self.request):
            frame = parse(datagram)
            assert isinstance(frame, Frame)
            command = decode_steer(frame)
            if command is not None:
                assert command[1] in (0, 1)
                self.sent.append((self.time, command[0]))
            else:
                assert frame.pgn == Pgn.HELLO
            if self.set_points_pass:
                self.carry(self.board.receive(self.time + 0.001, datagram))
        self.carry(self.board.advance(self.time + min(0.026, 0.9 / self.rate)))
        self.driven.append((self.time, self.board.driving))

    def carry(self, outputs: list[Output]) -> None:
        for output in outputs:
            if self.replies_pass:
                self.adapter.receive(output.time + 0.001, output.data, HOST)

    def run(self, duration: float) -> None:
        end = self.time + duration
        while self.time < end - 1e-9:
            self.tick()

    def ask(self, *, steer: bool, angle: float = 0.1, speed: float = 1.0) -> None:
        self.request = SteeringRequest(steer=steer, angle=angle, speed=speed)

    def engage(self) -> None:
        """Come to a board that steers."""
        self.run(2.5)
        assert self.report.readiness is Readiness.READY
        self.ask(steer=True)
        self.run(1.0)
        assert self.report.engaged
        assert self.board.driving

    @property
    def report(self) -> SteeringReport:
        return self.adapter.report(self.time)

    def ones_after(self, time: float) -> int:
        """How many frames with status 1 were sent after `time`."""
        return sum(command.steer for when, command in self.sent if when > time)
