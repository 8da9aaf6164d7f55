"""Demonstration: the devices of a configuration that names none, all of them stand-ins on this computer."""

import math
import socket

from drawbar.config import Configuration
from drawbar.errors import ConfigurationError
from drawbar.machine.hardware.bare_valve_settings import BareValveSettings
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.receiver import ReceiverSettings
from drawbar.machine.hardware.sensor_line import SensorBoardSettings
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.machine.stand_in.machine import HITCH_ANGLES, HITCH_COUNTS, PULSES
from drawbar.protocols.agopengps.board_replies import LARGEST_ANGLE
from drawbar.protocols.gnss.settings import AntennaSettings

_GROUP = "239.74.163.2"
"""of multicast datagrams, which do not leave this computer"""


def with_stand_ins(configuration: Configuration) -> Configuration:
    """Return the configuration with two receivers on TCP and two boards on UDP, all at free ports of 127.0.0.1.

    A bare valve of the front wheels is there too, where the tractor's yaw rate is measured: it is not pushed without.

    Raises:
        ConfigurationError: the vehicle steers farther than a board may.
    """
    vehicle = configuration.vehicle
    streams = free_ports(socket.SOCK_STREAM, 4)
    receivers = [ReceiverSettings(transport=f"tcp://127.0.0.1:{port}") for port in streams[:2]]
    ports = free_ports(socket.SOCK_DGRAM, 4)
    limits = [_board_limit(body, getattr(vehicle, f"{body}_steering_limit")) for body in ("tractor", "trailer")]
    boards = [
        SteerBoardSettings(address=f"127.0.0.1:{board}", listen=f"127.0.0.1:{listen}", max_angle=limit)
        for board, listen, limit in zip(ports[:2], ports[2:], limits, strict=True)
    ]
    devices = DeviceSettings(
        tractor_receiver=receivers[0],
        trailer_receiver=receivers[1],
        tractor_board=boards[0],
        trailer_board=boards[1],
        sensors=_sensor_board(streams[2]),
    )
    if configuration.machine.attitude.tractor.present:
        valve = BareValveSettings(transport=f"tcp://127.0.0.1:{streams[3]}", counts=HITCH_COUNTS, angles=HITCH_ANGLES)
        devices = devices.model_copy(update={"bare_valve": valve})
    return _of_stand_ins(configuration, devices)


def with_isobus(configuration: Configuration) -> Configuration:
    """Return the configuration with NMEA 2000 receivers and ISOBUS valves on buses of this computer, a sensor board.

    The tractor takes its speed from the bus. CAN frames go as datagrams of python-can's `udp_multicast`.
    """
    vehicle = configuration.vehicle
    positions, implements = (f"can:udp_multicast:{_GROUP}:{port}" for port in free_ports(socket.SOCK_DGRAM, 2))
    end = vehicle.trailer_steering_limit
    tractor = {"wheelbase": vehicle.wheelbase, "address": 38, "rate": 20.0}
    trailer = {"curvature": [(-end, -end), (end, end)], "address": 39, "rate": 20.0}
    devices = DeviceSettings.model_validate(
        {
            "tractor_receiver": {"transport": positions, "sender": "32"},
            "trailer_receiver": {"transport": positions, "sender": "33"},
            "isobus": {"bus": implements, "name": {"identity": 7}, "tractor_valve": tractor, "trailer_valve": trailer},
            "speed": "isobus",
            "sensors": _sensor_board(*free_ports(socket.SOCK_STREAM, 1)),
        }
    )
    return _of_stand_ins(configuration, devices)


def with_one_receiver(configuration: Configuration) -> Configuration:
    """Return a configuration of stand-ins with the tractor's receiver alone, which has two antennas."""
    devices = configuration.devices
    assert devices is not None
    antennas = AntennaSettings(baseline=1.0)
    tractor = devices.tractor_receiver.model_copy(update={"antennas": antennas})
    alone = devices.model_copy(update={"tractor_receiver": tractor, "trailer_receiver": None})
    return configuration.model_copy(update={"devices": alone})


def _sensor_board(port: int) -> SensorBoardSettings:
    return SensorBoardSettings(
        transport=f"tcp://127.0.0.1:{port}",
        hitch_counts=HITCH_COUNTS,
        hitch_angles=HITCH_ANGLES,
        pulses_per_metre=PULSES,
    )


def _of_stand_ins(configuration: Configuration, devices: DeviceSettings) -> Configuration:
    """Return the configuration with devices that need no wiggle test: stand-ins turn the right way."""
    engage = configuration.safety.engage.model_copy(update={"wiggle_test": False})
    safety = configuration.safety.model_copy(update={"engage": engage})
    return configuration.model_copy(update={"devices": devices, "safety": safety})


def _board_limit(body: str, limit: float) -> float:
    """Return the largest angle of a stand-in board.

    Raises:
        ConfigurationError: no board accepts so large an angle.
    """
    if limit >= LARGEST_ANGLE:
        raise ConfigurationError(
            f"vehicle.{body}_steering_limit = {limit:g} rad: the stand-in of the {body}'s board takes angles below "
            f"{LARGEST_ANGLE:.4g} rad ({math.degrees(LARGEST_ANGLE):g}°); give a smaller one, or drive in simulation "
            "with `drawbar run`"
        )
    return limit


def without_stand_ins(configuration: Configuration) -> Configuration:
    """Return what is kept of such a configuration for another drive: no devices, and the wiggle test is asked for."""
    engage = configuration.safety.engage.model_copy(update={"wiggle_test": True})
    safety = configuration.safety.model_copy(update={"engage": engage})
    return configuration.model_copy(update={"devices": None, "safety": safety})


def free_ports(kind: int, count: int) -> list[int]:
    """Return ports of 127.0.0.1 that nobody uses now."""
    sockets = [socket.socket(socket.AF_INET, kind) for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [int(each.getsockname()[1]) for each in sockets]
    for each in sockets:
        each.close()
    return ports
