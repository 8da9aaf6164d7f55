"""File of recorded bytes, played back at their pace: a text line `seconds hex [source]` per piece, `-` for no bytes."""

import math
import time
from collections.abc import Iterator
from pathlib import Path

from drawbar.errors import HardwareError
from drawbar.transports.address import FileAddress
from drawbar.transports.base import Received, Transport
from drawbar.transports.clock import Clock


def piece_of(line: str) -> Received:
    """Return the piece that a line of a recording holds; ValueError: it is none."""
    stamp, data, *source = line.split()
    seconds = float(stamp)
    if not math.isfinite(seconds) or len(source) > 1:
        raise ValueError(line)
    return Received(seconds, bytes.fromhex(data.removeprefix("-")), "".join(source))


class FileTransport(Transport):
    """A recording. Its first piece comes at the first `read`, the others as much later as they came then."""

    def __init__(self, address: FileAddress, clock: Clock = time.monotonic) -> None:
        """Open; raises HardwareError where the file cannot be read."""
        self.address = address
        self.connected = True
        self._clock = clock
        self._shift: float | None = None
        """from the recording's time to now, s"""
        path = Path(address.path)
        if path.exists() and not path.is_file():  # of a device or a pipe, reading might never end
            raise HardwareError(f"recording {path}: is no file; a serial line is written serial:{path}@115200")
        try:
            self._file = path.open(encoding="ascii", errors="replace")
        except OSError as error:
            raise HardwareError(f"recording {address.path}: cannot be read ({error.strerror})") from None
        self._pieces = self._read_pieces()
        self._coming = next(self._pieces, None)

    def fileno(self) -> int:
        """Return -1: a recording is asked again and again."""
        return -1

    def read(self) -> list[Received]:
        """Return the pieces whose time has come; after the last one it is not connected any more."""
        now = self._clock()
        due: list[Received] = []
        while self._coming is not None:
            if self._shift is None:
                self._shift = now - self._coming.time
            moment = self._coming.time + self._shift
            if moment > now:
                return due
            due.append(Received(moment, self._coming.data, self._coming.source))
            self._coming = next(self._pieces, None)
        self.connected = False
        return due

    def write(self, data: bytes) -> bool:
        """Return False: a recording takes nothing."""
        self.unsent += len(data)
        return False

    def close(self) -> None:
        """Close the file."""
        self.connected = False
        self._coming = None
        self._file.close()

    def _read_pieces(self) -> Iterator[Received]:
        for number, line in enumerate(self._file, start=1):
            try:
                yield piece_of(line)
            except ValueError:
                self.trouble = (
                    f"recording {self.address.path}, line {number} is not `seconds hex [source]`; it ends here"
                )
                return
        self.trouble = f"recording {self.address.path} has ended"
