"""Bare valve: the sentences of a small board that drives a valve or motor and measures the wheels' angle. Pure.

To the board: `$PDBD,DRIVE*hh` CR LF, the drive from -1000 to 1000, at every report. The board holds it for 0.2 s at
most, and only while the operator holds its switch; then its output is off.

From the board, 20 to 100 times a second: `$PDBV,MS,COUNTS,SWITCH*hh` CR LF, its own milliseconds, counts of the angle
sensor's converter, 1 while the switch is held, else 0.
"""

from collections import Counter
from dataclasses import dataclass

from drawbar.errors import HardwareError
from drawbar.protocols.own_sentence import SentenceReader, own_sentence, whole_number

HOLDS = 0.2
"""for which the board holds a drive that is not repeated, s"""
FULL = 1000
"""of a drive on the wire"""


@dataclass(frozen=True, slots=True)
class ValveReport:
    """What the board reports at one instant."""

    time: float
    """monotonic time at which it came, s"""
    counts: int
    permitted: bool
    """the operator holds its switch"""


class ValveBoard:
    """The board's bytes in, reports out. Whatever comes, nothing raises; `dropped` counts what was not understood."""

    def __init__(self) -> None:
        self._sentences = SentenceReader("PDBV")

    @property
    def dropped(self) -> Counter[str]:
        """What was not understood, by kind."""
        return self._sentences.dropped

    def push(self, data: bytes, time: float) -> list[ValveReport]:
        """Take bytes that came at a monotonic time, s; return the reports that they end."""
        reports = []
        for fields in self._sentences.push(data):
            try:
                milliseconds, counts, switch = map(whole_number, fields)
            except ValueError:
                self.dropped["not three whole numbers"] += 1
                continue
            if milliseconds is None or counts is None or switch not in (0, 1):
                self.dropped["no number, or a switch that is neither 0 nor 1"] += 1
                continue
            reports.append(ValveReport(time, counts, switch == 1))
        return reports


def drive_sentence(drive: float) -> bytes:
    """Return the board's command, drive from -1 to 1; raises HardwareError beyond."""
    if not abs(drive) <= 1.0:
        raise HardwareError(f"a valve was to be driven by {drive}; -1 to 1 is allowed")
    return own_sentence("PDBD", round(FULL * drive))


def commanded_drives(sentences: SentenceReader, data: bytes) -> list[float]:
    """Return the drives in a board's commands; sentences: a reader of PDBD."""
    drives = []
    for fields in sentences.push(data):
        try:
            (drive,) = (whole_number(field, signed=True) for field in fields)
        except ValueError:
            continue
        if drive is not None and abs(drive) <= FULL:
            drives.append(drive / FULL)
    return drives
