"""Engageable: when a drive in which drawbar only looked on could have been engaged, and what stood against it."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from drawbar.driving.operator.display import OF_ANGLES, UNTRIED, notices, refusals
from drawbar.geometry import Floats
from drawbar.messages import ControllerState, GateState, Message, SupervisorState
from drawbar.recording.drive_records import read_messages
from drawbar.safety.causes import BY_CODE, Cause

_WAITING = (SupervisorState.STANDBY, SupervisorState.READY)
_OF_SHADOWS = {Cause.SHADOW, *UNTRIED}
"""what stands against engaging in a shadow drive alone"""


class Stretch(NamedTuple):
    """A time in which the same stood against engaging."""

    begin: float
    """s since the epoch"""
    end: float
    causes: tuple[Cause, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Engageable:
    """What stood against engaging while the gate waited for it and the controller had reported."""

    stretches: tuple[Stretch, ...]
    """ascending; between them nothing is known"""

    @classmethod
    def of(cls, messages: Iterable[tuple[float, Message]]) -> Self:
        """Judge the states of gate and controller, given with their times, s since the epoch."""
        found, measured = list[Stretch](), False
        controller: ControllerState | None = None
        newest, against = 0.0, None  # of the gate's states
        for time, message in messages:
            if isinstance(message, ControllerState):
                controller = message
            elif isinstance(message, GateState) and time >= newest:  # one may be recorded behind a newer one
                if against is not None:
                    _append(found, Stretch(newest, time, against))
                newest, against = time, _against(message, controller)
                measured |= bool(message.tractor_angle_time and message.trailer_angle_time)
        return cls(stretches=tuple(found if measured else map(_without_angles, found)))

    @property
    def judged(self) -> float:
        """How long it is known, s."""
        return sum(each.end - each.begin for each in self.stretches)

    @property
    def free(self) -> float:
        """How long nothing stood against engaging, s."""
        return sum(each.end - each.begin for each in self.stretches if not each.causes)

    def durations(self) -> dict[Cause, float]:
        """Return for how long each cause stood against engaging, s, the longest first."""
        lasted = dict[Cause, float]()
        for begin, end, causes in self.stretches:
            for cause in causes:
                lasted[cause] = lasted.get(cause, 0.0) + end - begin
        return dict(sorted(lasted.items(), key=lambda item: -item[1]))

    def at(self, times: Floats) -> NDArray[np.bool_]:
        """Return at which times (n,), s since the epoch, nothing stood against engaging."""
        if not self.stretches:
            return np.zeros(len(times), dtype=bool)
        begins, ends = (np.array([getattr(each, edge) for each in self.stretches]) for edge in ("begin", "end"))
        free = np.array([not each.causes for each in self.stretches])
        place = np.maximum(begins.searchsorted(times, "right") - 1, 0)
        within: NDArray[np.bool_] = free[place] & (begins[place] <= times) & (times <= ends[place])
        return within


def read_engageable(file: Path) -> Engageable:
    """Read what stood against engaging in a drive from its log.

    Raises:
        DrawbarError: the log cannot be read.
    """
    return Engageable.of(read_messages(file, GateState, ControllerState))


def _against(state: GateState, controller: ControllerState | None) -> tuple[Cause, ...] | None:
    """Return what stands against engaging, as an operator sees it, but for what a shadow brings; None: not known."""
    if state.state not in _WAITING or controller is None:
        return None
    present = [BY_CODE[code] for code in state.refusals if code in BY_CODE and BY_CODE[code] not in _OF_SHADOWS]
    seen = replace(state, refusals=tuple(cause.value for cause in present))
    return tuple(refusals(seen, controller) or (present and notices(controller, seen)) or present)


def _append(found: list[Stretch], stretch: Stretch) -> None:
    """Append a stretch to others, or lengthen the last of them."""
    if found and found[-1].end == stretch.begin and found[-1].causes == stretch.causes:
        found[-1] = found[-1]._replace(end=stretch.end)
    else:
        found.append(stretch)


def _without_angles(stretch: Stretch) -> Stretch:
    return stretch._replace(causes=tuple(cause for cause in stretch.causes if cause not in OF_ANGLES))
