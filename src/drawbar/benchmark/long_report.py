"""Long report: the cost of reporting on a long run, `python -m drawbar.benchmark.long_report [KILOMETRES]`, on Linux.

By default the run has 100 km. It is simulated first, on figure-eights at 1 m/s: some three minutes, and 1 GB in the
folder for temporary files.
"""

import os
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

KILOMETRES = 100.0
_EIGHT = 134.25
"""m: length of a figure-eight whose radius is 10 m"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportCost:
    """What it took to make a report from a log."""

    log_mb: float
    seconds: float
    """from the start of the process to its end"""
    peak_mb: float
    """most memory that the process had at once (resident set), 10⁶ bytes"""
    html_mb: float


def report_cost(kilometres: float) -> ReportCost:
    """Drive so far in simulation, and make the report in a process of its own."""
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made, "run")
        radii = [10.0] * max(round(1000.0 * kilometres / _EIGHT), 1)
        _drawbar("run", "--set", f"path.radii={radii}", "--out", str(folder))
        seconds, peak = _drawbar("report", str(folder / "log.mcap"))
        log, html = ((folder / name).stat().st_size / 1e6 for name in ("log.mcap", "report.html"))
    return ReportCost(log_mb=log, seconds=seconds, peak_mb=peak, html_mb=html)


def _drawbar(*arguments: str) -> tuple[float, float]:
    """Run a command of drawbar; return how long it took, s, and the most memory that it had, 10⁶ bytes."""
    start = time.perf_counter()
    process = os.posix_spawn(sys.executable, [sys.executable, "-m", "drawbar", *arguments], os.environ)
    _, status, usage = os.wait4(process, 0)
    if status:
        raise SystemExit(f"`drawbar {arguments[0]}` failed")
    return time.perf_counter() - start, usage.ru_maxrss * 1024 / 1e6  # of Linux in KiB


def main() -> None:
    """Print the figures."""
    cost = report_cost(float(sys.argv[1]) if len(sys.argv) > 1 else KILOMETRES)
    print(
        f"\nreport from a log of {cost.log_mb:.0f} MB: {cost.seconds:.1f} s, at most {cost.peak_mb:.0f} MB of memory, "
        f"report.html of {cost.html_mb:.1f} MB"
    )


if __name__ == "__main__":
    main()
