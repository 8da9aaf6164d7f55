"""Terminal: what it can show; tables that fit its width and lose no column, plainer letters for those it lacks."""

import codecs
import os
import sys
import unicodedata
from collections.abc import Sequence
from io import TextIOWrapper
from typing import IO, Any

from rich.console import Console, ConsoleDimensions, ConsoleOptions, RenderResult
from rich.table import Table
from rich.text import Text

_GAP = 2
"""spaces between two columns"""
_NARROWEST = 8
"""of a column of figures, characters"""
_LEAST_WIDTH = 24
"""of an output, characters: a title and one column of figures"""
_PLAIN = {
    "µ": "u", "×": "x", "°": " deg", "–": "-", "━": "=", "±": "+-", "⁺": "+", "→": "->", "≤": "<=", "≥": ">=",
    "·": "*", "“": '"', "”": '"', "’": "'", "α": "alpha", "β": "beta", "δ": "delta", "κ": "kappa", "μ": "u",
    "ψ": "psi", "φ": "phi", "Δ": "Delta", "τ": "tau",
}  # fmt: skip
"""what is written where an encoding lacks a letter, and the letter has no plainer form of its own"""

Cell = str | Text


class FittedTable:
    """A title column and columns of figures, as one table, or as several where a terminal is too narrow for one.

    No figure is left out or cut.
    """

    def __init__(
        self,
        title: str,
        columns: Sequence[tuple[str, str]],
        rows: Sequence[tuple[str, Sequence[Cell]]],
        *,
        title_width: int,
        column_width: int = _NARROWEST,
    ) -> None:
        """Take the cells.

        Args:
            title: of the first column.
            columns: heading and style of the others.
            rows: the first column's cell and those of the others.
            title_width: at least, where there is room, characters.
            column_width: at least, where that takes no more tables, characters.
        """
        self._title, self._columns, self._rows = title, list(columns), list(rows)
        self._title_width, self._column_width = title_width, column_width

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        wanted = max([self._title_width, len(self._title), *(len(name) for name, _ in self._rows)])
        widest = max((self._needed([index], 0) for index in range(len(self._columns))), default=_GAP)
        title = min(wanted, max(options.max_width - widest, 10))
        room = options.max_width - title
        groups = self._groups(room)
        least = self._column_width if all(self._needed(group, self._column_width) <= room for group in groups) else 0
        for number, group in enumerate(groups):
            if number:
                yield ""
            yield self._part(group, title, least)

    def _groups(self, room: int) -> list[range]:
        """Return as few groups of neighbouring columns as fit into so many characters, of as equal a size as may be."""
        columns = len(self._columns)
        for count in range(1, columns + 1):
            size = -(-columns // count)
            groups = [range(first, min(first + size, columns)) for first in range(0, columns, size)]
            if all(self._needed(group, 0) <= room for group in groups):
                return groups
        return [range(index, index + 1) for index in range(columns)]

    def _needed(self, group: Sequence[int], least: int) -> int:
        """Return how many characters neighbouring columns take, each of `least` at least."""
        texts = [[cells[index] for _, cells in self._rows] for index in group]
        lengths = [[len(text.plain if isinstance(text, Text) else text) for text in column] for column in texts]
        headings = [map(len, heading.split("\n")) for heading in self._headings(group)]
        return sum(max([least, *cells, *heading]) + _GAP for cells, heading in zip(lengths, headings, strict=True))

    def _headings(self, group: Sequence[int]) -> list[str]:
        return _unrepeated([self._columns[index][0] for index in group])

    def _part(self, group: Sequence[int], width: int, least: int) -> Table:
        table = Table(box=None, pad_edge=False, padding=(0, _GAP // 2), title_justify="left")
        table.add_column(self._title, min_width=width, max_width=width, overflow="fold")
        for heading, index in zip(self._headings(group), group, strict=True):
            style = self._columns[index][1]
            table.add_column(heading, justify="right", header_style=style, min_width=least, no_wrap=True)
        for name, cells in self._rows:
            table.add_row(name, *(cells[index] for index in group))
        return table


def _unrepeated(headings: Sequence[str]) -> list[str]:
    """Return headings of two lines with the first one left empty where it is that of the column before."""
    parts = [heading.rpartition("\n") for heading in headings]
    before = ["", *(first for first, _, _ in parts)]
    return ["".join(part if part[0] != last else part[1:]) for part, last in zip(parts, before, strict=False)]


def open_what_is_closed() -> None:
    """Put the null device in the place of standard input, output and error where the caller has closed them.

    A log that is opened would get such a number, and what libraries print would land in it.
    """
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
        pass
    os.close(number)
    sys.stdin = sys.stdin or os.fdopen(0)
    sys.stdout = sys.stdout or os.fdopen(1, "w")
    sys.stderr = sys.stderr or os.fdopen(2, "w")


class Output(Console):
    """Standard output, or standard error; where nobody reads it any more, the command continues without."""

    def __init__(self, **options: Any) -> None:
        """Remove `COLUMNS=0`, which some programs set before the width is known: nothing at all would be printed."""
        if not os.environ.get("COLUMNS", "").strip("0"):
            os.environ.pop("COLUMNS", None)
        super().__init__(**options)

    @property
    def size(self) -> ConsoleDimensions:
        """Columns and rows; in a window of hardly any columns lines wrap, and no figure is cut off."""
        size = super().size
        return ConsoleDimensions(max(size.width, _LEAST_WIDTH), size.height)

    @size.setter
    def size(self, size: tuple[int, int]) -> None:
        self._width, self._height = size

    def on_broken_pipe(self) -> None:
        """Let all that is printed from now on go nowhere."""
        self.quiet = True
        discard(self.file)


def discard(stream: IO[str]) -> None:
    """Send what is written to a stream from now on, and what it still holds, to the null device."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def forget_typed() -> None:
    """Forget what was typed and not yet read, where standard input is a terminal: it is no answer to what is asked now.

    Windows has no such call; nothing is forgotten there.
    """
    if sys.platform != "win32" and sys.stdin.isatty():
        import termios

        termios.tcflush(sys.stdin, termios.TCIFLUSH)


def degrade_output() -> None:
    """Let standard output and error write what their encoding has, and something plainer for what it lacks."""
    codecs.register_error("drawbar.plain", _plainer)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # tests and notebooks put others there
            stream.reconfigure(errors="drawbar.plain")


def _plainer(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    missing = error.object[error.start : error.end]
    return "".join(_plain(letter) for letter in missing).encode("ascii", "replace").decode(), error.end


def _plain(letter: str) -> str:
    return _PLAIN.get(letter) or unicodedata.normalize("NFKD", letter).encode("ascii", "ignore").decode() or "?"
