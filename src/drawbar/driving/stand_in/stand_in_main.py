"""The stand-in as a program: the simulated machine behind real sockets, in real time or faster.

`python -m drawbar.driving.stand_in.stand_in_main`, its options on standard input.
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
from drawbar.driving.stand_in.hand_steering import HandSteering
from drawbar.driving.stand_in.stand_in_machine import SEED, Firmware, stand_in_machine
from drawbar.driving.stand_in.stand_ins import StandIns
from drawbar.errors import HardwareError
from drawbar.machine.stand_in.driver import Driver
from drawbar.machine.stand_in.fault_plan import FaultPlan, PlannedFault
from drawbar.machine.stand_in.machine import StandInMachine
from drawbar.messages import GateState, SupervisorState
from drawbar.messages.records import decode
from drawbar.realtime import schedule_first
from drawbar.safety.causes import Cause
from drawbar.signals import Truth
from drawbar.simulation import build_path
from drawbar.transports.clock import MachineClock
from drawbar.transports.open import open_can

PRIORITY = 30
"""of its scheduling, below gate and controller: real devices do not wait for this computer's other programs"""
_GONE = 1.0
"""without a message of who commands the steerings, s"""


class _DriversSeat:
    """The driver's seat: receives what the gate does, and turns the wheels by hand."""

    def __init__(self, endpoint: Endpoint, machine: StandInMachine, hand: HandSteering, working_width: float) -> None:
        self._endpoint, self._machine, self._hand, self._working_width = endpoint, machine, hand, working_width
        self._heard = -math.inf

    def listen(self, clock: MachineClock) -> None:
        """Take the states that the gate has sent."""
        for data in self._endpoint.receive():
            state = decode(data, GateState)
            if isinstance(state, GateState):
                _tell(self._machine.driver, state)
                self._hand.choose(state.line * self._working_width + state.nudge)
                self._heard = clock()

    def attend(self, now: float, commanded: float) -> None:
        """Turn the wheels by hand while the gate sends; drive while it does, or the steerings are commanded.

        Args:
            now: s.
            commanded: when the steerings were commanded last, s.
        """
        machine = self._machine
        machine.by_hand = self._hand if now - self._heard < _GONE else _hands_off
        machine.driver.attend(now, attended=now - max(self._heard, commanded) < _GONE)


def _tell(driver: Driver, state: GateState) -> None:
    """Pass the gate's state to the driver: stand until the emergency stop was tried, and begin again after a stop."""
    rests = state.state is SupervisorState.STANDBY
    untried = Cause.EMERGENCY_UNTRIED.value in state.refusals and Cause.SHADOW.value not in state.refusals
    driver.stop_requested = (bool(state.stop) and not rests) or untried
    if rests and driver.speed == 0.0 and not driver.stop_requested:
        driver.begin_again()


def _hands_off(_: Truth) -> None:
    """Leave the wheels as they are: a wiggle test or a calibration is on, or nobody is there."""


def _driver_endpoint(options: ProcessOptions, configuration: Configuration) -> Endpoint:
    """Open the socket on which the driver receives, where the drive looks for it.

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
    return serve(ProcessOptions.model_validate_json(sys.stdin.buffer.read()))


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
        plan = FaultPlan(faults, machine, devices)
        try:
            endpoint = opened.enter_context(closing(_driver_endpoint(options, configuration)))
            stand_ins = opened.enter_context(closing(StandIns(configuration, machine, options.pace)))
        except HardwareError as error:
            print(f"stand-in: {error}", file=sys.stderr)
            return 2
        shutdown = ShutdownRequest()
        seat = _DriversSeat(
            endpoint, machine, HandSteering(path, configuration.vehicle), configuration.path.working_width
        )
        ready()
        schedule_first(PRIORITY)
        while not shutdown.asked:
            seat.listen(clock)
            now = clock()
            seat.attend(now, stand_ins.commanded)
            stand_ins.advance(now)
            for words in plan.look():
                tell(words)
            descriptors = [endpoint.fileno(), *(line.fileno() for line in stand_ins.boards.values())]
            clock.wait(descriptors, min(machine.next_time - clock(), 0.05))
    return 0


if __name__ == "__main__":
    sys.exit(run_program(main))
