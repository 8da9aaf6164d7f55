"""Preview guidance: the path itself, at the pace at which the vehicle will cover it over the horizon."""

import math

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats, wrap
from drawbar.guidance.approach import Approach, find_approach
from drawbar.guidance.guidance import Guidance, Position
from drawbar.guidance.path import Path
from drawbar.guidance.settings import GuidanceSettings
from drawbar.guidance.turns import TurnLimits
from drawbar.signals import Estimate
from drawbar.vehicle.parameters import VehicleParameters

_ASTRAY = math.radians(60.0)
"""Heading error up to which the controllers find their way by themselves; beyond it their linearisations do not."""


class Preview(Guidance):
    """Stage j of each body is the path at its progress plus j mu v dt; it never moves back.

    A tractor that faces away from what it shall follow is led onto the path by turns (see approach.py); the trailer
    comes after as it may.
    """

    def __init__(
        self,
        path: Path,
        settings: GuidanceSettings,
        *,
        vehicle: VehicleParameters,
        stages: int,
        interval: float,
        tractor: Position,
        trailer: Position,
    ) -> None:
        """Prepare references of stages + 1 samples, interval (s) apart; otherwise as Guidance."""
        super().__init__(path, settings, tractor=tractor, trailer=trailer)
        self._times: Floats = interval * np.arange(stages + 1, dtype=np.float64)
        self._wheelbase = vehicle.wheelbase
        self._limits = TurnLimits(curvature=vehicle.curvature_limit, rate=settings.curvature_rate_limit)
        self._furthest = [-math.inf, -math.inf]
        self._approach: Approach | None = None
        self._approached = 0.0

    def _samples(self, estimate: Estimate) -> Floats:
        """Return the samples of both bodies; see the base class.

        Raises PathError when the speed is not finite, or the tractor faces away and no turns lead onto the path.
        """
        speed = estimate.longitudinal_slip * estimate.speed
        if not math.isfinite(speed):
            raise PathError(f"guidance: the estimated speed over ground is {speed} m/s; stop the vehicle")
        distances: Floats = speed * self._times
        self._advance(estimate)
        samples = self.path.sample(np.add.outer(self._furthest, distances))
        yaw, on_path = estimate.tractor.yaw, samples[0].copy()
        if self._approach is not None:
            samples[0] = self._approach.sample(self.path, self._approached + distances)
        if _astray(yaw, samples[0]):
            self._approach, self._approached = self._turn(estimate) if _astray(yaw, on_path) else None, 0.0
            samples[0] = on_path if self._approach is None else self._approach.sample(self.path, distances)
        return samples

    def _advance(self, estimate: Estimate) -> None:
        """Move the progress forward, on an approach as long as there is one."""
        now = (self._tractor_progress, self._trailer_progress)
        self._furthest = [max(pair) for pair in zip(self._furthest, now, strict=True)]
        if self._approach is None:
            return
        track, pose, last, settings = self._approach.track, estimate.tractor, self._approached, self.settings
        progress, _ = track.project(pose.x, pose.y, last - settings.window_behind, last + settings.window_ahead)
        self._approached = max(last, progress)
        if self._approached >= track.length:
            # the turns may have led back behind where they began
            self._approach, self._furthest = None, list(now)

    def _turn(self, estimate: Estimate) -> Approach:
        angle = estimate.tractor_slip * estimate.tractor_steering + estimate.steering_offset
        return find_approach(
            self.path,
            estimate.tractor,
            self._tractor_progress,
            curvature=math.tan(angle) / self._wheelbase,
            limits=self._limits,
            room=self.settings.turning_room,
        )


def _astray(yaw: float, samples: Floats) -> bool:
    """Tell whether a heading (rad) is too far from that of the first of these samples (n, 4)."""
    return abs(wrap(yaw - float(samples[0, 2]))) > _ASTRAY
