"""Drive a path from its start to its end, step by step."""

from collections.abc import Iterator

from drawbar.autopilot.autopilot import Autopilot
from drawbar.errors import DrawbarError
from drawbar.signals import StepRecord

LOST = 5.0
"""Distance from the path at which a run is given up, m."""


class RunAborted(DrawbarError):  # noqa: N818 -- an outcome, not a mistake
    """The run was given up before the end of the path; the log holds all steps up to then."""


def drive(autopilot: Autopilot, *, time_limit: float) -> Iterator[StepRecord]:
    """Yield the record of every step until the tractor reaches the end of the path.

    Args:
        autopilot: the control step.
        time_limit: s, after which the run is given up.

    Raises:
        RunAborted: the vehicle left the path or did not arrive in time.
    """
    while not autopilot.guidance.finished:
        record = autopilot.step()
        yield record
        time, error = record.measurement.time, record.reference.tractor.lateral_error
        if not abs(error) <= LOST:  # also when it is NaN
            raise RunAborted(f"At {time:.1f} s the tractor was {abs(error):.2f} m from the path (limit {LOST} m).")
        if time > time_limit:
            raise RunAborted(f"The path was not finished within {time_limit:.0f} s; raise speed or look at the log.")
