"""Fixes: what the receivers and sensors report for one instant."""

import math
from dataclasses import dataclass

from drawbar.messages.base import Message
from drawbar.messages.fields import Byte, Known, Time


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixes(Message):
    """What the receivers of both bodies report for one instant; receivers to controller, one for each epoch.

    Positions are those of the antennas, in the frame of the path. A receiver that reports nothing has no fix, and NaN.
    Where none reports anything, the sensor board's reports come by themselves.
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
    tractor_heard: Byte = 1
    """0: its receiver reports nothing for this instant"""
    tractor_x: Known
    """east, m"""
    tractor_y: Known
    """north, m"""
    tractor_deviation: Known
    """standard deviation of each coordinate, m"""
    tractor_quality: Byte
    """FixQuality of statuses.py, debounced"""
    tractor_speed: Known
    """over ground, m/s, never negative"""
    tractor_course: Known
    """yaw of the velocity, rad"""
    tractor_roll: Known
    """right side down positive, rad"""
    tractor_pitch: Known
    """nose up positive, rad"""
    tractor_yaw: Known = math.nan
    """of the body, by two antennas on it, rad"""
    tractor_yaw_rate: Known = math.nan
    """counter-clockwise, rad/s"""
    tractor_attitude_time: Time = 0
    """when roll, pitch, yaw and yaw rate were measured, ns; 0: never"""
    tractor_correction_age: Known
    """s"""
    tractor_satellites: Byte = 0
    """in use; 0: not known"""
    trailer_heard: Byte = 1
    """0: its receiver reports nothing for this instant, or there is none"""
    trailer_x: Known
    """east, m"""
    trailer_y: Known
    """north, m"""
    trailer_deviation: Known
    """standard deviation of each coordinate, m"""
    trailer_quality: Byte
    """FixQuality of statuses.py, debounced"""
    trailer_speed: Known
    """over ground, m/s, never negative"""
    trailer_course: Known
    """yaw of the velocity, rad"""
    trailer_roll: Known
    """right side down positive, rad"""
    trailer_pitch: Known
    """nose up positive, rad"""
    trailer_yaw_rate: Known = math.nan
    """counter-clockwise, rad/s"""
    trailer_attitude_time: Time = 0
    """when roll, pitch and yaw rate were measured, ns; 0: never"""
    trailer_correction_age: Known
    """s"""
    trailer_satellites: Byte = 0
    """in use; 0: not known"""
