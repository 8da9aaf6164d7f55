"""Events of a drive in its log: states of the supervisor, what operators asked for, steering without a record."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path

import msgspec

from drawbar.errors import DrawbarError
from drawbar.messages import Action, SupervisorState
from drawbar.recording.frames import DamagedLogError
from drawbar.recording.stream import LoggedMessage, read_records
from drawbar.safety.causes import BY_CODE, Cause
from drawbar.statuses import Status


@dataclass(frozen=True, slots=True, kw_only=True)
class Became:
    """The supervisor's state is another one."""

    time: float
    """s since the epoch"""
    state: SupervisorState
    cause: Cause | None
    """that led to it"""
    status: Status | None = None
    """with which the controller's run has ended, where that is the cause"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """An operator asked for something; presence is no event."""

    time: float
    """s since the epoch"""
    action: Action
    value: float
    """of a speed (m/s) or a shift of the line (m); NaN: none"""


class Loss(Enum):
    """What became of the record while the vehicle was steered."""

    UNRECORDED = "nothing is recorded"
    ENDS = "the record ends while drawbar steers: the disk was full, or recorder, gate or computer failed"


@dataclass(frozen=True, slots=True, kw_only=True)
class Lost:
    """The recorder did not answer, or the record ends, while the vehicle was steered."""

    time: float
    """s since the epoch"""
    loss: Loss


DriveEvent = Became | Asked | Lost


@dataclass(frozen=True, slots=True)
class _Stepped:
    """The status of the controller's steps is another one."""

    time: float
    status: Status


class _Gate(msgspec.Struct):
    state: int
    cause: int
    steers: int
    refusals: list[int]

    @property
    def is_unrecorded(self) -> bool:
        """Whether it steers while the recorder does not answer; what waited for it may be recorded after all."""
        return bool(self.steers) and Cause.NOT_RECORDING.value in self.refusals


class _Wish(msgspec.Struct):
    action: int
    nonce: int
    value: float | None = math.nan


class _Controller(msgspec.Struct):
    status: int


def drive_events(log: Path, *, is_on: bool = False) -> list[DriveEvent]:
    """Return what happened, in order; empty for a run in simulation, which has no supervisor.

    Args:
        log: of the run.
        is_on: the run is being recorded now, so that the log's end is no event.

    Raises:
        DrawbarError: the log cannot be read.
    """
    try:
        with log.open("rb") as stream:
            messages = (each for each in read_records(stream) if isinstance(each, LoggedMessage))
            happened = sorted(_events(messages, is_on=is_on), key=lambda event: event.time)
    except (OSError, DamagedLogError, ValueError) as error:  # what is no message of these, too
        raise DrawbarError(f"{log}: cannot be read ({error})") from error
    return list(_with_statuses(happened))


def _with_statuses(happened: Iterable["DriveEvent | _Stepped"]) -> Iterator[DriveEvent]:
    """Yield the events, in order; those of the controller say with which status its run has ended."""
    status = Status.OK
    for event in happened:
        if isinstance(event, _Stepped):
            status = event.status
        elif isinstance(event, Became) and event.cause is Cause.CONTROLLER_STOPS and status.has_ended:
            yield replace(event, status=status)
        else:
            yield event


def _events(messages: Iterator[LoggedMessage], *, is_on: bool) -> Iterator["DriveEvent | _Stepped"]:
    """Yield what happened; events of one topic in the order of their times."""
    end, last, heard, status = 0.0, None, set(), 0
    gate, wishes, controller = (
        msgspec.json.Decoder(_Gate),
        msgspec.json.Decoder(_Wish),
        msgspec.json.Decoder(_Controller),
    )
    for message in messages:
        time = message.publish_time * 1e-9
        end = max(end, time)
        if message.topic == "/controller":
            before, status = status, controller.decode(message.data).status
            if status != before:
                yield _Stepped(time, Status(status))
        elif message.topic == "/gate":
            now = gate.decode(message.data)
            if last is None or now.state != last.state:
                yield _became(time, now)
            if now.is_unrecorded and not (last is not None and last.is_unrecorded):
                yield Lost(time=time, loss=Loss.UNRECORDED)
            last = now
        elif message.topic == "/operator":
            wish = wishes.decode(message.data)
            action = Action(wish.action)
            if action is not Action.PRESENT and wish.nonce not in heard:
                heard.add(wish.nonce)
                yield Asked(time=time, action=action, value=math.nan if wish.value is None else wish.value)
    if last is not None and last.steers and not is_on:  # whoever ends a drive lets go first, and that is recorded
        yield Lost(time=end, loss=Loss.ENDS)


def _became(time: float, now: _Gate) -> Became:
    state = SupervisorState(now.state)
    return Became(time=time, state=state, cause=None if state is SupervisorState.READY else BY_CODE.get(now.cause))
