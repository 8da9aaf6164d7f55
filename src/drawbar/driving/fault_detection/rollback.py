"""Rollback: the last seconds are computed again without an excluded sensor.

A wrong sensor corrupts the estimate before it is detected, and that takes seconds to converge again, in which the
vehicle is steered beside its line. So the autopilot's state at each of the last samples is kept, and from the oldest on
the same measurements are processed again, without the excluded ones. The steerings followed the commands that were sent
then, so the recomputation uses those, not the ones that it would send itself.
"""

from collections.abc import Callable

from drawbar.driving.fault_detection.recent import Recent
from drawbar.signals import Command, Measurement, Status
from drawbar.step.autopilot import Autopilot, Memory

SPAN = 2.0
"""s"""


class Rollback:
    """The last samples of an autopilot."""

    def __init__(self, autopilot: Autopilot, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._autopilot = autopilot
        self._samples = Recent[tuple[Memory, Measurement, Command]](SPAN, sample_time)

    def feedback(self, measurement: Measurement) -> tuple[Status, Command]:
        """Return the autopilot's answer to a measurement; keep both, and what it remembered before."""
        memory = self._autopilot.remember()
        status, command = self._autopilot.feedback(measurement)
        self._samples.append((memory, measurement, command))
        return status, command

    def clear(self) -> None:
        """Forget all samples: the autopilot was given something else than measurements."""
        self._samples.clear()

    def recompute(self, change: Callable[[Measurement], Measurement]) -> tuple[Status, Command] | None:
        """Process the kept measurements again, each changed by a function.

        Returns:
            Its answer to the newest, which is a new one, to be sent at once; None where none is kept.
        """
        answer, newest = None, len(self._samples) - 1
        for i, (memory, measurement, sent) in enumerate(self._samples):
            if i == 0:
                self._autopilot.recall(memory)
            changed = change(measurement)
            answer = self._autopilot.feedback(changed) if i == newest else self._autopilot.feedback_again(changed, sent)
            self._autopilot.prepare()
        self.clear()
        return answer
