"""Drive a path from its start to its end, step by step."""

from collections.abc import Iterator

from drawbar.errors import DrawbarError
from drawbar.safety.gate import PATIENCE
from drawbar.safety.supervisor import BLIND, LOST, Supervision, Supervisor
from drawbar.signals import GateVerdict, StepRecord
from drawbar.step.autopilot import Autopilot


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
    supervisor = Supervisor()
    while not autopilot.guidance.finished:
        record = autopilot.step()
        yield record
        time, tractor = record.measurement.time, record.reference.tractor
        found = supervisor.watch(record.estimate, tractor)
        if found is Supervision.OFF_COURSE:
            distance = abs(tractor.lateral_error)
            raise RunAborted(f"At {time:.1f} s the tractor was {distance:.2f} m from the path (limit {LOST} m).")
        if found is Supervision.BLIND:
            raise RunAborted(f"At {time:.1f} s neither antenna had had a valid fix for more than {BLIND:.0f} s.")
        if record.gate is GateVerdict.STOPPED:
            raise RunAborted(f"At {time:.1f} s the gate had had no valid command to let pass for {PATIENCE} s.")
        if time > time_limit:
            raise RunAborted(f"The path was not finished within {time_limit:.0f} s; raise speed or look at the log.")


def longest_time(length: float, speed: float) -> float:
    """Return the time (s) after which a run along a path of this length (m) at this set speed (m/s) is given up."""
    return 60.0 + 3.0 * length / speed
