"""Hand log: the steps of a drive by hand, kept for a calibration from its begin until it is evaluated. Pure."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from drawbar.driving.hand_drive import HandDrive
from drawbar.machine.hardware.mounting_calibration import TURNING
from drawbar.signals import StepRecord

_MOST = 12_000
"""steps that are kept; 40 minutes at 5 Hz"""
_FEWEST = 10
"""steps in which something may be found"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Driven:
    """What has been driven so far, as far as it counts."""

    straight: float
    """length of the longest straight stretch, m"""
    left: int
    """circles with the steering held"""
    right: int
    curves: float
    """time of turning to both sides without holding the steering, s"""


class HandLog:
    """Keeps steps while it is on; what drawbar steers is no drive by hand and ends it."""

    def __init__(self) -> None:
        """Begin with nothing."""
        self.is_on = False
        self._records: deque[StepRecord] = deque(maxlen=_MOST)

    def begin(self) -> None:
        """Forget what was kept, and keep what comes."""
        self._records.clear()
        self.is_on = True

    def end(self) -> None:
        """Keep nothing more."""
        self.is_on = False

    def hear(self, record: StepRecord, *, engaged: bool) -> None:
        """Take in a step."""
        if engaged:
            self.end()
        if self.is_on:
            self._records.append(record)

    def drive(self) -> HandDrive | None:
        """Return what is kept; None: too little."""
        return HandDrive.of_records(list(self._records)) if len(self._records) >= _FEWEST else None


def driven(drive: HandDrive) -> Driven:
    """Return what counts of a drive."""
    circles = drive.circles()
    turns = [float(np.mean(part.front_wheels)) for part in circles]
    held = sum(float(part.times[-1] - part.times[0]) for part in circles)
    turning = float(np.diff(drive.times, prepend=drive.times[0])[np.abs(drive.yaw_rates) > TURNING].sum())
    return Driven(
        straight=max((part.way for part in drive.straights()), default=0.0),
        left=sum(turn > 0.0 for turn in turns),
        right=sum(turn < 0.0 for turn in turns),
        curves=max(turning - held, 0.0),
    )
