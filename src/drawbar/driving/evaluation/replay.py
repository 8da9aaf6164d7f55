"""Replay of a drive: receivers, estimator and controllers once more, from the raw bytes that the log holds.

Bytes go in with the stamps with which they came, and everything is done in the order in which it was done: the log says
when the receivers were looked at, and what the controller took in before each step. What the gate sent is taken over.
"""

from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import takewhile
from pathlib import Path
from typing import TypeVar

from drawbar.config import Configuration, recorded_configuration
from drawbar.driving.devices.receiver_transports import receiver_settings
from drawbar.driving.loop.control_loop import ControlLoop
from drawbar.driving.loop.controller import Controller
from drawbar.driving.messaging.datagrams import Device
from drawbar.driving.stand_in.memory_transports import MemoryTransport
from drawbar.errors import DrawbarError
from drawbar.geometry import LocalFrame
from drawbar.machine.base import EndOfMeasurements
from drawbar.machine.hardware.navigation import Navigation
from drawbar.machine.hardware.receiver import Receiver
from drawbar.machine.hardware.sampler import Sampler
from drawbar.machine.hardware.sensor_line import SensorLine
from drawbar.messages import CommandMessage, Fixes, GateState, Message
from drawbar.nanoseconds import seconds
from drawbar.recompute import Comparison, Replay
from drawbar.recording.drive_records import DriveRecord, Happening, Kind, RawBytes, open_drive
from drawbar.recording.frames import Damage
from drawbar.recording.log import CUT_OFF, Outcome, RunHeader, open_log
from drawbar.signals import StepRecord
from drawbar.transports.tapped import Direction

_COMMANDED = ("mode", "tractor_angle", "trailer_angle", "speed")
_Record = TypeVar("_Record", bound=Message)


def replay_drive(file: Path, changes: Sequence[str] = ()) -> Replay:
    """Recompute a drive from its raw bytes; fixes, steps and commands are compared with what was recorded.

    With the same build of drawbar on the same machine every number is the recorded one, bit for bit; predictions as far
    as they are recorded (step/record.py).

    Args:
        file: log of the drive.
        changes: settings to try instead of the recorded ones, KEY=VALUE.

    Raises:
        DrawbarError: the file is no log of a drive, lacks something, or its configuration cannot be built.
    """
    with open_log(file) as log:
        header = log.header
    configuration = recorded_configuration(header.configuration, changes, "the log's configuration")
    with open_drive(file) as records:
        again = _fixes(records, configuration, header)
    with open_drive(file) as records:
        recorded = _Recorded(records, file)
    comparison = Comparison(common_only=bool(changes))
    return _Controller(configuration, header, recorded, comparison).run(again)


def _fixes(records: Iterator[DriveRecord], configuration: Configuration, header: RunHeader) -> dict[int, Fixes]:
    """Return the receivers' messages, by sequence, from their bytes."""
    lines = {device.topic: MemoryTransport() for device in Device}
    navigation, found = _navigation(configuration, header, lines), dict[int, Fixes]()
    sound = takewhile(lambda record: not isinstance(record, Damage), records)
    inputs = [each for each in sound if isinstance(each, RawBytes | Happening)]
    pieces = deque(each for each in inputs if isinstance(each, RawBytes) and each.direction is Direction.IN)
    looks = [each for each in inputs if isinstance(each, Happening) and each.kind is Kind.LOOK]
    for look in looks:
        for _ in range(min(look.sequence, len(pieces))):
            piece = pieces.popleft()
            lines[piece.device].arrive(seconds(piece.time), piece.data, piece.source)
        found |= {fixes.sequence: fixes for fixes in navigation.poll(seconds(look.time))}
    return found


def _navigation(configuration: Configuration, header: RunHeader, lines: dict[str, MemoryTransport]) -> Navigation:
    devices = configuration.devices
    if devices is None or header.origin is None:
        raise DrawbarError("the log's configuration names no devices, or it is not known where on Earth its path lies")
    latitude, longitude, height = header.origin
    line = lines[Device.SENSORS.topic]
    return Navigation(
        [Receiver(lines[device.topic], settings) for device, settings in receiver_settings(devices).items()],
        LocalFrame(latitude=latitude, longitude=longitude, height=height),
        SensorLine(line, devices.sensors) if devices.sensors is not None else None,
    )


