"""The simulated machine's truth in place of an estimate: the upper limit of what estimation can give."""

import math
from collections.abc import Callable

from drawbar.errors import HardwareError
from drawbar.estimation.estimator import Estimator
from drawbar.geometry import Floats
from drawbar.signals import Command, Estimate, Measurement, Pose, SolverStatus, SolveTimes, Truth


class IdealEstimator(Estimator):
    """Hands on the true state, but for errors where they are asked for, and the true slips."""

    def __init__(self, truth: Callable[[], Truth | None], errors: Callable[[], Floats] | None = None) -> None:
        """Take what tells the truth at the time of the newest measurement.

        Args:
            truth: None where there is none.
            errors: gives (6,) what each estimate errs by: lateral (m), yaw and steering (rad) of tractor and trailer.

        Raises:
            HardwareError: there is no truth to be had.
        """
        self._truth, self._errors = truth, errors
        self._now()

    def update(self, measurement: Measurement) -> Estimate:
        """Return the truth; nothing of the measurement but its time is used."""
        truth = self._now()
        errors = [0.0] * 6 if self._errors is None else self._errors().tolist()
        tractor, trailer = _beside(truth.tractor, *errors[:2]), _beside(truth.trailer, *errors[3:5])
        joint = truth.trailer_steering + errors[5]
        return Estimate(
            time=measurement.time,
            tractor=tractor,
            trailer=trailer,
            hitch_angle=tractor.yaw - trailer.yaw - joint,
            speed=truth.speed,
            tractor_steering=truth.tractor_steering + errors[2],
            trailer_steering=joint,
            longitudinal_slip=truth.longitudinal_slip,
            tractor_slip=truth.tractor_slip,
            trailer_slip=1.0,  # the actuated joint's angle is what it is
            steering_offset=truth.steering_offset,
            tractor_crab=truth.tractor_crab,
            trailer_crab=truth.trailer_crab,
            status=SolverStatus.SOLVED,
        )

    def prepare(self, command: Command | None = None) -> None:
        """Do nothing: the truth needs no preparation."""

    @property
    def times(self) -> SolveTimes:
        """NaN: nothing is solved."""
        return SolveTimes(prepare=math.nan, feedback=math.nan)

    def _now(self) -> Truth:
        truth = self._truth()
        if truth is None:
            raise HardwareError(
                "estimator.model = 'ideal' needs the true state, which only a simulated machine knows; use "
                "'articulated' or 'tricycle' on this one."
            )
        return truth


def _beside(pose: Pose, left: float, turn: float) -> Pose:
    """Return a pose shifted to its left (m) and turned (rad)."""
    return Pose(x=pose.x - left * math.sin(pose.yaw), y=pose.y + left * math.cos(pose.yaw), yaw=pose.yaw + turn)
