"""Steps: how many of a machine's integration steps make up a time."""

import math

from drawbar.errors import ConfigurationError


def whole_steps(duration: float, step: float) -> int | None:
    """Return how many steps make up the duration, or None when it is not a multiple of the step."""
    steps = round(duration / step)
    return steps if math.isclose(steps * step, duration, rel_tol=1e-9, abs_tol=1e-12) else None


def demand_whole_steps(name: str, duration: float, step: float) -> None:
    """Raise ValueError where a duration of the settings, s, is not a multiple of the integration step."""
    if whole_steps(duration, step) is None:
        raise ValueError(f"{name} = {duration} s is not a multiple of step = {step} s; round it to a multiple")


def steps_per_sample(sample_time: float, step: float) -> int:
    """Return how many integration steps make up a sample.

    Raises ConfigurationError when the sample time is not a positive multiple of the step.
    """
    steps = whole_steps(sample_time, step)
    if not steps:
        raise ConfigurationError(
            f"the sample time {sample_time} s is not a positive multiple of machine.step = {step} s; "
            "set machine.step so that it divides the sample time, such as 0.01"
        )
    return steps
