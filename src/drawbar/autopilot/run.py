"""Drive a path from its start to its end, step by step."""

from collections.abc import Iterator

from drawbar.autopilot.autopilot import Autopilot
from drawbar.errors import DrawbarError
from drawbar.signals import Estimate, FixStatus, StepRecord

LOST = 5.0
"""Distance from the path at which a run is given up, m."""
BLIND = 15.0
"""Time without a fix of either antenna after which a run is given up, s: dead reckoning is off by then."""
REFUSED = 5
"""Commands refused in a row after which a run is given up."""


class RunAborted(DrawbarError):  # noqa: N818 -- an outcome, not a mistake
    """The run was given up before the end of the path; the log holds all steps up to then."""


def drive(autopilot: Autopilot, *, time_limit: float) -> Iterator[StepRecord]:
    """Yield the record of every step until the tractor reaches the end of the path.

    Args:
        autopilot: the control step.
        time_limit: s, after which the run is given up.

    Raises:
        RunAborted: the vehicle left the path, had no fix for too long, had its commands refused, or did not arrive in
            time.
    """
    last_fix, refused = 0.0, 0
    while not autopilot.guidance.finished:
        record = autopilot.step()
        yield record
        time, error = record.measurement.time, record.reference.tractor.lateral_error
        last_fix = time if _has_fix(record.estimate) else last_fix
        refused = refused + 1 if record.command_refused else 0
        if not abs(error) <= LOST:  # also when it is NaN
            raise RunAborted(f"At {time:.1f} s the tractor was {abs(error):.2f} m from the path (limit {LOST} m).")
        if time - last_fix > BLIND:
            raise RunAborted(f"At {time:.1f} s neither antenna had had a valid fix for more than {BLIND:.0f} s.")
        if refused >= REFUSED:
            raise RunAborted(f"At {time:.1f} s the gate had refused {refused} commands in a row.")
        if time > time_limit:
            raise RunAborted(f"The path was not finished within {time_limit:.0f} s; raise speed or look at the log.")


def longest_time(length: float, speed: float) -> float:
    """Return the time (s) after which a run along a path of this length (m) at this set speed (m/s) is given up."""
    return 60.0 + 3.0 * length / speed


def _has_fix(estimate: Estimate) -> bool:
    """Return whether a fix was believed; one that a receiver repeats is none."""
    return FixStatus.ACCEPTED in (estimate.tractor_fix, estimate.trailer_fix)
