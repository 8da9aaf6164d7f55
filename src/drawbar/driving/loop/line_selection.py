"""Line selection: the line that the autopilot drives, as the operator has chosen it, and where a run on it begins."""

import math
from contextlib import suppress

from drawbar.driving.fault_detection.rollback import Rollback
from drawbar.driving.loop.driven_line import DrivenLine
from drawbar.errors import DrawbarError, PathError
from drawbar.guidance.path import Path
from drawbar.signals import Measurement, StepRecord
from drawbar.step.autopilot import Autopilot

_NEAR = 5.0
"""along the line, within which the place beside the vehicle is searched when the line is moved, m"""


class LineSelection:
    """Gives the autopilot the line that is driven; its rollback forgets what was driven on another one."""

    def __init__(self, line: DrivenLine, autopilot: Autopilot, rollback: Rollback) -> None:
        """Take the line on which the autopilot has begun."""
        self.line = line
        """the one that is driven"""
        self._autopilot, self._rollback = autopilot, rollback
        self._requested: tuple[float, float] | None = None
        """the line that was chosen and its nudge, m"""
        self._waits_for_begin = False
        """the chosen line is not under the vehicle: it is driven by a new run"""

    def retry(self) -> None:
        """Try again at the next choice what was not possible: it may be now."""
        self._requested = None

    def choose(self, offset: float, nudge: float, record: StepRecord | None, *, engaged: bool) -> None:
        """Drive the line so far left of the configured one, m, and nudged; where that cannot be, the old one stays.

        Args:
            offset: of the line, m.
            nudge: from that line, m.
            record: of the newest step, if there is one.
            engaged: the vehicle is steered.
        """
        if (offset, nudge) == self._requested:
            return
        self._requested = offset, nudge
        with suppress(DrawbarError):
            if offset != self.line.offset:
                self._go_over(self.line.beside(offset), record, engaged)
            if nudge != self.line.nudge:
                self._nudge(self.line.nudged(nudge))

    def is_to_begin(self, measurement: Measurement, record: StepRecord | None) -> bool:
        """Return whether a vehicle that is not steered needs a new run: on a chosen line, or the other way along it."""
        if self._waits_for_begin:
            return True
        return record is not None and self.line.faces_away(measurement, record.reference.tractor.closest[2])

    def begin_beside(self, measurement: Measurement) -> bool:
        """Let the next sample begin a run where the path is nearest, not engaged; return False without a position."""
        if not math.isfinite(measurement.tractor_x + measurement.tractor_y):
            return False
        self.line, progress = self.line.nearest(measurement)
        self._autopilot.begin(self.line.path, at=_within(progress, self.line.path))
        self._autopilot.set_offset(self.line.left)
        self._autopilot.set_engaged(False)
        self._rollback.clear()
        self._waits_for_begin = False
        return True

    def _go_over(self, chosen: DrivenLine, record: StepRecord | None, engaged: bool) -> None:
        """Drive another line: at once if it is under the vehicle, else by a new run.

        Raises:
            PathError: that cannot be while the vehicle is steered.
        """
        try:
            self._autopilot.change_path(chosen.path, at=_progress_on(chosen.path, record))
        except PathError:
            if engaged:
                raise
            self._waits_for_begin = True
        self.line = chosen
        self._rollback.clear()

    def _nudge(self, nudged: DrivenLine) -> None:
        """Drive beside the path; where the vehicle is steered, it is led there softly.

        Raises:
            DrawbarError: the autopilot refuses it.
        """
        self._autopilot.set_offset(nudged.left)
        self.line = nudged
        self._rollback.clear()


def _progress_on(path: Path, record: StepRecord | None) -> float:
    """Return the arc length of another path beside the tractor, near that of the newest step, m."""
    if record is None:
        return 0.0
    place, near = record.estimate.tractor, record.reference.tractor.progress
    if not math.isfinite(near + place.x + place.y):
        return 0.0
    progress, _ = path.project(place.x, place.y, max(near - _NEAR, 0.0), min(near + _NEAR, path.length))
    return _within(progress, path)


def _within(progress: float, path: Path) -> float:
    return min(max(progress, 0.0), math.nextafter(path.length, 0.0))
