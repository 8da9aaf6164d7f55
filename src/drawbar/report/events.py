"""Events of a drive for its report: when, and what the supervisor did, why and what helps, what operators asked for."""

import math
from collections.abc import Iterator, Sequence

from drawbar.driving.operator.display import MEANINGS, of_actuators
from drawbar.messages import Action
from drawbar.recording.drive_events import Asked, Became, DriveEvent, Noticed, Refused
from drawbar.report.tables import Row
from drawbar.safety.causes import Cause

_ASKED = {
    Action.ARM: "to arm",
    Action.ENGAGE: "to engage",
    Action.RELEASE: "to release the steering",
    Action.STOP: "for a stop",
    Action.EMERGENCY: "for an emergency stop",
    Action.ACKNOWLEDGE: "to acknowledge",
    Action.NUDGE: "to shift the line by",
    Action.SET_SPEED: "for a speed of",
    Action.LINE: "for the line at",
}
"""what follows "the operator asked"; of the last three before the value"""


def event_rows(events: Sequence[DriveEvent]) -> list[Row]:
    """Return of each event the time since the first one (s), what happened, and what to do about it."""
    return [(f"{event.time - events[0].time:.1f} s", list(_described(event))) for event in events]


def _described(event: DriveEvent) -> Iterator[str]:
    """Yield what happened, and what to do, which may be nothing."""
    if isinstance(event, Became) and event.cause is Cause.ENDED:
        yield "the drive was ended"
        yield ""
    elif isinstance(event, Became):
        cause = event.cause
        because = [MEANINGS[event.state] if cause is None else f"{cause.sentence}{of_actuators(event.concerned)}"]
        yield ": ".join([event.state.name, *because, *([event.status.text] if event.status is not None else [])])
        yield "" if cause is None else cause.advice
    elif isinstance(event, Asked):
        yield f"the operator asked {_ASKED[event.action]}{_value(event)}"
        yield ""
    elif isinstance(event, Refused):
        yield f"refused: {event.cause.sentence}"
        yield event.cause.advice
    elif isinstance(event, Noticed):
        yield event.cause.sentence
        yield event.cause.advice
    else:
        yield event.loss.value
        yield ""


def _value(event: Asked) -> str:
    """Return what was asked for with an action, in its unit of measure."""
    units = {Action.SET_SPEED: " m/s", Action.NUDGE: " m", Action.LINE: " working widths"}
    if event.action not in units or math.isnan(event.value):
        return ""
    return f" {event.value:g}{units[event.action]}"
