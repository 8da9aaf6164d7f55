"""Log of a drive: besides every control step the raw bytes, the messages between the processes, and a scene to look at.

| topic | what |
|---|---|
| `/step` | every control step, as in any log |
| `/raw` | bytes as they went over the devices' wires, with their times: `drive_records.py` |
| `/order` | in which order each process took in what it did: `drive_records.py` |
| `/fixes`, `/command`, `/controller`, `/gate`, `/operator` | messages between the processes: `message_layout.py` |
| `/events` | what happened, in words (foxglove.Log) |
| `/tractor/fix`, `/trailer/fix`, `/tf`, `/path`, `/bodies`, `/plan` | map and scene (foxglove.*): `scene.py` |
"""

import os
import time
from collections import deque
from pathlib import Path
from typing import Any

from foxglove import Schema
from foxglove.messages import Log, LogLevel, Timestamp

from drawbar.errors import StorageError
from drawbar.messages import ControllerState, GateState, Message
from drawbar.recording.chunk import LEVEL
from drawbar.recording.drive_records import (
    CLOCK,
    ORDER,
    RAW,
    TOPICS,
    Happening,
    Order,
    RawBytes,
    pack_order,
    pack_raw,
)
from drawbar.recording.live import Live
from drawbar.recording.log import STEP_TOPIC, Outcome, RunHeader
from drawbar.recording.message_layout import message_schema, pack_message
from drawbar.recording.recorder import CDR, DEFINITION, STEP_NAME, Recorder
from drawbar.recording.scene import Scene
from drawbar.safety.causes import BY_CODE, Cause
from drawbar.safety.engagement import LATCHED
from drawbar.signals import Status, StepRecord
from drawbar.step.layout import HEAD, packed, step_schema
from drawbar.transports.clock import MachineClock

_REAL_TIME = MachineClock()
REAL_TIME_LEVEL = 19
"""of the compression: a fifth less than at level 1 (benchmark/log_channels.py), in a process of its own"""
_STATES = 1000
"""of the gate that are known by their sequence"""
_AGAIN = 10
"""steps after which what does not change is shown again, live"""
_LEVELS = {"info": LogLevel.Info, "warning": LogLevel.Warning, "error": LogLevel.Error}


