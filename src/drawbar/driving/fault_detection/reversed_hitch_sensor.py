"""Reversed hitch sensor: one that says the opposite of what the motion makes of the hitch angle.

An estimate does not show it soon: yaws and crab angles bend until a reversed angle fits. So the angle is computed from
the motion of wheels and joint alone, which it follows by itself, whatever it began with: the trailer is drawn. Beside
a sensor that is right this angle errs by crab angles that are not known, a few degrees for long on rough ground, too
many for a limit. But two hypotheses compete: measured = +computed and measured = -computed. Their mean squared
residuals differ by four times the mean of measured times computed, which for a right sensor is hardly ever negative.
"""

import math
from collections import deque
from dataclasses import fields
from statistics import fmean

from drawbar.driving.fault_detection.running_rms import RunningRms
from drawbar.geometry import wrap
from drawbar.signals import Measurement, StepRecord
from drawbar.vehicle.articulated import tractor_rates, trailer_yaw_rate
from drawbar.vehicle.lengths import Lengths
from drawbar.vehicle.parameters import VehicleParameters

_SPAN = 0.6
"""over which the hypotheses are compared, s"""
_OPPOSITE, _USUAL = math.radians(2.5), 2.2
"""root of a quarter of the difference of their mean squares, from which on the sensor is reversed: rad, and times the
usual residual of the better one"""
_SINGLE = 0.9
"""share of that limit to which one sample brings the mean at most: it may be a false one"""
_MOST = math.radians(12.0)
"""no residual counts more in it, rad"""
_MOVES = 0.1
"""speed below which it begins anew, m/s"""


class ReversedHitchSensor:
    """What the last samples said of the hitch's sensor."""

    def __init__(self, vehicle: VehicleParameters, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._lengths = Lengths(**{each.name: getattr(vehicle, each.name) for each in fields(Lengths)})
        self._sample_time = sample_time
        self._last: Measurement | None = None
        self._gamma = 0.0  # tractor yaw minus trailer yaw, by the motion, rad
        self._products = deque[float](maxlen=max(round(_SPAN / sample_time), 1))  # measured times computed, rad²
        self._rms = RunningRms(sample_time)  # residual, rad

    def update(self, record: StepRecord) -> bool:
        """Take in a step; return whether the sensor is reversed."""
        measured, last = record.measurement, self._last
        self._last = measured
        if not self._follow(record, last):
            self._gamma = measured.hitch_angle + measured.trailer_steering
            self._products.clear()
            return False
        computed = self._gamma - measured.trailer_steering
        if math.isfinite(measured.hitch_angle):
            self._products.append(measured.hitch_angle * computed)
            residuals = (abs(wrap(measured.hitch_angle - sign * computed)) for sign in (1.0, -1.0))
            self._rms.add(min(*residuals, _MOST))
        full = len(self._products) == self._products.maxlen
        limit = max(_OPPOSITE, _USUAL * self._rms.value)
        least = -_SINGLE * len(self._products) * limit**2
        return full and fmean(max(each, least) for each in self._products) < -(limit**2)

    def _follow(self, record: StepRecord, last: Measurement | None) -> bool:
        """Let the angle follow the motion since the last sample; return whether all of it is known."""
        if last is None or not math.isfinite(self._gamma):
            return False
        now, found = record.measurement, record.estimate
        joint_rate = (now.trailer_steering - last.trailer_steering) / self._sample_time
        joint = 0.5 * (now.trailer_steering + last.trailer_steering)
        steering = 0.5 * (now.tractor_steering + last.tractor_steering)
        speed, crab = 0.5 * found.longitudinal_slip * (now.speed + last.speed), found.tractor_crab
        slips = (1.0, found.tractor_slip, found.steering_offset)
        omega = float(tractor_rates(self._lengths, 0.0, steering, *slips, crab, speed)[2])

        def rate(gamma: float) -> float:
            drawn = trailer_yaw_rate(self._lengths, speed, omega, gamma, joint, joint_rate, crab, found.trailer_crab)
            return omega - float(drawn)

        middle = self._gamma + 0.5 * self._sample_time * rate(self._gamma)
        gamma = self._gamma + self._sample_time * rate(middle)
        if not (math.isfinite(gamma) and min(now.speed, last.speed) >= _MOVES):
            return False
        self._gamma = wrap(gamma)
        return True
