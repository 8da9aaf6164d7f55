"""A guidance valve on a bench: a clock, a valve's information, and everything the valve's actuator puts on the wire."""

from dataclasses import replace

from drawbar.protocols.actuator import SteeringRequest
from drawbar.protocols.isobus.address import AddressClaim
from drawbar.protocols.isobus.curvature import WheelbaseCurvature
from drawbar.protocols.isobus.guidance import GuidanceValve
from drawbar.protocols.isobus.guidance_messages import (
    MACHINE_INFO,
    SYSTEM_COMMAND,
    ExitReason,
    Intention,
    MachineInfo,
    decode_command,
    encode_machine_info,
)
from drawbar.protocols.isobus.identifier import Message, decode, encode
from drawbar.protocols.isobus.name import Name
from drawbar.protocols.isobus.node import IsobusNode
from drawbar.transports.base import CanFrame

TICK = 0.02
OWN = 0x90
VALVE = 0x26
NAME = Name(identity=100, manufacturer=1407, function=29, device_class=1)
GOOD = MachineInfo(
    curvature=0.1, locked_out=False, ready=True, in_position=True, reset_required=False, limit=0, exit_reason=0
)
WHEELBASE = 1.4
PASSING = [ExitReason.OPERATOR_PRESENCE, ExitReason.OPERATOR_OVERRIDE, ExitReason.COMMAND_TIMEOUT, ExitReason.TOO_FAST]
"""reasons that are over once the valve says that it is ready"""


class Bench:
    """One actuator, ticked every 20 ms; `info` comes from the valve every 100 ms, None: nothing comes."""

    def __init__(self, *, address: int | None = None, period: float = 0.1, name: Name = NAME) -> None:
        self.time = 0.0
        self.info: MachineInfo | None = GOOD
        self.node = IsobusNode(AddressClaim(name, OWN))
        self.valve = GuidanceValve(self.node, WheelbaseCurvature(WHEELBASE), address=address, period=period)
        self.sent: list[tuple[float, Message]] = []
        self._tick = 0

    def receive(self, pgn: int, data: bytes, source: int = VALVE, **identifier: int) -> None:
        """Let a message of somebody else arrive now."""
        self.valve.receive(self.time, encode(Message(pgn=pgn, source=source, data=data, **identifier)))

    def tell(self, source: int = VALVE, **changes: object) -> None:
        """Let one message of the valve arrive now that differs from `GOOD`."""
        self.receive(MACHINE_INFO, encode_machine_info(replace(GOOD, **changes)), source)

    def tick(self, steer: bool = False, angle: float = 0.1) -> list[Message]:
        """Let one tick pass; return what went out in it."""
        if self.info is not None and self._tick % 5 == 0:
            self.receive(MACHINE_INFO, encode_machine_info(self.info))
        sent = [decode(frame) for frame in self.valve.send(self.time, self.request(steer, angle))]
        out = [message for message in sent if message is not None]
        self.sent += [(self.time, message) for message in out]
        self._tick += 1
        self.time = self._tick * TICK
        return out

    def run(self, seconds: float, steer: bool = False, angle: float = 0.1) -> list[tuple[float, Intention]]:
        """Let time pass; return the commands that went out, each with its time."""
        begun = len(self.sent)
        for _ in range(round(seconds / TICK)):
            self.tick(steer, angle)
        return [(time, intention(message)) for time, message in self.sent[begun:] if message.pgn == SYSTEM_COMMAND]

    def engage(self) -> "Bench":
        """Claim, settle, and steer."""
        self.run(2.0)
        assert {what for _, what in self.run(0.5, steer=True)} == {Intention.INTENDED}
        assert self.valve.report(self.time).engaged
        return self

    def request(self, steer: bool, angle: float = 0.1) -> SteeringRequest:
        return SteeringRequest(steer=steer, angle=angle, speed=1.0)

    def feed(self, frame: CanFrame) -> None:
        self.valve.receive(self.time, frame)


def intention(message: Message) -> Intention:
    """Return what a command says."""
    command = decode_command(message.data)
    assert command is not None
    return command.intention
