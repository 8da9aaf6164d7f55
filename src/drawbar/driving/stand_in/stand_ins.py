"""Stand-ins: the devices of a configuration behind their sockets, all of them simulated.

A receiver at `tcp://` listens there, one at `udp://` is sent to, one at `serial:` is a pseudo-terminal of that name; a
board answers at its address, and so does a caster whose address is this computer's.
"""

import math
from contextlib import ExitStack, closing

from drawbar.config import Configuration
from drawbar.driving.stand_in.caster import stand_in_caster
from drawbar.driving.stand_in.device_transports import (
    BoardLine,
    CanLine,
    DataLine,
    SerialLine,
    open_data_line,
    open_line,
)
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.stand_in.board import Output
from drawbar.machine.stand_in.caster import Caster
from drawbar.machine.stand_in.machine import BARE_VALVE, SENSORS, StandInMachine
from drawbar.protocols.agopengps.steer_board import SET_POINT
from drawbar.protocols.rtcm import RtcmFramer
from drawbar.transports.address import is_loopback
from drawbar.vehicle.parameters import BODIES


class StandIns:
    """All stand-in devices of a configuration behind their sockets."""

    def __init__(self, configuration: Configuration, machine: StandInMachine, pace: int) -> None:
        """Open the sockets.

        Raises:
            HardwareError: one of them cannot be opened.
        """
        devices = configuration.devices
        assert devices is not None
        self._machine = machine
        receivers = {"tractor": devices.tractor_receiver, "trailer": devices.trailer_receiver}
        lines = {body: (each.transport, each.sender) for body, each in receivers.items() if each is not None}
        lines |= {SENSORS: (devices.sensors.transport, "")} if devices.sensors else {}
        boards = {"tractor": devices.tractor_board, "trailer": devices.trailer_board}
        self._corrected: dict[str, tuple[DataLine | SerialLine, RtcmFramer]] = {}
        self._caster: Caster | None = None
        with ExitStack() as opened:
            self._lines = {name: opened.enter_context(closing(open_line(*each))) for name, each in lines.items()}
            self.boards = {
                body: opened.enter_context(closing(BoardLine(settings)))
                for body, settings in boards.items()
                if settings is not None
            }
            self._valve = None
            if devices.bare_valve is not None:
                self._valve = opened.enter_context(closing(open_data_line(devices.bare_valve.transport)))
                self._lines[BARE_VALVE] = self._valve
            if devices.corrections is not None:
                self._correct(devices.corrections, pace)
            self._opened = opened.pop_all()
        self._commanded = dict.fromkeys(self.boards, -math.inf)

    @property
    def commanded(self) -> float:
        """When all steerings have been commanded last, even if only not to steer, s."""
        valves = self._machine.can.valves.values() if self._machine.can else ()
        return min([*self._commanded.values(), *(valve.last_received for valve in valves)])

    def _correct(self, settings: CorrectionsSettings, pace: int) -> None:
        """Let the receivers that can be sent corrections need them, and be the caster where it is to be here."""
        for body in BODIES:
            line = self._lines.get(body)
            if line is not None and not isinstance(line, CanLine) and line.is_writable:
                self._corrected[body] = (line, RtcmFramer())
                self._machine.corrected[body] = -math.inf
        if is_loopback(settings.host):
            self._caster = stand_in_caster(settings, pace)

    def advance(self, now: float) -> None:
        """Do everything up to a time, s since the start."""
        for body, line in self.boards.items():
            for data, port in line.receive():
                if data.startswith(SET_POINT):
                    self._commanded[body] = now
                self._send(self._machine.receive(now, body, data, port))
        if self._valve is not None and self._machine.valve is not None:
            self._machine.valve.receive(now, self._valve.receive())
        for body, (receiver, framer) in self._corrected.items():
            if framer.feed(receiver.receive()):
                self._machine.corrected[body] = now
        streamed, sent = self._machine.advance(now)
        for name, data in streamed:
            if name in self._lines:
                self._lines[name].send(data)
        self._send(sent)

    def _send(self, outputs: list[tuple[str, Output]]) -> None:
        for body, output in outputs:
            self.boards[body].send(output)

    def close(self) -> None:
        """Close all sockets."""
        self._opened.close()
        if self._caster is not None:
            self._caster.stop()
