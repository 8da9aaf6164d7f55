"""Dead bands of steerings: from what they made of their set points, by the gate's states."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from drawbar.driving.preparation.hand_calibration import CalibrationResult
from drawbar.machine.calibration.loop import LoopDrive, loop_dead_band
from drawbar.messages import GateState
from drawbar.vehicle.parameters import STEERINGS

_GAP = 1.0
"""longest time between two states of one stretch, s"""


def dead_bands(states: Sequence[GateState]) -> Iterator[CalibrationResult]:
    """Yield both steerings' dead bands, of states of the gate in which it steers; nothing where there are none."""
    for body, name in STEERINGS.items():
        drive = _loop_drive(states, body)
        if np.isfinite(drive.asked).any():
            yield CalibrationResult(name=f"{name}: dead band", value=loop_dead_band(drive), sets={})


def steered_time(states: Iterable[GateState]) -> float:
    """Return for how long the states show steering, s."""
    steps = np.diff([1e-9 * state.time for state in states])
    return float(steps[steps <= _GAP].sum())


def _loop_drive(states: Sequence[GateState], body: str) -> LoopDrive:
    """Return a body's steering; of several states with one measured angle the first counts."""
    rows = {
        getattr(state, f"{body}_angle_time"): (getattr(state, f"{body}_set_point"), getattr(state, f"{body}_angle"))
        for state in reversed(states)
    }
    times = sorted(time for time in rows if time)
    asked, measured = zip(*(rows[time] for time in times), strict=True) if times else ((), ())
    return LoopDrive(
        times=1e-9 * np.array(times, float), asked=np.array(asked, float), measured=np.array(measured, float)
    )