class DriveLog(Recorder):
    """The log of a drive as a context; all times are monotonic, ns, and come out as times of the computer's clock.

    Those of a stand-in that is faster than real time come out as if it had begun at the same time, and were not.
    """

    def __init__(
        self,
        file: Path,
        header: RunHeader,
        scene: Scene,
        live: Live | None = None,
        clock: MachineClock = _REAL_TIME,
    ) -> None:
        """Create the file, and draw what does not change.

        Args:
            file: to be written.
            header: of the run.
            scene: to be drawn.
            live: where all of it is shown at once too.
            clock: of the drive.

        Raises:
            DrawbarError: the file cannot be created.
        """
        super().__init__(file, header, level=REAL_TIME_LEVEL if clock.pace == 1 else LEVEL)
        self._scene, self._live, self._offset = scene, live, time.time_ns() - clock.nanoseconds()
        self._clock, self.flushed = clock, clock.nanoseconds()
        """when all that was added was handed to the operating system the last time, monotonic, ns"""
        self._states: deque[int] = deque(maxlen=_STATES)
        self._pieces: list[RawBytes] = []
        self._happenings: list[Happening] = []
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._steps_shown, self._reached_end = 0, False
        self._state: GateState | None = None
        self._steered: bool | None = None
        self._status, self._names = Status.OK, self._count_names()
        self._writer.add_metadata(CLOCK, {"offset": str(self._offset)})
        for topic, message in scene.standing(time.time_ns()):
            self._add_known(topic, message, time.time_ns())

    def add_step(self, moment: int, record: StepRecord) -> None:
        """Add a control step; it waits for `flush`."""
        wall = moment + self._offset
        self._reached_end |= record.status is Status.FINISHED
        if STEP_TOPIC not in self._channels:
            schema = step_schema(len(record.plan.tractor.steerings)).encode()
            self._open(STEP_TOPIC, CDR, Schema(name=STEP_NAME, encoding=DEFINITION, data=schema))
        self._add(STEP_TOPIC, HEAD + packed(record), wall, record.step)
        for topic, message in self._scene.moving(wall, record):
            self._add_known(topic, message, wall)
        self._show_again(wall)

    def _outcome(self, error: BaseException | None) -> Outcome:
        if error is None and not self._reached_end:
            ended = f"the drive was ended before the end of the path{self._unsteered()}{self._stopped_by()}"
            return Outcome(finished=False, reason=ended)
        return super()._outcome(error)

    def _unsteered(self) -> str:
        """Return that it was never steered, in words that follow others; nothing where it was, or nothing is known."""
        return "; drawbar never steered" if self._steered is False else ""

    def _stopped_by(self) -> str:
        """Return what had stopped it, in words that follow others; nothing where it had not been stopped."""
        if self._state is None or self._state.state not in LATCHED or self._state.cause not in BY_CODE:
            return ""
        cause = BY_CODE[self._state.cause]
        ended = f": {self._status.text}" if cause is Cause.CONTROLLER_STOPS and self._status.has_ended else ""
        return f"; {self._state.state.name}: {cause.sentence}{ended}"

    def flush(self) -> None:
        """Let all that was added reach the operating system.

        Raises:
            StorageError: the file was removed, and nobody could read it.
        """
        self._add_waiting()
        self._writer.flush()
        self.flushed = self._clock.nanoseconds()
        if self._names and not self._count_names():
            raise StorageError(f"{self._file}: the log was removed while it was written; start drawbar again")

    def _count_names(self) -> int:
        """Return how many names the file has; 0: it was removed, or this file system does not count."""
        return os.fstat(self._stream.fileno()).st_nlink

    @property
    def is_in_place(self) -> bool:
        """Whether the file is where it was made: its folder was not moved, and its disk is there."""
        try:
            return os.path.samestat(os.stat(self._file), os.fstat(self._stream.fileno()))
        except OSError:
            return False

    def _finish(self, outcome: Outcome) -> None:
        self._add_waiting()
        super()._finish(outcome)

    def _show_again(self, wall: int) -> None:
        """Show from time to time what does not change: whoever came late has not seen it."""
        if self._live is None:
            return
        if self._steps_shown % _AGAIN == 0:
            for topic, message in self._scene.standing(wall):
                self._live.send(topic, message.encode(), wall)
        self._steps_shown += 1

    def add_raw(self, raw: RawBytes) -> None:
        """Add bytes of a device; they wait for `flush`."""
        self._pieces.append(raw)

    def add_order(self, order: Order) -> None:
        """Add what one of the processes did; it waits for `flush`."""
        self._happenings += order.happenings

    def _add_waiting(self) -> None:
        """Add what waits as one message of each kind, since the index takes 16 bytes a message; bytes before looks."""
        if self._pieces:
            self._add_plain(RAW, pack_raw(self._pieces), self._pieces[-1].time)
            self._pieces.clear()
        if self._happenings:
            order = Order(tuple(self._happenings))
            self._add_plain(ORDER, pack_order(order), order.time)
            self._happenings.clear()

    def add_message(self, message: Message) -> None:
        """Add a record of one of the processes; a kind that has no topic is left out.

        States of the gate come twice, from the gate and from the controller that received them, and are added once.
        """
        if isinstance(message, ControllerState):
            self._status = Status(message.status)
        topic = TOPICS.get(type(message))
        if topic is None or (isinstance(message, GateState) and message.sequence in self._states):
            return
        if isinstance(message, GateState):
            self._states.append(message.sequence)
            self._steered = bool(self._steered or message.steers)
            if message.cause != Cause.ENDED.value:  # the end itself hides what was before
                self._state = message
        if topic not in self._channels:
            name, data = f"drawbar/msg/{type(message).__name__}", message_schema(type(message)).encode()
            self._open(topic, CDR, Schema(name=name, encoding=DEFINITION, data=data))
        self._add(topic, pack_message(message), message.time + self._offset)

    def add_event(self, moment: int, level: str, name: str, text: str) -> None:
        """Add a message in words; level is info, warning or error."""
        wall = moment + self._offset
        stamp = Timestamp(*divmod(wall, 1_000_000_000))
        self._add_known("/events", Log(timestamp=stamp, level=_LEVELS[level], message=text, name=name), wall)

    def _add_known(self, topic: str, message: Any, wall: int) -> None:
        """Add a message with a well-known schema."""
        if topic not in self._channels:
            self._open(topic, "protobuf", message.get_schema())
        self._add(topic, message.encode(), wall)

    def _add_plain(self, topic: str, data: bytes, moment: int) -> None:
        """Add bytes that have no schema."""
        if topic not in self._channels:
            self._open(topic, "application/octet-stream", None)
        self._add(topic, data, moment + self._offset)

    def _open(self, topic: str, encoding: str, schema: Schema | None) -> None:
        number = 0
        if schema is not None:
            if schema.name not in self._schemas:
                self._schemas[schema.name] = self._writer.add_schema(schema.name, schema.encoding, schema.data)
            number = self._schemas[schema.name]
        self._channels[topic] = self._writer.add_channel(topic, encoding, number)
        if self._live is not None and schema is not None:
            self._live.open(topic, encoding, schema)

    def _add(self, topic: str, data: bytes, wall: int, sequence: int = 0) -> None:
        number = self._channels[topic]
        self._writer.add_message(number, data, log_time=wall, publish_time=wall, sequence=sequence % 2**32)
        if self._live is not None:
            self._live.send(topic, data, wall)
