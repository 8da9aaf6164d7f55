"""Events of a drive in its log: states of the supervisor, operators' requests and refusals, notices, a lost record."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from struct import error as StructError  # noqa: N812 -- a class

import msgspec

from drawbar.errors import DrawbarError
from drawbar.messages import Action, SupervisorState
from drawbar.recording.encoding import decode_message
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
    concerned: int = 0
    """which actuators reported the cause, as bits of GateState.engaged"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """An operator asked for something; presence is no event."""

    time: float
    """s since the epoch"""
    action: Action
    value: float
    """of a speed (m/s) or a shift of the line (m); NaN: none"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Refused:
    """The gate refused what an operator had asked for; one event for each cause that stood against it."""

    time: float
    """s since the epoch"""
    cause: Cause


@dataclass(frozen=True, slots=True, kw_only=True)
class Noticed:
    """The controller has reported something of a sensor, for the first time since the vehicle is steered."""

    time: float
    """s since the epoch"""
    cause: Cause


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


DriveEvent = Became | Asked | Refused | Noticed | Lost


class _Gate(msgspec.Struct):
    state: int
    cause: int
    steers: int
    refusals: list[int]
    answer: int = 0
    answered: int = 0
    concerned: int = 0

    @property
    def objections(self) -> list[Cause]:
        """Why the last request was refused: where the gate was in STANDBY, what stood against being ready."""
        is_standby = self.state == SupervisorState.STANDBY
        if BY_CODE.get(self.answer) is Cause.STATE_NOT_READY and is_standby and any(self.refusals):
            return [BY_CODE[code] for code in self.refusals if code in BY_CODE]
        return [BY_CODE[self.answer]] if self.answer in BY_CODE else []

    @property
    def is_unrecorded(self) -> bool:
        """Whether it steers while the recorder does not answer; what waited for it may be recorded after all."""
        return bool(self.steers) and Cause.NOT_RECORDING.value in self.refusals


class _Wish(msgspec.Struct):
    action: int
    nonce: int
    value: float = math.nan


class _Controller(msgspec.Struct):
    status: int
    notices: list[int] = []


_Message = _Gate | _Wish | _Controller | None
"""None: the end of the log"""
_KINDS: dict[str, type[_Gate] | type[_Wish] | type[_Controller]] = {
    "/gate": _Gate,
    "/operator": _Wish,
    "/controller": _Controller,
}


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
            # a state of the gate may have been recorded behind a newer one
            ordered = sorted(_relevant(messages), key=lambda pair: pair[0])
        return list(_without_repetitions(_events(ordered, is_on=is_on)))
    except (OSError, DamagedLogError, ValueError, StructError) as error:  # what is no message of these, too
        raise DrawbarError(f"{log}: cannot be read ({error})") from error


def _relevant(messages: Iterator[LoggedMessage]) -> Iterator[tuple[float, _Message]]:
    """Yield the messages that events are made of, each with its time, and the time of the last message of any kind."""
    end = 0.0
    for message in messages:
        time = message.publish_time * 1e-9
        end = max(end, time)
        if message.topic in _KINDS:
            yield time, msgspec.convert(decode_message(message), _KINDS[message.topic])
    yield end, None


class _Drive:
    """The drive so far, as far as it decides what is an event."""

    def __init__(self) -> None:
        self._gate: _Gate | None = None  # its newest state
        self._status = Status.OK  # of the controller
        self._asked, self._noticed = set[int](), set[int]()  # nonces; codes

    @property
    def steers(self) -> bool:
        """Whether the vehicle is steered."""
        return self._gate is not None and bool(self._gate.steers)

    def controller(self, time: float, message: _Controller) -> Iterator[DriveEvent]:
        """Take in the controller's state."""
        self._status = Status(message.status)
        if not self.steers:
            return
        new = [code for code in message.notices if code in BY_CODE and code not in self._noticed]
        self._noticed.update(new)
        yield from (Noticed(time=time, cause=BY_CODE[code]) for code in new)

    def gate(self, time: float, message: _Gate) -> Iterator[DriveEvent]:
        """Take in the gate's state."""
        before, self._gate = self._gate, message
        if before is None or message.state != before.state:
            yield _became(time, message, self._status)
        if message.is_unrecorded and not (before is not None and before.is_unrecorded):
            yield Lost(time=time, loss=Loss.UNRECORDED)
        if message.answered in self._asked and not (before is not None and before.answered == message.answered):
            yield from (Refused(time=time, cause=cause) for cause in message.objections)
        if not message.steers:
            self._noticed.clear()

    def wish(self, time: float, message: _Wish) -> Iterator[DriveEvent]:
        """Take in what an operator asks for, several times until it is answered."""
        action = Action(message.action)
        if action is Action.PRESENT or message.nonce in self._asked:
            return
        self._asked.add(message.nonce)
        yield Asked(time=time, action=action, value=message.value)


def _events(ordered: Iterable[tuple[float, _Message]], *, is_on: bool) -> Iterator[DriveEvent]:
    """Yield what happened, given messages in the order of their times."""
    drive = _Drive()
    for time, message in ordered:
        if isinstance(message, _Controller):
            yield from drive.controller(time, message)
        elif isinstance(message, _Gate):
            yield from drive.gate(time, message)
        elif isinstance(message, _Wish):
            yield from drive.wish(time, message)
        elif drive.steers and not is_on:  # whoever ends a drive releases first, which is recorded
            yield Lost(time=time, loss=Loss.ENDS)


def _without_repetitions(events: Iterable[DriveEvent]) -> Iterator[DriveEvent]:
    """Leave out what was asked for again before anything else happened, as by a key that is held; shifts add up.

    A refusal is nothing else: it is reported once for each cause.
    """
    last: tuple[Action, str] | None = None
    refused: set[Cause] = set()
    for event in events:
        if isinstance(event, Refused):
            if event.cause not in refused:
                yield event
            refused.add(event.cause)
            continue
        now = (event.action, str(event.value)) if isinstance(event, Asked) else None  # as text NaN is NaN
        if now is None or now != last or now[0] is Action.NUDGE:
            refused.clear()
            yield event
        last = now


def _became(time: float, now: _Gate, status: Status) -> Became:
    state, cause = SupervisorState(now.state), BY_CODE.get(now.cause)
    if state is SupervisorState.READY:
        cause = None
    ended = cause is Cause.CONTROLLER_STOPS and status.has_ended
    return Became(time=time, state=state, cause=cause, status=status if ended else None, concerned=now.concerned)
