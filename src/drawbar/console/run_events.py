"""Events of a drive in plain words: what the supervisor did and why, operators' requests and refusals, notices."""

import math
from dataclasses import dataclass
from pathlib import Path

from drawbar.console.language.words import Words
from drawbar.messages import Action
from drawbar.recording.drive_events import Asked, Became, DriveEvent, Loss, Noticed, Refused, drive_events
from drawbar.safety.causes import Cause

_ASKED = {
    Action.ARM: "arm",
    Action.ENGAGE: "engage",
    Action.RELEASE: "release",
    Action.STOP: "stop",
    Action.EMERGENCY: "emergency",
    Action.ACKNOWLEDGE: "acknowledge",
    Action.NUDGE: "line_shift",
    Action.SET_SPEED: "set_speed",
    Action.LINE: "pass_number",
}
"""catalogue's key of what an operator asks for"""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunEvent:
    """Something that happened."""

    time: float
    """s since the epoch"""
    text: str


def run_events(log: Path, words: Words, *, is_on: bool = False) -> list[RunEvent]:
    """Return what happened, in order; empty for a run in simulation, which has no supervisor.

    Args:
        log: of the run.
        words: texts.
        is_on: the run is being recorded now, so that the log's end is no event.

    Raises:
        DrawbarError: the log cannot be read.
    """
    return [RunEvent(time=each.time, text=_described(each, words)) for each in drive_events(log, is_on=is_on)]


def _described(event: DriveEvent, words: Words) -> str:
    if isinstance(event, Became):
        return _became(event, words)
    if isinstance(event, Asked):
        return _wished(event.action, event.value, words)
    if isinstance(event, Refused):
        sentence, advice = words.cause(event.cause)
        return words("refused", cause=sentence, advice=advice)
    if isinstance(event, Noticed):
        return ". ".join(words.cause(event.cause))
    return words("record_ends") if event.loss is Loss.ENDS else words.cause(Cause.NOT_RECORDING)[0]


def _became(event: Became, words: Words) -> str:
    if event.cause is Cause.ENDED:
        return words("drive_ended")
    text = words(event.state.name)
    if event.cause is not None:
        text += ". " + words(
            "because", cause=words.led(event.cause, event.status) + words.of_actuators(event.concerned)
        )
    return text


def _wished(action: Action, value: float, words: Words) -> str:
    text = words("operator_pressed", what=words(_ASKED[action]))
    if math.isnan(value):
        return text
    if action is Action.NUDGE:
        return f"{text} {100.0 * value:.0f} cm"
    if action is Action.SET_SPEED:
        return f"{text} {words.number(3.6 * value, 1)} km/h"
    return f"{text} {value:.0f}" if action is Action.LINE else text
