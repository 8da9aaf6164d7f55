"""Fixes: what the receivers and sensors report for one instant."""

import math
from dataclasses import dataclass

from drawbar.messages.base import Message
from drawbar.messages.fields import Byte, Known, Time


@dataclass(frozen=True, slots=True, kw_only=True)
class ReceiverReport:
    """What the receiver of one body reports for one instant; a silent one, or none, has no fix, and NaN."""

    heard: Byte = 1
    """0: it reports nothing for this instant, or there is none"""
    x: Known
    """of the antenna, east in the frame of the path, m"""
    y: Known
    """of the antenna, north in the frame of the path, m"""
    deviation: Known
    """standard deviation of each coordinate, m"""
    quality: Byte
    """FixQuality of statuses.py, debounced"""
    speed: Known
    """over ground, m/s, never negative"""
    course: Known
    """yaw of the velocity, rad"""
    roll: Known
    """right side down positive, rad"""
    pitch: Known
    """nose up positive, rad"""
    yaw: Known = math.nan
    """of the body, by two antennas on it, rad; the trailer's is recorded, but not used"""
    yaw_rate: Known = math.nan
    """counter-clockwise, rad/s"""
    attitude_time: Time = 0
    """when roll, pitch, yaw and yaw rate were measured, ns; 0: never"""
    correction_age: Known
    """s"""
    satellites: Byte = 0
    """in use; 0: not known"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixes(Message):
    """What the receivers of both bodies report for one instant; receivers to controller, one for each epoch.

    Where no receiver reports anything, the sensor board's reports come by themselves.
    """

    epoch: Time
    """instant of the measurement, ns; of the sensor board's report, where it comes by itself"""
    first_byte: Time
    """when the first byte of this epoch was there, ns"""
    hitch_angle: Known
    """tractor yaw minus drawbar yaw, rad"""
    hitch_angle_time: Time
    """when it was measured, ns; 0: never"""
    wheel_speed: Known
    """m/s, forward positive"""
    wheel_speed_time: Time
    """when it was measured, ns; 0: never"""
    tractor: ReceiverReport
    trailer: ReceiverReport
