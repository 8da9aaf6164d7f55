"""Integrity of the cache: only whole libraries are loaded, from a folder that the user alone can write.

Beside each library lies a note of its size and SHA-256 hash, written after it, each by an atomic replacement. A library
without its note, or another than the note says, is built again: the loader of a damaged one would kill the process.
"""

import hashlib
import os
import stat
from pathlib import Path

from drawbar.errors import CompilerError


def note_of(library: Path) -> Path:
    """Return the file that holds a library's checksum."""
    return library.with_name(library.name + ".sha256")


def describe(content: bytes) -> str:
    """Return a library's note: size in bytes and SHA-256 hash."""
    return f"{len(content)} {hashlib.sha256(content).hexdigest()}\n"


def is_whole(library: Path) -> bool:
    """Return whether a library is what was built, and nobody else's."""
    try:
        content, note = library.read_bytes(), note_of(library).read_text("ascii")
    except (OSError, ValueError):
        return False
    return note == describe(content) and not any(_strangers(file) for file in (library, note_of(library)))


def demand_own_folder(folder: Path) -> None:
    """Refuse a folder in which others could plant a library; Windows keeps the user's folders by other means.

    Raises:
        CompilerError: somebody else owns the folder or may write into it; says what to do.
    """
    if reason := _strangers(folder):
        raise CompilerError(
            f"{folder}: {reason}, so what lies there could be anybody's and is not loaded; take it over with "
            f"`chmod go-w` as its owner, or set DRAWBAR_CACHE to a folder of your own."
        )


def _strangers(path: Path) -> str:
    """Return who else could have written a file or folder; empty: nobody but this user and root."""
    if not hasattr(os, "geteuid"):
        return ""
    state = path.stat()
    if state.st_uid not in (0, os.geteuid()):
        return "another user owns it"
    return "others may write to it" if state.st_mode & (stat.S_IWGRP | stat.S_IWOTH) else ""
