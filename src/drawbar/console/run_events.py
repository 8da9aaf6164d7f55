"""Events of a drive in plain words, from its log: what the supervisor did and why, and what operators asked for."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import msgspec

from drawbar.console.words import Words
from drawbar.errors import DrawbarError
from drawbar.messages import Action, SupervisorState
from drawbar.recording.frames import DamagedLogError
from drawbar.recording.stream import LoggedMessage, read_records
from drawbar.safety.causes import BY_CODE, Cause

_ASKED = {
    Action.ARM: "arm",
    Action.ENGAGE: "engage",
    Action.RELEASE: "release",
    Action.STOP: "stop",
    Action.EMERGENCY: "emergency",
    Action.ACKNOWLEDGE: "acknowledge",
    Action.NUDGE: "line_shift",
    Action.SET_SPEED: "set_speed",
}
"""catalogue's key of what an operator asks for; presence is no event"""


class _Gate(msgspec.Struct):
    state: int
    cause: int
    steers: int
    refusals: list[int]

    @property
    def is_unrecorded(self) -> bool:
        """Whether it steers while the recorder does not answer; what waited for it may be recorded after all."""
        return bool(self.steers) and Cause.NOT_RECORDING.value in self.refusals


class _Asked(msgspec.Struct):
    action: int
    nonce: int
    value: float | None = math.nan


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
    try:
        with log.open("rb") as stream:
            messages = (each for each in read_records(stream) if isinstance(each, LoggedMessage))
            return sorted(_events(messages, words, is_on=is_on), key=lambda event: event.time)
    except (OSError, DamagedLogError, msgspec.MsgspecError) as error:
        raise DrawbarError(f"{log}: cannot be read ({error})") from error


def _events(messages: Iterator[LoggedMessage], words: Words, *, is_on: bool) -> Iterator[RunEvent]:
    """Yield what happened; events of one topic in the order of their times."""
    end, last, heard = 0.0, None, set()
    gate, asked = msgspec.json.Decoder(_Gate), msgspec.json.Decoder(_Asked)
    for message in messages:
        time = message.publish_time * 1e-9
        end = max(end, time)
        if message.topic == "/gate":
            now = gate.decode(message.data)
            if last is None or now.state != last.state:
                yield RunEvent(time=time, text=_became(now, words))
            if now.is_unrecorded and not (last is not None and last.is_unrecorded):
                yield RunEvent(time=time, text=words.cause(Cause.NOT_RECORDING)[0])
            last = now
        elif message.topic == "/operator":
            wish = asked.decode(message.data)
            action = Action(wish.action)
            if action in _ASKED and wish.nonce not in heard:
                heard.add(wish.nonce)
                yield RunEvent(time=time, text=_wished(action, wish.value, words))
    if last is not None and last.steers and not is_on:  # whoever ends a drive lets go first, and that is recorded
        yield RunEvent(time=end, text=words("record_ends"))


def _became(now: _Gate, words: Words) -> str:
    state = SupervisorState(now.state)
    text = words(state.name)
    if now.cause and state is not SupervisorState.READY:
        text += ". " + words("because", cause=words.cause(BY_CODE[now.cause])[0])
    return text


def _wished(action: Action, value: float | None, words: Words) -> str:
    text = words("operator_pressed", what=words(_ASKED[action]))
    if value is None or action not in (Action.NUDGE, Action.SET_SPEED):
        return text
    number = words.number(3.6 * value, 1) + " km/h" if action is Action.SET_SPEED else f"{100.0 * value:.0f} cm"
    return f"{text} {number}"
