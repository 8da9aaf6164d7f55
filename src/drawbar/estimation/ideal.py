"""Ideal estimator: the simulated machine's truth as the estimate, the upper limit of what estimation can give."""

import math
from collections import deque
from collections.abc import Callable

import numpy as np

from drawbar.codegen import Unit
from drawbar.geometry import Floats
from drawbar.signals import Estimate, Pose, SolverStatus, Truth

IDEAL_UNIT = Unit(name="estimator", source='#include "ideal.h"', configure=lambda workspace: None, simulation_only=True)
"""hands on the estimate that it was given before each sample"""
_ANGLES = 32
"""of the front wheels that are kept; further back than any body lag where samples are 0.01 s apart"""


class TrueState:
    """The simulated machine's truth as the estimate, sample by sample."""

    def __init__(self, sample_time: float, errors: Callable[[], Floats] | None = None) -> None:
        """Begin before the first sample.

        Args:
            sample_time: from one estimate to the next, s.
            errors: gives (6,) what the estimate errs by: lateral (m), yaw and steering (rad) of tractor and trailer.
        """
        self._sample_time, self._errors = sample_time, errors
        self._angles: deque[float] = deque(maxlen=_ANGLES)

    def estimate(self, truth: Truth, slide: tuple[float, float, float], body_lag: float) -> Estimate:
        """Return the true state and slips as the next sample's estimate.

        Args:
            truth: at the time of the newest measurement.
            slide: side-slip of every axle by the slope to the east and to the north, rad, by a curve, rad/g.
            body_lag: by which the tractor turns later than its wheels stand, s: the front wheels' angle is the one that
                turns it now, as in every estimate.
        """
        wrong = [0.0] * 6 if self._errors is None else self._errors().tolist()
        self._angles.appendleft(truth.tractor_steering)
        ages = self._sample_time * np.arange(len(self._angles))
        east, north, creep = slide
        tractor, trailer = _beside(truth.tractor, *wrong[:2]), _beside(truth.trailer, *wrong[3:5])
        joint = truth.trailer_steering + wrong[5]
        return Estimate(
            time=truth.time,
            tractor=tractor,
            trailer=trailer,
            hitch_angle=tractor.yaw - trailer.yaw - joint,
            speed=truth.speed,
            tractor_steering=float(np.interp(body_lag, ages, list(self._angles))) + wrong[2],
            trailer_steering=joint,
            longitudinal_slip=truth.longitudinal_slip,
            tractor_slip=truth.tractor_slip,
            trailer_slip=1.0,  # the actuated joint's angle is what it is
            steering_offset=truth.steering_offset,
            tractor_crab=truth.tractor_crab,
            trailer_crab=truth.trailer_crab,
            slide_east=east,
            slide_north=north,
            creep=creep,
            status=SolverStatus.SOLVED,
        )


def _beside(pose: Pose, left: float, turn: float) -> Pose:
    """Return a pose shifted to its left (m) and turned (rad)."""
    return Pose(x=pose.x - left * math.sin(pose.yaw), y=pose.y + left * math.cos(pose.yaw), yaw=pose.yaw + turn)