class _Recorded:
    """What the log holds of the controller: what it took in, in which order, and what it made of it."""

    def __init__(self, records: Iterator[DriveRecord], file: Path) -> None:
        self._file = file
        self.order: list[Happening] = []
        self.steps: list[StepRecord] = []
        self.fixes: dict[int, Fixes] = {}
        self.commands: dict[int, CommandMessage] = {}
        self._states: dict[int, GateState] = {}
        self.damage: Damage | None = None
        """behind which nothing can be recomputed"""
        self.outcome = CUT_OFF
        for record in records:
            if isinstance(record, Damage):
                self.damage = record
                break
            self._add(record)

    def _add(self, record: DriveRecord) -> None:
        if isinstance(record, GateState):
            self._states[record.sequence] = record
        elif isinstance(record, Fixes):
            self.fixes[record.sequence] = record
        elif isinstance(record, CommandMessage):
            self.commands[record.sequence] = record
        elif isinstance(record, StepRecord):
            self.steps.append(record)
        elif isinstance(record, Outcome):
            self.outcome = record
        elif isinstance(record, Happening) and record.kind is not Kind.LOOK:
            self.order.append(record)

    @property
    def cut(self) -> str:
        """Why it cannot be recomputed to the end of the drive; empty: it can."""
        if self.damage is not None:
            return str(self.damage)
        return self.outcome.reason if self.outcome is CUT_OFF else ""

    def state(self, sequence: int) -> GateState:
        """Return a state of the gate."""
        return self.known(self._states, sequence, "the gate's state")

    def known(self, records: dict[int, _Record], sequence: int, what: str) -> _Record:
        """Return the record of a sequence; DrawbarError: it was lost. EndOfMeasurements: the log ends before it."""
        if sequence not in records:
            if self.damage is not None or sequence > max(records, default=-1):
                raise EndOfMeasurements
            raise DrawbarError(f"{self._file}: lacks {what} {sequence}, which the controller had; the recorder lost it")
        return records[sequence]


class _Controller:
    """The controller's process once more, repeating what the log recorded."""

    def __init__(
        self, configuration: Configuration, header: RunHeader, recorded: _Recorded, comparison: Comparison
    ) -> None:
        self._recorded, self._comparison, self._now = recorded, comparison, 0
        self._steps: list[StepRecord] = []
        self._loop = ControlLoop(
            Controller(configuration, header.path.path(), configuration.safety.fingerprint()),
            Sampler(configuration.sample_time, has_trailer=configuration.has_trailer_receiver),
            send=self._compare_command,
            record=self._compare_step,
            clock=lambda: self._now,
        )

    def run(self, again: dict[int, Fixes]) -> Replay:
        """Do all of it with these fixes, by sequence, and compare."""
        with suppress(EndOfMeasurements):
            self._do(again)
        return self._comparison.replay(self._steps, cut=self._recorded.cut)

    def _do(self, again: dict[int, Fixes]) -> None:
        for each in self._recorded.order:
            self._now = each.time
            if each.kind is Kind.GATE:
                self._loop.receive_gate(self._recorded.state(each.sequence))
            elif each.kind is Kind.FIXES:
                self._receive_fixes(self._recorded.known(again, each.sequence, "raw bytes of the fixes"))
            elif each.kind is Kind.MISS:
                self._loop.miss()
            else:
                self._loop.repeat(each.time)

    def _receive_fixes(self, fixes: Fixes) -> None:
        self._compare(self._recorded.fixes.get(fixes.sequence), fixes, "fixes.")
        self._loop.receive_fixes(fixes)

    def _compare(self, recorded: Message | None, again: Message, prefix: str, names: Sequence[str] = ()) -> None:
        if recorded is not None:
            self._comparison.add(len(self._steps), recorded, again, prefix, names)

    def _compare_command(self, message: Message) -> None:
        if isinstance(message, CommandMessage):
            self._compare(self._recorded.commands.get(message.sequence), message, "message.", _COMMANDED)

    def _compare_step(self, again: StepRecord) -> None:
        place = len(self._steps)
        self._steps.append(again)
        if place < len(self._recorded.steps):
            recorded = self._recorded.steps[place]
            self._comparison.add(recorded.step, recorded, again)
