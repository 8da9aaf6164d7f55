"""Background writer: writes a drive's log in a thread of its own, so that a slow disk keeps nobody waiting.

What comes while the disk is busy waits in memory, and is then written in one go: fewer writes, as long as the disk is
slow, and nothing is lost.
"""

import threading
import time
from collections.abc import Callable, Sequence

from drawbar.driving.messaging.datagrams import PackedStep
from drawbar.errors import DrawbarError
from drawbar.messages import Message
from drawbar.messages.records import Flaw
from drawbar.realtime import say
from drawbar.recording.drive_log import DriveLog
from drawbar.recording.drive_records import Order, RawBytes
from drawbar.step.layout import unpacked

Content = RawBytes | Order | PackedStep | Message | Flaw
MOST = 1 << 26
"""bytes that may wait, some minutes of a drive; what comes beyond is lost"""
BUSY = 1.0
"""within which the disk must have taken what was written, s; else nothing counts as recorded until it has"""
_WITHOUT_STEPS = 500_000_000
"""after which what waits is written where no step comes, ns: each time costs some of the compression, and each step
writes all that came before it"""


class BackgroundWriter:
    """Writes contents to a log, in their order, until the disk takes no more."""

    def __init__(self, log: DriveLog, clock: Callable[[], int]) -> None:
        """Begin to write; `clock` is the drive's, ns."""
        self._log, self._clock = log, clock
        self._waiting: list[Content] = []
        self._bytes, self.lost = 0, 0
        """that wait; contents that were lost"""
        self._busy_since = 0.0
        """since when what was taken is being written, s of time.monotonic(); 0: nothing is"""
        self._ending = self._failed = self._astray = False
        self._error: BaseException | None = None
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, name="log", daemon=True)
        self._thread.start()

    def put(self, contents: Sequence[tuple[Content, int]]) -> None:
        """Take in contents with their sizes, bytes, which are written soon.

        Raises:
            Exception: writing failed otherwise than by the disk.
        """
        if self._error is not None:
            raise self._error
        if self._failed or not contents:
            return
        with self._changed:
            for content, size in contents:
                if self._bytes + size > MOST:
                    self._lose()
                    continue
                self._bytes += size
                self._waiting.append(content)
            self._changed.notify()

    @property
    def writes(self) -> bool:
        """Whether what is put in is written, where the log was made, and the disk keeps up."""
        since = self._busy_since
        return not (self._failed or self._error or self._astray or self._bytes > MOST // 2) and (
            not since or time.monotonic() - since < BUSY
        )

    def close(self) -> None:
        """Write what waits, however long that takes, and end."""
        with self._changed:
            self._ending = True
            self._changed.notify()
        self._thread.join()

    def _lose(self) -> None:
        self.lost += 1
        if self.lost == 1:
            say("recorder: the disk is too slow, and what it has not taken is lost")

    def _run(self) -> None:
        try:
            while contents := self._take():
                self._busy_since = time.monotonic()
                self._write(contents)
                self._busy_since = 0.0
        except (OSError, DrawbarError) as error:
            self._failed = True  # nothing is added behind what could not be written
            self._log.give_up()
            say(f"recorder: the log cannot be written any further ({error}); what came before is kept")
        except BaseException as error:
            self._error = error

    def _take(self) -> list[Content]:
        """Return what waits, once something does; nothing at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._ending)
            taken, self._waiting, self._bytes = self._waiting, [], 0
        return taken

    def _write(self, contents: Sequence[Content]) -> None:
        for content in contents:
            self._add(content)
        if any(isinstance(each, PackedStep) for each in contents) or self._clock() - self._log.flushed > _WITHOUT_STEPS:
            self._log.flush()
            self._look()

    def _look(self) -> None:
        """See whether the log is where it was made; it is written on wherever it is."""
        astray, self._astray = self._astray, not self._log.is_in_place
        if self._astray and not astray:
            say("recorder: the log's folder was moved, or its disk unmounted; it is written on wherever it is now")

    def _add(self, content: Content) -> None:
        log = self._log
        if isinstance(content, RawBytes):
            log.add_raw(content)
        elif isinstance(content, Order):
            log.add_order(content)
        elif isinstance(content, PackedStep):
            log.add_step(content.time, unpacked(content.data))
        elif isinstance(content, Flaw):
            log.add_event(self._clock(), "warning", "recorder", f"a record was refused: {content.value}")
        else:
            log.add_message(content)
