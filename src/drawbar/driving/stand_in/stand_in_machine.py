"""Stand-in machine: the simulated machine of a configuration behind receivers and boards, without wires."""

import math
from enum import Enum
from functools import partial

from drawbar.config import Configuration
from drawbar.driving.loop.field_fence import build_fence
from drawbar.geometry import LocalFrame
from drawbar.guidance.path import Path
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.receiver import ReceiverSettings
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.machine.stand_in.aio_26 import Aio26
from drawbar.machine.stand_in.aio_v4 import AioV4
from drawbar.machine.stand_in.bare_valve import StandInBareValve
from drawbar.machine.stand_in.board import StandInBoard
from drawbar.machine.stand_in.can_machine import CanMachine
from drawbar.machine.stand_in.driver import Driver
from drawbar.machine.stand_in.machine import StandInDevices, StandInMachine, StandInSettings
from drawbar.machine.stand_in.nmea import gga, gst, hrp, panda, paogi, vtg
from drawbar.machine.stand_in.nmea2000 import nmea2000
from drawbar.machine.stand_in.receiver import Encoder, Report, turned
from drawbar.machine.stand_in.wheel import HeldWheel
from drawbar.machine.stand_in.world import TICK, World
from drawbar.simulation import build_machine
from drawbar.transports.base import CanBus
from drawbar.vehicle.parameters import BODIES

SEED = 0
"""of stand-ins that are programs"""


class Firmware(Enum):
    """Of the steer boards that are stood in for."""

    AIO_V4 = "aio-v4"
    AIO_26 = "aio-26"


def stand_in_machine(
    configuration: Configuration,
    path: Path,
    frame: LocalFrame,
    seed: int,
    bus: CanBus | None = None,
    firmware: Firmware = Firmware.AIO_V4,
) -> StandInMachine:
    """Return the configuration's simulated machine behind the devices that it names, receivers and boards by default.

    Args:
        configuration: of the run.
        path: where its start is, or where the path comes into the field.
        frame: of the path.
        seed: of everything random.
        bus: its end of the ISOBUS, where the devices name one.
        firmware: of all boards.
    """
    fence, start, devices = build_fence(configuration), configuration.start, configuration.devices
    ahead = start.ahead if fence is None else max(start.ahead, fence.entry(path))
    changes = {"sample_time": TICK, "start": start.model_copy(update={"ahead": ahead})}
    ticking = _with_yaw(configuration).model_copy(update=changes)
    boards: dict[str, tuple[StandInBoard, HeldWheel]] = {}
    encoders: dict[str, Encoder] = {}
    for index, body in enumerate(BODIES):
        receiver = getattr(devices, f"{body}_receiver") if devices else ReceiverSettings(transport="file:memory")
        encoders[body] = _encoder(receiver, devices, index)
        settings = getattr(devices, f"{body}_board") if devices else None
        if devices is None or settings is not None:
            wheel = HeldWheel()
            boards[body] = (_board(firmware, wheel, f"192.168.{5 + index}", settings), wheel)
    isobus = devices.isobus if devices is not None else None
    can = None
    if isobus is not None and devices is not None:
        assert bus is not None
        can = CanMachine(bus, isobus, takes_speed=devices.speed == "isobus")
    bare = devices.bare_valve if devices is not None else None
    valve = StandInBareValve(bare) if bare is not None else None
    return StandInMachine(
        World(build_machine(ticking, path, seed), configuration.vehicle),
        frame,
        StandInDevices(boards=boards, encoders=encoders, can=can, valve=valve),
        driver=Driver(configuration.speed),
        settings=StandInSettings(epochs=configuration.sample_time),
        seed=seed,
    )


def _with_yaw(configuration: Configuration) -> Configuration:
    """Return the configuration, with two antennas on a tractor whose receiver is the only one."""
    if configuration.has_trailer_receiver:
        return configuration
    machine = configuration.machine
    yaw = machine.attitude.yaw.model_copy(update={"present": True})
    attitude = machine.attitude.model_copy(update={"yaw": yaw})
    return configuration.model_copy(update={"machine": machine.model_copy(update={"attitude": attitude})})


def _encoder(receiver: ReceiverSettings | None, devices: DeviceSettings | None, index: int) -> Encoder:
    if receiver is None:
        return _silent
    line = receiver.antennas.line
    if receiver.is_on_can:
        return nmea2000(int(receiver.sender or 0x20 + index), line)
    on_board = devices is not None and receiver in devices.receivers_on_boards
    return _on_board if on_board else partial(_nmea, line=line)


def _board(firmware: Firmware, wheel: HeldWheel, subnet: str, settings: SteerBoardSettings | None) -> StandInBoard:
    if firmware is Firmware.AIO_V4:
        return AioV4(wheel, subnet=subnet)
    board = Aio26(wheel, subnet=subnet)
    board.computer_port = settings.listening[1] if settings else board.computer_port
    return board


def _on_board(report: Report) -> list[bytes]:
    return [panda(report) if math.isnan(report.yaw) else paogi(report)]


def _nmea(report: Report, *, line: float) -> list[bytes]:
    inertial = [panda(report)] if math.isfinite(report.inertial_yaw) else []
    heading = [hrp(turned(report, line))] if math.isfinite(report.yaw) else []
    return [gga(report), vtg(report), gst(report), *heading, *inertial]


def _silent(_: Report) -> list[bytes]:
    return []
