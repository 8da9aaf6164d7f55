"""Hitch angle by the motion of wheels and joint alone: a drawn trailer is stable, so the initial error decays.

Unknown crab angles make it wrong by a few degrees, for long on rough ground.
"""

import math

from drawbar.driving.fault_detection.running_rms import MOVES
from drawbar.geometry import wrap
from drawbar.signals import Measurement, StepRecord
from drawbar.vehicle.articulated import tractor_rates, trailer_yaw_rate
from drawbar.vehicle.lengths import length_values
from drawbar.vehicle.parameters import VehicleParameters


class SimulatedHitchAngle:
    """Simulation from one measured hitch angle on."""

    def __init__(self, vehicle: VehicleParameters, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._lengths = length_values(vehicle)
        self._sample_time = sample_time
        self._last: Measurement | None = None
        self._gamma = 0.0  # tractor yaw minus trailer yaw, rad

    def update(self, record: StepRecord) -> float:
        """Simulate on to a step; return the hitch angle, rad.

        NaN: not all inputs are known, or the vehicle stands; it begins anew where the angle is measured.
        """
        measured, last = record.measurement, self._last
        self._last = measured
        if not self._simulate(record, last):
            self._gamma = measured.hitch_angle + measured.trailer_steering
            return math.nan
        return self._gamma - measured.trailer_steering

    def _simulate(self, record: StepRecord, last: Measurement | None) -> bool:
        """Simulate since the last sample; return whether all inputs were known."""
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
