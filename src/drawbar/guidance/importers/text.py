"""Reading text files with errors that name the file and the line."""

import codecs
import re
from pathlib import Path

from drawbar.errors import PathError

_DECLARED = re.compile(
    rb"""<\?xml[^>]*\sencoding=["'](iso-8859-(?:[1-9]|1[013-6])|windows-125[0-8])["']""", re.IGNORECASE
)


def read_text(path: Path) -> str:
    """Return a text file, a byte order mark removed.

    It is UTF-8, UTF-16 with its mark, or, of XML, in the alphabet of one byte a character that it declares.

    Raises PathError for a file that is missing, unreadable, empty, or not text.
    """
    try:
        data = path.read_bytes()
        text = data.decode(_encoding(data))
    except OSError as error:
        raise PathError(f"{path}: cannot be read: {error.strerror}; give an existing file") from None
    except UnicodeDecodeError as error:
        raise PathError(f"{path}: byte {error.start} is not UTF-8 text; give a text file, saved as UTF-8") from None
    if "\0" in text:
        raise PathError(f"{path}: is a binary file; give a text file")
    if not text.strip():
        raise PathError(f"{path}: is empty; a line needs at least two points")
    return text


def _encoding(data: bytes) -> str:
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    declared = _DECLARED.match(data)
    return declared[1].decode() if declared else "utf-8-sig"


def read_lines(path: Path) -> list[str]:
    """Return the stripped lines of a text file, the file's line i at index i - 1. Errors as read_text."""
    return lines_of(read_text(path))


def lines_of(text: str) -> list[str]:
    """Return the stripped lines of a text."""
    return [line.strip() for line in text.splitlines()]


def number(text: str, place: str, what: str) -> float:
    """Return a decimal number; raises PathError with the place for anything else."""
    try:
        return float(text)
    except ValueError:
        raise PathError(f"{place}: {what} is {text!r}; a number like -12.5 is needed") from None


def is_number(text: str) -> bool:
    """Return whether `number` would return one."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def numbers(text: str, count: int, place: str, what: str = "a coordinate") -> list[float]:
    """Return the numbers of a row "1.5,2.5", also where they all have decimal commas, as in "1,5,2,5".

    Raises PathError with the place for anything else: with decimal commas in some of them the columns are ambiguous.
    """
    cells = [cell.strip() for cell in text.split(",")]
    if len(cells) == 2 * count and all(cell.isdecimal() for cell in cells[1::2]):
        cells = [f"{whole}.{fraction}" for whole, fraction in zip(cells[::2], cells[1::2], strict=True)]
    if len(cells) != count:
        raise PathError(
            f"{place}: is {text!r}; {count} numbers separated by commas are needed, with decimal points, or all with "
            f"decimal commas"
        )
    return [number(cell, place, what) for cell in cells]
