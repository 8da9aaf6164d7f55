"""Disk room: for how many hours the log of a drive finds room on its disk, before the drive begins."""

import shutil
from pathlib import Path

from drawbar.errors import StorageError

_HOUR = 3600.0
"""s"""
_STANDING, _STEP = 10e6, 1500.0
"""bytes that a drive's log grows by in an hour without steps, and with each step: a quarter more than was measured"""


def growth(sample_time: float) -> float:
    """Return by how much a drive's log grows in an hour, bytes."""
    return _STANDING + _STEP * _HOUR / sample_time


def room_note(folder: Path, sample_time: float, room: float) -> str:
    """Return for how long the disk of a folder has room, where that is less than `room`, s; empty: it is enough.

    Raises:
        StorageError: it is less than an hour.
    """
    disk, hourly = shutil.disk_usage(folder), growth(sample_time)
    if disk.total == 0:  # this file system does not tell
        return ""
    hours = disk.free / hourly
    needs = f"{disk.free / 1e6:.0f} MB left; the log of an hour's drive takes {hourly / 1e6:.0f} MB"
    if hours < 1.0:
        raise StorageError(f"the disk of {folder} has {needs}: make room, or choose another folder by --out")
    return f"the disk of {folder} has {needs}: enough for {hours:.1f} h" if hours * _HOUR < room else ""
