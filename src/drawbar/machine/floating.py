"""Floating receivers: errors of their fixes, drawn by themselves, so that all other errors stay as they are."""

import math

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.events import COLUMNS, Event, GpsFloat, active

_NONE = [math.nan] * 4


class Floating:
    """The source of float's errors, sample by sample."""

    def __init__(self, events: tuple[Event, ...], sample_time: float, rng: np.random.Generator) -> None:
        self._events = [event for event in events if isinstance(event, GpsFloat)]
        self._sample_time, self._rng = sample_time, rng
        self._noise: list[Floats | None] = [None] * len(self._events)

    def sample(self, time: float) -> tuple[list[float], list[float]]:
        """Return the errors (4,) of tractor x, y, trailer x, y, and the deviations (4,) that honest receivers report.

        Both in m, of the sample taken at the time (s). NaN: this coordinate is not in float; of a deviation also where
        the receiver reports none.
        """
        if not self._events:
            return _NONE, _NONE
        errors, deviations = np.full(4, np.nan), np.full(4, np.nan)
        for index, event in enumerate(self._events):
            if active(np.array([time]), event.start, event.duration)[0]:
                columns = COLUMNS[event.antenna]
                errors[columns] = event.deviation * self._next(index, event.correlation)[columns]
                if event.honest:
                    deviations[columns] = event.deviation
        return errors.tolist(), deviations.tolist()

    def _next(self, index: int, correlation: float) -> Floats:
        """Return the next values (4,) of an event's noise, of variance one."""
        new, last = self._rng.standard_normal(4), self._noise[index]
        decay = math.exp(-self._sample_time / correlation) if correlation else 0.0
        noise = new if last is None else decay * last + math.sqrt(1.0 - decay * decay) * new
        self._noise[index] = noise
        return noise
