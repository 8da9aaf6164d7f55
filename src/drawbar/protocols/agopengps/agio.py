"""AgIO: what drawbar sends in its place to an AgOpenGPS on the same computer (214), and where.

AgOpenGPS listens on 127.0.0.1:15555 and sends to 127.255.255.255:17777. On Linux only a socket bound to 0.0.0.0:17777
hears that. It drops positions that come less than 70 ms after the one before. While AgOpenGPS steers a board, its set
points arrive at 17777 too (`steering.decode_steer`), and drawbar sends that board none of its own.
"""

import math
import struct
from dataclasses import dataclass

from drawbar.errors import HardwareError
from drawbar.protocols.agopengps.frame import AGIO, Pgn, byte, pack, scaled

AGOPENGPS_PORT = 15555
AGIO_PORT = 17777
SHORTEST_PERIOD = 0.07
"""between two positions, s"""

_NO_FLOAT: float = struct.unpack("<f", b"\xff\xff\x7f\x7f")[0]
_LARGEST = 1e9
"""far above anything measured, and below what AgOpenGPS takes for not measured"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Position:
    """One position for AgOpenGPS; None: not measured."""

    longitude: float
    """WGS84, degrees: the wire's own unit of measure, which loses nothing"""
    latitude: float
    """WGS84, degrees"""
    fix: int
    """quality as in NMEA's GGA"""
    speed: float | None = None
    """m/s"""
    altitude: float | None = None
    """m"""
    dual_yaw: float | None = None
    """of a pair of antennas, rad, counter-clockwise from east"""
    course: float | None = None
    """of one antenna, rad, counter-clockwise from east"""
    roll: float | None = None
    """of a pair of antennas, rad, right side down positive"""
    satellites: int | None = None
    hdop: float | None = None
    age: float | None = None
    """of corrections, s"""
    imu_yaw: float | None = None
    """rad, counter-clockwise from east"""
    imu_roll: float | None = None
    """rad, right side down positive"""
    imu_pitch: int | None = None
    """as an IMU board sends it"""
    imu_yaw_rate: int | None = None
    """as an IMU board sends it"""

    def encode(self) -> bytes:
        """Return the datagram; raises HardwareError when a number is not finite or does not fit the wire."""
        _within("longitude, degrees,", self.longitude, 180.0)
        _within("latitude, degrees,", self.latitude, 90.0)
        data = struct.pack("<2d5f", self.longitude, self.latitude, *self._floats())
        data += struct.pack(
            "<HBHHHhhh",
            _or(0xFFFF, "satellites", self.satellites, 1.0, 0),
            byte("fix", self.fix, 0, 9),
            _or(0xFFFF, "HDOP", self.hdop, 100.0, 0),
            _or(0xFFFF, "age of corrections, s,", self.age, 100.0, 0),
            _imu_heading(self.imu_yaw),
            _or(0x7FFF, "roll of the IMU, degrees,", _degrees(self.imu_roll), 10.0, -0x7FFF),
            _or(0x7FFF, "pitch of the IMU", self.imu_pitch, 1.0, -0x7FFF),
            _or(0x7FFF, "yaw rate of the IMU", self.imu_yaw_rate, 1.0, -0x7FFF),
        )
        return pack(AGIO, Pgn.POSITION, data)

    def _floats(self) -> tuple[float, ...]:
        return (
            _float("dual_yaw", None if self.dual_yaw is None else _heading(self.dual_yaw)),
            _float("course", None if self.course is None else _heading(self.course)),
            _float("speed", None if self.speed is None else abs(self.speed) * 3.6),
            _float("roll", _degrees(self.roll)),
            _float("altitude", self.altitude),
        )


def _or(missing: int, name: str, value: float | None, scale: float, lowest: int) -> int:
    return missing if value is None else scaled(name, value, scale, lowest, missing - 1)


def _float(name: str, value: float | None) -> float:
    if value is None:
        return _NO_FLOAT
    _within(name, value, _LARGEST)
    return value


def _within(name: str, value: float, limit: float) -> None:
    if not abs(value) <= limit:
        raise HardwareError(f"{name} is {value}; a frame holds {-limit:g} to {limit:g}; check what measured it")


def _imu_heading(yaw: float | None) -> int:
    if yaw is None:
        return 0xFFFF
    return scaled("yaw of the IMU, rad,", _heading(yaw), 10.0, 0, 3600) % 3600


def _degrees(angle: float | None) -> float | None:
    return None if angle is None else math.degrees(angle)


def _heading(yaw: float) -> float:
    """Return the heading in degrees clockwise from north, [0, 360), NaN where yaw is not finite."""
    return math.degrees(math.pi / 2.0 - yaw) % 360.0 if math.isfinite(yaw) else math.nan
