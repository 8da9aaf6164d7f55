"""Ideal estimator: the simulated machine's truth as the estimate, the upper limit of what estimation can give."""

import math
from collections.abc import Callable

from drawbar.codegen import Unit
from drawbar.geometry import Floats
from drawbar.signals import Estimate, Pose, SolverStatus, Truth

IDEAL_UNIT = Unit(name="estimator", source='#include "ideal.h"', configure=lambda workspace: None, simulation_only=True)
"""hands on the estimate that it was given before each sample"""


def ideal_estimate(truth: Truth, errors: Callable[[], Floats] | None = None) -> Estimate:
    """Return the true state and slips as an estimate.

    Args:
        truth: at the time of the newest measurement.
        errors: gives (6,) what the estimate errs by: lateral (m), yaw and steering (rad) of tractor and trailer.
    """
    wrong = [0.0] * 6 if errors is None else errors().tolist()
    tractor, trailer = _beside(truth.tractor, *wrong[:2]), _beside(truth.trailer, *wrong[3:5])
    joint = truth.trailer_steering + wrong[5]
    return Estimate(
        time=truth.time,
        tractor=tractor,
        trailer=trailer,
        hitch_angle=tractor.yaw - trailer.yaw - joint,
        speed=truth.speed,
        tractor_steering=truth.tractor_steering + wrong[2],
        trailer_steering=joint,
        longitudinal_slip=truth.longitudinal_slip,
        tractor_slip=truth.tractor_slip,
        trailer_slip=1.0,  # the actuated joint's angle is what it is
        steering_offset=truth.steering_offset,
        tractor_crab=truth.tractor_crab,
        trailer_crab=truth.trailer_crab,
        status=SolverStatus.SOLVED,
    )


def _beside(pose: Pose, left: float, turn: float) -> Pose:
    """Return a pose shifted to its left (m) and turned (rad)."""
    return Pose(x=pose.x - left * math.sin(pose.yaw), y=pose.y + left * math.cos(pose.yaw), yaw=pose.yaw + turn)
