"""Live line that follows long work: redrawn in a terminal, written now and then into a file or pipe."""

import time
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.live import Live
from rich.text import Text

_REFRESH = 0.2
"""s between two pictures of a terminal"""
_PLAIN_REFRESH = 5.0
"""s between two lines of a file or pipe, and before the first"""


class LiveLine:
    """As a context, so that the terminal is left as it was found. Cheap: asking `due` costs one look at the clock."""

    def __init__(self, console: Console) -> None:
        """Show the line on the console."""
        self._console = console
        self._live = Live(console=console, auto_refresh=False, transient=True) if console.is_terminal else None
        self._period = _REFRESH if self._live else _PLAIN_REFRESH
        self._next = 0.0 if self._live else time.perf_counter() + self._period

    def due(self) -> bool:
        """Return whether it is time for another picture."""
        return time.perf_counter() >= self._next

    def wait(self) -> None:
        """Let a whole period pass before the next picture is due."""
        self._next = time.perf_counter() + self._period

    def draw(self, line: Text) -> None:
        """Show the line now."""
        self.wait()
        if self._live:
            self._live.update(line, refresh=True)
        else:
            self._console.print(line, soft_wrap=True)

    def __enter__(self) -> Self:
        if self._live:
            self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._live:
            self._live.stop()
