"""Folder of the sockets of a drive."""

import os
import tempfile

from drawbar.driving.messaging.process_options import SOCKETS
from drawbar.errors import HardwareError

_LONGEST_PATH = 107
"""bytes of a Unix socket's address, which Linux allows"""


def socket_folder() -> "tempfile.TemporaryDirectory[str]":
    """Return a new folder, the user's own, with room for the names of sockets.

    Raises:
        HardwareError: the temporary folder's name is too long for sockets.
    """
    folder = tempfile.TemporaryDirectory(prefix="drawbar-")
    longest = _LONGEST_PATH - len(os.sep) - len(max(SOCKETS, key=len))
    if len(os.fsencode(folder.name)) > longest:
        folder.cleanup()
        raise HardwareError(
            f"the temporary folder {tempfile.gettempdir()} has too long a name for sockets, which may have "
            f"{_LONGEST_PATH} bytes; set TMPDIR to a shorter one, as TMPDIR=/tmp"
        )
    return folder
