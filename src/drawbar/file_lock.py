"""File lock: one process at a time writes to a file or a folder; the lock ends with the process, however that ends."""

import sys
from typing import BinaryIO


def is_locked(opened: BinaryIO | int) -> bool:
    """Lock an open file or folder until it is closed; return whether that failed, as somebody else has it locked.

    Where there are no locks, on Windows and some file systems, nobody has.
    """
    if sys.platform == "win32":
        return False
    import fcntl  # POSIX alone has it

    try:
        fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:  # a file system without locks
        return False
    return False
