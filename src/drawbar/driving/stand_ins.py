"""Stand-ins of all devices of a configuration: the simulated machine behind receivers and boards, without wires."""

from drawbar.config import Configuration
from drawbar.geometry import LocalFrame
from drawbar.guidance.path import Path
from drawbar.machine.stand_in.aio_v4 import AioV4
from drawbar.machine.stand_in.board import StandInBoard
from drawbar.machine.stand_in.machine import BODIES, Driver, StandInMachine, StandInSettings
from drawbar.machine.stand_in.nmea import gga, gst, vtg
from drawbar.machine.stand_in.receiver import Report
from drawbar.machine.stand_in.wheel import HeldWheel
from drawbar.machine.stand_in.world import TICK, World
from drawbar.simulation import build_machine


def stand_in_machine(configuration: Configuration, path: Path, frame: LocalFrame, seed: int) -> StandInMachine:
    """Return the configuration's simulated machine behind two NMEA receivers and two AIO v4 boards.

    Args:
        configuration: of the run.
        path: where its start is.
        frame: of the path.
        seed: of everything random.
    """
    ticking = configuration.model_copy(update={"sample_time": TICK})
    boards: dict[str, tuple[StandInBoard, HeldWheel]] = {}
    for index, body in enumerate(BODIES):
        wheel = HeldWheel()
        boards[body] = (AioV4(wheel, subnet=f"192.168.{5 + index}"), wheel)
    return StandInMachine(
        World(build_machine(ticking, path, seed), configuration.vehicle),
        frame,
        boards,
        dict.fromkeys(BODIES, _nmea),
        Driver(configuration.speed),
        StandInSettings(epochs=configuration.sample_time),
        seed,
    )


def _nmea(report: Report) -> list[bytes]:
    return [gga(report), vtg(report), gst(report)]
