"""Progress: what `drawbar run` shows in a terminal while it goes."""

import time

from rich.console import Console
from rich.text import Text

from drawbar.report.live import LiveLine
from drawbar.signals import StepRecord


class RunProgress(LiveLine):
    """One line that follows the run."""

    def __init__(self, console: Console, length: float) -> None:
        """Show progress on the console along a path of the given length, m."""
        super().__init__(console)
        self._length = length
        self._start = time.perf_counter()

    def show(self, record: StepRecord) -> None:
        """Draw the state of the run after a step, if it is time to."""
        if self.due():
            self.draw(progress_line(record, self._length, time.perf_counter() - self._start))


def progress_line(record: StepRecord, length: float, elapsed: float) -> Text:
    """Return how far the run is, as a text, after `elapsed` s of wall-clock time, at most 80 columns wide."""
    driven, now = record.reference.tractor.progress, record.measurement.time
    share = min(max(driven / length, 0.0), 1.0)
    factor = f"{now / elapsed:5.0f}×" if elapsed > 0.0 else "     –"
    tractor, trailer = (
        100.0 * record.reference.tractor.lateral_error,
        100.0 * record.reference.trailer.lateral_error,
    )
    return Text.assemble(
        (f"{share:4.0%} ", "bold"),
        f"{driven:z6.0f} of {length:.0f} m  {now:6.0f} s {factor}  ",
        (f"tractor {tractor:+z6.1f} ", "blue"),
        (f"trailer {trailer:+z6.1f}", "yellow"),
        " cm",
    )
