"""Hitch angle by the motion of wheels and joint alone: a drawn trailer is stable, so the initial error decays.

Crab angles and the offset of the front wheels' sensor are means of their estimates: the newest ones follow a wrong
sensor. As they change with ground and heading, the angle is wrong by a few degrees, for long on rough ground.
"""

import math

from drawbar.driving.fault_detection.running_rms import MOVES
from drawbar.geometry import wrap
from drawbar.signals import Estimate, Measurement, SolverStatus
from drawbar.vehicle.articulated import tractor_rates, trailer_yaw_rate
from drawbar.vehicle.lengths import length_values
from drawbar.vehicle.parameters import VehicleParameters

_MEAN_TIME = 30.0
"""that the means cover, s"""


class _SlowMean:
    """Mean of the samples so far, then with exponential forgetting."""

    def __init__(self) -> None:
        """Begin at zero, without a sample."""
        self.value = self._time = 0.0

    def add(self, value: float, elapsed: float) -> None:
        """Add a sample and the time that it stands for, s."""
        self._time = min(self._time + elapsed, _MEAN_TIME)
        self.value += elapsed / self._time * (value - self.value)


class SimulatedHitchAngle:
    """Simulation from one measured hitch angle on."""

    def __init__(self, vehicle: VehicleParameters, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._lengths = length_values(vehicle)
        self._sample_time = sample_time
        self._tractor_crab, self._trailer_crab, self._offset = _SlowMean(), _SlowMean(), _SlowMean()  # rad
        self._last: Measurement | None = None
        self._gamma = 0.0  # tractor yaw minus trailer yaw, rad

    def update(self, measured: Measurement, found: Estimate) -> float:
        """Simulate on to a step; return the hitch angle, rad.

        NaN: not all inputs are known, or the vehicle stands; it begins anew where the angle is measured.
        """
        last, self._last = self._last, measured
        simulated = self._simulate(measured, found, last)
        if found.status is SolverStatus.SOLVED:
            self._tractor_crab.add(found.tractor_crab, self._sample_time)
            self._trailer_crab.add(found.trailer_crab, self._sample_time)
            self._offset.add(found.steering_offset, self._sample_time)
        if not simulated:
            self._gamma = measured.hitch_angle + measured.trailer_steering
            return math.nan
        return self._gamma - measured.trailer_steering

    def _simulate(self, now: Measurement, found: Estimate, last: Measurement | None) -> bool:
        """Simulate since the last sample; return whether all inputs were known."""
        if last is None or not math.isfinite(self._gamma):
            return False
        joint_rate = (now.trailer_steering - last.trailer_steering) / self._sample_time
        joint = 0.5 * (now.trailer_steering + last.trailer_steering)
        steering = 0.5 * (now.tractor_steering + last.tractor_steering)
        speed = 0.5 * found.longitudinal_slip * (now.speed + last.speed)
        crab, trailer_crab = self._tractor_crab.value, self._trailer_crab.value
        slips = (1.0, found.tractor_slip, self._offset.value)
        omega = float(tractor_rates(self._lengths, 0.0, steering, *slips, crab, speed)[2])

        def rate(gamma: float) -> float:
            drawn = trailer_yaw_rate(self._lengths, speed, omega, gamma, joint, joint_rate, crab, trailer_crab)
            return omega - float(drawn)

        middle = self._gamma + 0.5 * self._sample_time * rate(self._gamma)
        gamma = self._gamma + self._sample_time * rate(middle)
        if not (math.isfinite(gamma) and min(now.speed, last.speed) >= MOVES):
            return False
        self._gamma = wrap(gamma)
        return True
