"""Process output: what the processes of a drive write to standard output and error, in memory and in the run's folder.

They write into memory, which keeps none of them waiting: on a disk that hangs, the gate would be late for a word. A
thread copies it to the file.
"""

import faulthandler
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_PERIOD = 0.5
"""between two looks whether there is something to copy, s"""
_ENDING = 5.0
"""longest that the end waits for the disk, s"""


class ProcessOutput:
    """What was written, from the beginning."""

    def __init__(self, file: Path) -> None:
        """Begin with an empty file.

        Raises:
            OSError: the file cannot be created.
        """
        file.write_bytes(b"")
        self._file, self._copied, self.trouble = file, 0, ""
        """why the file lacks the end of it; empty: it does not"""
        self.descriptor = os.memfd_create("messages")
        """to be given to the processes"""
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._copy_on, name="messages", daemon=True)
        self._thread.start()

    @property
    def text(self) -> str:
        """Return what was written."""
        return self._read(0).decode(errors="replace")

    @property
    def closed(self) -> bool:
        """Whether it was closed."""
        return self._ending.is_set()

    def close(self) -> None:
        """Copy the rest, but wait no longer than some seconds for the disk; the text can still be read."""
        self._ending.set()
        self._thread.join(_ENDING)
        if self._thread.is_alive():
            self.trouble = "the disk hangs"

    def _read(self, begin: int) -> bytes:
        return os.pread(self.descriptor, os.fstat(self.descriptor).st_size - begin, begin)

    def _copy_on(self) -> None:
        while not self._ending.wait(_PERIOD):
            self._copy()
        self._copy()

    def _copy(self) -> None:
        """Append what is new; what finds no room, or no folder, is tried again."""
        data = self._read(self._copied)
        if not data:
            self.trouble = ""
            return
        try:
            with self._file.open("r+b") as stream:
                stream.seek(self._copied)
                stream.write(data)
        except OSError as error:
            self.trouble = error.strerror or str(error)
            return
        self.trouble = ""
        self._copied += len(data)


@contextmanager
def crashes_written(file: Path) -> Iterator[None]:
    """Let a crash of this very process, after which nobody copies, leave where it was behind what is in a file.

    Where Python is to tell that already (-X faulthandler), it does so as it was told.

    Raises:
        OSError: the file cannot be opened.
    """
    if faulthandler.is_enabled():
        yield
        return
    with file.open("ab") as stream:
        faulthandler.enable(stream)
        try:
            yield
        finally:
            faulthandler.disable()
