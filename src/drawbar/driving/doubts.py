"""Doubts: which sensors contradict the motion, and are not listened to until the vehicle has been let go of.

The gate stops the vehicle for a doubt. Meanwhile it is steered by what is left; the estimator itself would follow where
both antennas have jumped, and the control step would end its run, and with it all steering, for a wrong hitch angle.
"""

import math
from dataclasses import replace

from drawbar.safety.sanity import SanitySettings
from drawbar.signals import FixStatus, Measurement, SolverStatus, StepRecord

DOUBTED = 3
"""samples in a row that contradict"""


class Doubts:
    """What the last samples said of the positions, of both antennas together, and of the hitch angle."""

    def __init__(self, settings: SanitySettings) -> None:
        """Begin without a doubt."""
        self._hitch_limit = settings.hitch
        self._positions = self._hitch = 0

    @property
    def exist(self) -> bool:
        """Whether anything is doubted."""
        return max(self._positions, self._hitch) >= DOUBTED

    def look(self, record: StepRecord, *, engaged: bool, drifts: bool = False) -> None:
        """Take in a step, and whether both antennas drift; what is doubted while engaged stays so."""
        if not (engaged and self._hitch >= DOUBTED):
            self._hitch = self._hitch + 1 if self._hitch_contradicts(record) else 0
        if self._hitch >= DOUBTED:  # by it the estimator was led astray, and rejects right fixes
            self._positions = 0
        elif not (engaged and self._positions >= DOUBTED):
            self._positions = DOUBTED if drifts else self._positions + 1 if _both_rejected(record) else 0

    def without(self, measurement: Measurement) -> Measurement:
        """Return a measurement without what is doubted."""
        if self._positions >= DOUBTED:
            nan = math.nan
            measurement = replace(measurement, tractor_x=nan, tractor_y=nan, trailer_x=nan, trailer_y=nan)
        return replace(measurement, hitch_angle=math.nan) if self._hitch >= DOUBTED else measurement

    def _hitch_contradicts(self, record: StepRecord) -> bool:
        apart = abs(record.measurement.hitch_angle - record.estimate.hitch_angle)
        return record.estimate.status is SolverStatus.SOLVED and apart > self._hitch_limit


def _both_rejected(record: StepRecord) -> bool:
    """Whether the estimator believes neither antenna."""
    fixes = (record.estimate.tractor_fix, record.estimate.trailer_fix)
    return all(fix is FixStatus.REJECTED for fix in fixes)
