"""What the trailer's steering leaves of its off-tracking, and how far the tractor leaves its line to share that.

On a steady curve the whole vehicle turns about one centre, so each part's distance from it follows from the lengths,
the joint's angle and the axles' side-slip. Behind a tractor on its line the trailer so keeps a lateral error, of which
its own steering can take back no more than the short drawbar reaches sideways (docs/theory.md, nominal controllers).
"""

import math

import numpy as np

from drawbar.control.settings import SharingSettings
from drawbar.geometry import Floats
from drawbar.signals import Estimate
from drawbar.vehicle.parameters import VehicleParameters


class OffTracking:
    """The trailer's steady lateral error behind a tractor on its line, after what its steering takes back of it."""

    def __init__(self, vehicle: VehicleParameters) -> None:
        """Take lengths and steering limit."""
        self._hitch, c = vehicle.free_joint_offset, vehicle.trailer_antenna
        along = vehicle.trailer_length + vehicle.drawbar_length * math.cos(vehicle.trailer_steering_limit)
        across = vehicle.drawbar_length * math.sin(vehicle.trailer_steering_limit)
        self._reach = across
        self._antenna = along - c
        self._cut_in = 0.5 * (along**2 + across**2 - self._hitch**2 - c**2)

    def remainder(self, curvature: Floats, tractor_crab: float, trailer_crab: float) -> Floats:
        """Return the error (n,) that is left on curvatures (n,), m, left positive; products of the two are neglected.

        Args:
            curvature: of the tractor's line, 1/m.
            tractor_crab: alpha_r, rad.
            trailer_crab: alpha_i, rad.
        """
        hanging = self._hitch * math.sin(tractor_crab) + self._antenna * math.sin(trailer_crab)
        error = hanging + self._cut_in * curvature
        reach = self._reach * math.cos(trailer_crab)
        remainder: Floats = error - np.clip(error, -reach, reach)
        return remainder


class SharedError:
    """Lateral targets of the tractor by which both bodies share what the trailer cannot steer away.

    The tractor takes a share of what remains beyond an accepted error, and keeps a little outside of every curve, where
    the trailer's steering has nothing left to correct with. The target changes no faster than the trailer can follow, a
    first-order lag of the trailer's length along the way.
    """

    def __init__(self, vehicle: VehicleParameters, settings: SharingSettings, sample_time: float) -> None:
        """Take lengths and limits, how to share, and the time between stages (s)."""
        self._off_tracking, self._settings = OffTracking(vehicle), settings
        self._sample_distance = sample_time / (vehicle.trailer_length + vehicle.drawbar_length)
        self._next = 0.0

    def targets(self, estimate: Estimate, curvature: Floats) -> Floats:
        """Return the lateral targets (n,) at the next n stages, m, left positive; the next call begins at the second.

        Args:
            estimate: slip and speed now.
            curvature: of the path at the stages (n,), 1/m.
        """
        remainder = self._off_tracking.remainder(curvature, estimate.tractor_crab, estimate.trailer_crab)
        settings, sides = self._settings, np.sign(remainder)
        beyond = sides * np.maximum(np.abs(remainder) - settings.accepted_error, 0.0)
        wanted = -settings.widening * curvature - settings.share * beyond
        follows = -math.expm1(-estimate.longitudinal_slip * estimate.speed * self._sample_distance)
        targets, target = np.empty_like(wanted), self._next
        for stage, aim in enumerate(wanted.tolist()):
            targets[stage] = target
            target += follows * (aim - target)
        self._next = float(targets[1])
        return targets
