"""The progress of many runs: a live line in a terminal, a line every few seconds in a file or pipe."""

import time

from rich.console import Console
from rich.text import Text

from drawbar.report.live import LiveLine

_WIDTH = 24


class RunsProgress(LiveLine):
    """Counts what is done of each phase, in one line."""

    def __init__(self, console: Console, title: str) -> None:
        """Show the progress of what the title names on the console."""
        super().__init__(console)
        self._title = title
        self._told = set[str]()
        """reasons of failures that the console shows already"""
        self.begin("", 0)

    def begin(self, phase: str, total: int, done: int = 0) -> None:
        """Start counting a phase of `total` things, of which some may be done already."""
        self._phase, self._total, self._done, self._first, self._failed = phase, total, done, done, 0
        self._start = time.perf_counter()
        self.wait()

    def advance(self, failure: str = "") -> None:
        """Count one thing more, failed for a reason or well; a reason stays on the console, once."""
        self._done += 1
        self._failed += bool(failure)
        if failure and failure not in self._told:
            self._told.add(failure)
            self._console.print(Text(f"failed: {failure}", "red"))
        if self.due() or self._done == self._total:
            self._show(time.perf_counter() - self._start)

    def _show(self, elapsed: float) -> None:
        rate = (self._done - self._first) / max(elapsed, 1e-9)
        title = f"{self._title}, {self._phase}"
        self.draw(progress_line(title, done=self._done, total=self._total, rate=rate, failed=self._failed))


def progress_line(title: str, *, done: int, total: int, rate: float, failed: int) -> Text:
    """Return how far a phase is, at `rate` things per second, at most about 100 columns wide."""
    full = _WIDTH * done // total if total else 0
    left = (total - done) / rate if rate > 0.0 else 0.0
    return Text.assemble(
        (f"{title} ", "bold"),
        ("━" * full, "green"),
        ("━" * (_WIDTH - full), "bright_black"),
        f" {done}/{total}  {rate:.1f}/s  {left:.0f} s left",
        (f"  {failed} failed", "bold red") if failed else "",
    )
