"""The stand-in as a program: the simulated machine behind real sockets, in real time or faster.

`python -m drawbar.driving.stand_in.stand_in_main`, its options on standard input. It serves what the configuration's
`devices` name: a receiver at `tcp://` listens there, one at `udp://` is sent to, one at `serial:` is a pseudo-terminal
of that name; a board answers at its address, and so does a caster whose address is this computer's.
"""

import math
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack, closing

from drawbar.config import Configuration, load_configuration
from drawbar.driving.devices.pace import driver_socket
from drawbar.driving.devices.path_frame import local_frame
from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.process_options import DRIVER, ProcessOptions
from drawbar.driving.processes.shutdown import ShutdownRequest, run_program
from drawbar.driving.stand_in.caster import stand_in_caster
from drawbar.driving.stand_in.device_transports import (
    BoardLine,
    CanLine,
    DataLine,
    SerialLine,
    open_data_line,
    open_line,
)
from drawbar.driving.stand_in.hand_steering import HandSteering
from drawbar.driving.stand_in.stand_in_machine import SEED, Firmware, stand_in_machine
from drawbar.errors import HardwareError
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.stand_in.board import Output
from drawbar.machine.stand_in.caster import Caster
from drawbar.machine.stand_in.driver import Driver
from drawbar.machine.stand_in.faults import FaultPlan, PlannedFault
from drawbar.machine.stand_in.machine import BARE_VALVE, BODIES, SENSORS, StandInMachine
from drawbar.message_records import decode
from drawbar.messages import GateState, SupervisorState
from drawbar.protocols.agopengps.steer_board import SET_POINT
from drawbar.protocols.rtcm import RtcmFramer
from drawbar.realtime import schedule_first
from drawbar.safety.causes import Cause
from drawbar.signals import Truth
from drawbar.simulation import build_path
from drawbar.transports.address import is_loopback
from drawbar.transports.open import open_can

PRIORITY = 30
"""of its scheduling, below gate and controller: real devices do not wait for this computer's other programs"""
_GONE = 1.0
"""without a word of who commands the steerings, s"""


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


def _tell(driver: Driver, state: GateState) -> None:
    """Tell the driver what the gate does: stand until the emergency stop was tried, and begin again after a stop."""
    rests = state.state is SupervisorState.STANDBY
    untried = Cause.EMERGENCY_UNTRIED.value in state.refusals and Cause.SHADOW.value not in state.refusals
    driver.stop_requested = (bool(state.stop) and not rests) or untried
    if rests and driver.speed == 0.0 and not driver.stop_requested:
        driver.begin_again()


def _hands_off(_: Truth) -> None:
    """Leave the wheels as they are: a wiggle test or a calibration is on, or nobody is there."""


def _driver_endpoint(options: ProcessOptions, configuration: Configuration) -> Endpoint:
    """Open what the driver is told by, where the drive looks for it.

    Raises:
        HardwareError: another stand-in of these devices runs.
    """
    assert configuration.devices is not None
    try:
        return Endpoint(
            options.socket(DRIVER) if options.stand_ins else driver_socket(configuration.devices, options.pace)
        )
    except OSError as error:
        raise HardwareError(f"another stand-in of these devices runs ({error.strerror}); end it") from None


def main() -> int:
    """Be the machine of the options on standard input."""
    return serve(ProcessOptions.model_validate_json(sys.stdin.read()))


def serve(
    options: ProcessOptions,
    faults: Sequence[PlannedFault] = (),
    tell: Callable[[str], None] = lambda words: None,
    firmware: Firmware = Firmware.AIO_V4,
    ready: Callable[[], None] = lambda: None,
) -> int:
    """Be the machine until told to end; return an exit code.

    Args:
        options: what is stood in for.
        faults: of the machine.
        tell: is given what happens when one begins.
        firmware: of all boards.
        ready: is called once all devices are there.

    Raises:
        ConfigurationError: the machine does not have the device that one is a fault of.
    """
    configuration = load_configuration(options.configuration)
    path, _ = build_path(configuration)
    devices, clock = configuration.devices, options.clock.from_now()
    assert devices is not None
    with ExitStack() as opened:
        bus = opened.enter_context(closing(open_can(devices.isobus.bus, clock))) if devices.isobus else None
        machine = stand_in_machine(configuration, path, local_frame(configuration), SEED, bus, firmware)
        machine.driver.wait = Driver.WAIT if options.stand_ins else Driver.WAIT_UNTOLD
        plan, hand = FaultPlan(faults, machine, devices), HandSteering(path, configuration.vehicle)
        try:
            endpoint = opened.enter_context(closing(_driver_endpoint(options, configuration)))
            stand_ins = opened.enter_context(closing(StandIns(configuration, machine, options.pace)))
        except HardwareError as error:
            print(f"stand-in: {error}", file=sys.stderr)
            return 2
        shutdown, seen = ShutdownRequest(), -math.inf
        ready()
        schedule_first(PRIORITY)
        while not shutdown.asked:
            for data in endpoint.receive():
                state = decode(data, GateState)
                if isinstance(state, GateState):
                    _tell(machine.driver, state)
                    hand.choose(state.line * configuration.path.working_width + state.nudge)
                    seen = clock()
            now = clock()
            machine.by_hand = hand if now - seen < _GONE else _hands_off
            machine.driver.attend(now, attended=now - max(seen, stand_ins.commanded) < _GONE)
            stand_ins.advance(now)
            for words in plan.look():
                tell(words)
            descriptors = [endpoint.fileno(), *(line.fileno() for line in stand_ins.boards.values())]
            clock.wait(descriptors, min(machine.next_time - clock(), 0.05))
    return 0


if __name__ == "__main__":
    sys.exit(run_program(main))
