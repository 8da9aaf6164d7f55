"""Whole files: what a command writes is there as a whole, or as it was before."""

import os
from collections.abc import Callable
from pathlib import Path


def write_whole(target: Path, write: Callable[[Path], object]) -> None:
    """Let a file be written beside its place and moved there; a pipe or a device is written to.

    Args:
        target: the file's place; where that is a link, what it leads to.
        write: writes the file of the name that it is given.

    Raises:
        OSError: it cannot be written; nothing has changed.
    """
    if target.exists() and not target.is_file():
        write(target)
        return
    place = target.resolve()
    part = place.with_name(place.name + ".part")
    try:
        write(part)
        os.replace(part, place)
    finally:
        part.unlink(missing_ok=True)
