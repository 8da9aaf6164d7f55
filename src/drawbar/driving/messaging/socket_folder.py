"""Folder of the sockets of a drive."""

import fcntl
import os
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

from drawbar.driving.messaging.process_options import SOCKETS
from drawbar.errors import HardwareError

_PREFIX, _LOCK = "drawbar-", "lock"
_LONGEST_PATH = 107
"""bytes of a Unix socket's address, which Linux allows"""


class SocketFolder(tempfile.TemporaryDirectory[str]):
    """A new folder, the user's own, with room for the names of sockets; locked as long as its process lives."""

    def __init__(self) -> None:
        """Make it, and remove those whose process was killed.

        Raises:
            HardwareError: the temporary folder's name is too long for sockets.
        """
        _remove_left_behind()
        super().__init__(prefix=_PREFIX)
        longest = _LONGEST_PATH - len(os.sep) - len(max(SOCKETS, key=len))
        if len(os.fsencode(self.name)) > longest:
            super().cleanup()
            raise HardwareError(
                f"the temporary folder {tempfile.gettempdir()} has too long a name for sockets, which may have "
                f"{_LONGEST_PATH} bytes; set TMPDIR to a shorter one, as TMPDIR=/tmp"
            )
        self._lock = (Path(self.name) / _LOCK).open("xb")
        fcntl.flock(self._lock, fcntl.LOCK_EX)

    def cleanup(self) -> None:
        """Remove it."""
        super().cleanup()
        self._lock.close()


def _remove_left_behind() -> None:
    for lock in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*/{_LOCK}"):
        with suppress(OSError), lock.open("rb") as file:  # its process lives, or it is another user's
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(lock.parent, ignore_errors=True)
