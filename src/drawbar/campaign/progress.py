"""The progress of many runs: a live line in a terminal, a line every few seconds in a file or pipe."""

import time
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.live import Live
from rich.text import Text

_REFRESH = 0.2
"""s between two pictures of a terminal"""
_PLAIN_REFRESH = 5.0
"""s between two lines of a file or pipe"""
_WIDTH = 24


class CampaignProgress:
    """As a context, so that the terminal is left as it was found."""

    def __init__(self, console: Console, title: str) -> None:
        """Show the progress of what the title names on the console."""
        self._console, self._title = console, title
        self._live = Live(console=console, auto_refresh=False, transient=True) if console.is_terminal else None
        self._period = _REFRESH if self._live else _PLAIN_REFRESH
        self.begin("", 0)

    def begin(self, phase: str, total: int, done: int = 0) -> None:
        """Start counting a phase of `total` things, of which some may be done already."""
        self._phase, self._total, self._done, self._first, self._failed = phase, total, done, done, 0
        self._start = time.perf_counter()
        self._next = self._start + self._period

    def advance(self, failure: str = "") -> None:
        """Count one thing more, failed for a reason or well; a reason stays on the console."""
        self._done += 1
        if failure:
            self._failed += 1
            self._console.print(Text(f"failed: {failure}", "red"))
        now = time.perf_counter()
        if now >= self._next or self._done == self._total:
            self._next = now + self._period
            self._show(now - self._start)

    def _show(self, elapsed: float) -> None:
        line = progress_line(
            f"{self._title}, {self._phase}",
            done=self._done,
            total=self._total,
            rate=(self._done - self._first) / max(elapsed, 1e-9),
            failed=self._failed,
        )
        if self._live:
            self._live.update(line, refresh=True)
        else:
            self._console.print(line)

    def __enter__(self) -> Self:
        if self._live:
            self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._live:
            self._live.stop()


def progress_line(title: str, *, done: int, total: int, rate: float, failed: int) -> Text:
    """Say how far a phase is, at `rate` things per second, at most about 100 columns wide."""
    full = _WIDTH * done // total if total else 0
    left = (total - done) / rate if rate > 0.0 else 0.0
    return Text.assemble(
        (f"{title} ", "bold"),
        ("━" * full, "green"),
        ("━" * (_WIDTH - full), "bright_black"),
        f" {done}/{total}  {rate:.1f}/s  {left:.0f} s left",
        (f"  {failed} failed", "bold red") if failed else "",
    )
