"""IMU board: relative heading and roll (211), and that it is gone (212)."""

import math
import struct
from dataclasses import dataclass

from drawbar.protocols.agopengps.frame import Frame, Pgn

_TENTHS = math.degrees(1.0) * 10.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ImuReading:
    """One reading (211)."""

    yaw: float
    """rad, counter-clockwise, [-π, π], from an arbitrary zero that drifts: use differences only"""
    roll: float
    """rad, right side down positive"""
    gyro: int
    """as sent; the published board sends 0"""


def decode_imu(frame: Frame) -> ImuReading | None:
    """Return one reading; None: not such a message."""
    if frame.pgn != Pgn.IMU or len(frame.data) < 6:
        return None
    heading, roll, gyro = struct.unpack("<hhh", frame.data[:6])
    return ImuReading(yaw=math.remainder(math.pi / 2.0 - heading / _TENTHS, math.tau), roll=roll / _TENTHS, gyro=gyro)


def decode_imu_gone(frame: Frame) -> bool:
    """Return whether the message says that the IMU is gone (212)."""
    return frame.pgn == Pgn.IMU_GONE and frame.data[:1] == b"\x01"
