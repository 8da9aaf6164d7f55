"""Reversed hitch sensor: one whose angle is the negative of the one that the motion implies.

The estimate absorbs a reversed angle in yaws and crab angles at first. So the hitch angle is simulated from wheels and
joint alone: a drawn trailer is stable, so the initial error decays. Its error by unknown crab angles, a few degrees for
long on rough ground, is too large for a limit on the residual. But two hypotheses compete: measured = +simulated and
measured = -simulated. Their mean squared residuals differ by four times the mean of measured times simulated, which is
rarely negative with a correct sensor.
"""

import math
from collections import deque
from statistics import fmean

from drawbar.driving.fault_detection.running_rms import MOVES, RunningRms
from drawbar.geometry import wrap
from drawbar.signals import Measurement, StepRecord
from drawbar.vehicle.articulated import tractor_rates, trailer_yaw_rate
from drawbar.vehicle.lengths import length_values
from drawbar.vehicle.parameters import VehicleParameters

_SPAN = 0.6
"""over which the hypotheses are compared, s"""
_LIMIT, _FACTOR = math.radians(2.5), 2.2
"""root of a quarter of the difference of their mean squares, beyond which the sensor is reversed: rad, and root mean
squares of the residual of the better one"""
_SINGLE = 0.9
"""largest share of that limit by one sample, which may be false"""
_CLIP = math.radians(12.0)
"""at which a residual is clipped, rad"""


class ReversedHitchSensor:
    """Comparison of both hypotheses over the last samples."""

    def __init__(self, vehicle: VehicleParameters, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._lengths = length_values(vehicle)
        self._sample_time = sample_time
        self._last: Measurement | None = None
        self._gamma = 0.0  # tractor yaw minus trailer yaw, simulated, rad
        self._products = deque[float](maxlen=max(round(_SPAN / sample_time), 1))  # measured times simulated, rad²
        self._rms = RunningRms(sample_time)  # residual, rad

    def update(self, record: StepRecord) -> bool:
        """Update with a step; return whether the sensor is reversed."""
        measured, last = record.measurement, self._last
        self._last = measured
        if not self._simulate(record, last):
            self._gamma = measured.hitch_angle + measured.trailer_steering
            self._products.clear()
            return False
        simulated = self._gamma - measured.trailer_steering
        if math.isfinite(measured.hitch_angle):
            self._products.append(measured.hitch_angle * simulated)
            residuals = (abs(wrap(measured.hitch_angle - sign * simulated)) for sign in (1.0, -1.0))
            self._rms.add(min(*residuals, _CLIP))
        full = len(self._products) == self._products.maxlen
        limit = max(_LIMIT, _FACTOR * self._rms.value)
        least = -_SINGLE * len(self._products) * limit**2
        return full and fmean(max(each, least) for each in self._products) < -(limit**2)

    def _simulate(self, record: StepRecord, last: Measurement | None) -> bool:
        """Simulate the angle since the last sample; return whether all inputs were known."""
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
        if not (math.isfinite(gamma) and min(now.speed, last.speed) >= MOVES):
            return False
        self._gamma = wrap(gamma)
        return True
