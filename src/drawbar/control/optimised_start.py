"""A nominal state that the nominal problem chooses itself, within the tube around the estimate (Mayne et al. 2005)."""

from dataclasses import replace

import numpy as np

from drawbar.geometry import Floats, placed_at, seen_from
from drawbar.signals import BodyReference, Estimate, Pose

_PULL = 1e-3
"""Weight on what parts the chosen state from the one that the nominal model got to: decides what nothing else does."""


class OptimisedStart:
    """The box that the first state is free in, and the frame in which its sides are offset and heading.

    While the state that the nominal model got to is in the box around the estimate, all of the box may be chosen; both
    leave the vehicle in its tube. Outside the box that state is the only one that surely does, and is kept.
    """

    def __init__(self, choice: Floats, states: int) -> None:
        """Take the half-widths of the box (see initial_choice) and the number of the model's states.

        A state more than half-widths is the one along the path: it is the estimate's.
        """
        self.weights = (_PULL,) * states
        self._reach = np.concatenate([np.full(states - len(choice), np.inf), choice])
        self._half_widths = np.where(np.isfinite(self._reach), self._reach, 0.0)
        self._frame = np.zeros(3)

    def between(self, estimated: Floats, successor: Floats) -> tuple[Floats, Floats]:
        """Return the least and the largest first state (nx,), from the estimate and where the nominal model got."""
        if not np.all(np.abs(estimated - successor) <= self._reach):
            return successor, successor
        return estimated - self._half_widths, estimated + self._half_widths

    def enter(self, reference: BodyReference) -> Floats:
        """Take the path's frame here for what follows; return the frame before, (3,)."""
        old, self._frame = self._frame, reference.closest[:3]
        return old

    def seen_again(self, old: Floats, states: Floats) -> Floats:
        """Return states (n, nx) of an old frame in this one."""
        return seen_from(self._frame, placed_at(old, states))

    def seen(self, estimate: Estimate, reference: BodyReference) -> tuple[Estimate, BodyReference]:
        """Return what the problem is made of as seen from the frame."""
        tractor, trailer = (self._pose_seen(pose) for pose in (estimate.tractor, estimate.trailer))
        closest, samples = (seen_from(self._frame, poses) for poses in (reference.closest[None], reference.samples))
        return replace(estimate, tractor=tractor, trailer=trailer), replace(
            reference, closest=closest[0], samples=samples
        )

    def placed(self, poses: Floats) -> Floats:
        """Return poses (n, 3) of the frame in the world."""
        return placed_at(self._frame, poses)

    def _pose_seen(self, pose: Pose) -> Pose:
        x, y, yaw = seen_from(self._frame, np.array([[pose.x, pose.y, pose.yaw]]))[0].tolist()
        return Pose(x=x, y=y, yaw=yaw)
