"""Hand log: a drive by hand or steered, kept from its begin until a calibration evaluates it. Pure."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from drawbar.driving.preparation.dead_bands import steered_time
from drawbar.driving.preparation.hand_calibration import two_ways
from drawbar.driving.preparation.hand_drive import HandDrive
from drawbar.machine.calibration.mounting import TURNING
from drawbar.messages import GateState
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
    back: float
    """time of the longest straight's way back in the same tracks, s"""
    curves: float
    """time of turning to both sides without holding the steering, s"""
    steered: float
    """time for which drawbar has steered, s"""


class HandLog:
    """Keeps steps while it is on, and the gate's states in which drawbar steers."""

    def __init__(self) -> None:
        """Begin with nothing."""
        self.is_on = False
        self._records: deque[StepRecord] = deque(maxlen=_MOST)
        self._by_hand: deque[StepRecord] = deque(maxlen=_MOST)
        """of these, in which drawbar does not steer"""
        self._states: deque[GateState] = deque(maxlen=_MOST)

    def begin(self) -> None:
        """Forget what was kept, and keep what comes."""
        self._records.clear()
        self._by_hand.clear()
        self._states.clear()
        self.is_on = True

    def end(self) -> None:
        """Keep nothing more."""
        self.is_on = False

    def receive_step(self, record: StepRecord, *, engaged: bool) -> None:
        """Take in a step."""
        if not self.is_on:
            return
        self._records.append(record)
        if not engaged:
            self._by_hand.append(record)

    def receive_gate(self, state: GateState) -> None:
        """Take in a state of the gate."""
        if self.is_on and state.steers:
            self._states.append(state)

    def driven(self) -> Driven:
        """Return what counts of it so far."""
        drive, steered = self.drive(), steered_time(self._states)
        if drive is None:
            return Driven(straight=0.0, left=0, right=0, back=0.0, curves=0.0, steered=steered)
        return _driven(drive, steered)

    @property
    def steered(self) -> list[GateState]:
        """The states in which drawbar steered."""
        return list(self._states)

    @property
    def records(self) -> list[StepRecord]:
        """All steps, by hand and steered."""
        return list(self._records)

    def drive(self) -> HandDrive | None:
        """Return what was driven by hand; None: too little."""
        return HandDrive.of_records(list(self._by_hand)) if len(self._by_hand) >= _FEWEST else None


def _driven(drive: HandDrive, steered: float) -> Driven:
    circles = drive.circles()
    turns = [float(np.mean(part.front_wheels)) for part in circles]
    held = sum(float(part.times[-1] - part.times[0]) for part in circles)
    turning = float(np.diff(drive.times, prepend=drive.times[0])[np.abs(drive.yaw_rates) > TURNING].sum())
    _, back = two_ways(drive)
    return Driven(
        straight=max((part.way for part in drive.straights()), default=0.0),
        left=sum(turn > 0.0 for turn in turns),
        right=sum(turn < 0.0 for turn in turns),
        back=float(np.ptp(back.times)) if len(back.times) else 0.0,
        curves=max(turning - held, 0.0),
        steered=steered,
    )
