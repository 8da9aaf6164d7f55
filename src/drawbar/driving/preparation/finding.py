"""Finding: what `drawbar check` has found out about a device, and the times at which it looks."""

import math
import select
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from drawbar.errors import HardwareError
from drawbar.protocols.actuator import SteeringRequest
from drawbar.protocols.speed_actuator import SpeedRequest
from drawbar.transports.base import Transport

OFF = SteeringRequest(steer=False, angle=0.0, speed=0.0)
STOP = SpeedRequest(drive=False, speed=0.0, deceleration=1.0)
MOST_SWINGS = 3
"""of an angle, there and back again, that may be chance"""
_LOOK = 0.02
"""between two looks at a device, s"""


@dataclass(slots=True, kw_only=True)
class Finding:
    """What was found out about one device."""

    device: str
    received: bool = False
    facts: list[str] = field(default_factory=list)
    """what it reported"""
    problems: list[str] = field(default_factory=list)
    """what is missing, each with what to do"""
    fixed: bool = False
    """of a receiver: its last fix was RTK fixed"""
    station: int | None = None
    """of a receiver: which its corrections come from, where it reports that"""
    clock: float = math.nan
    """of a receiver: its time of day when this computer's monotonic clock began, s"""


def finding_of(device: str, look: Callable[[], Finding]) -> Finding:
    """Return what is found out about a device; why it cannot be opened, where it cannot."""
    try:
        return look()
    except HardwareError as error:
        return Finding(device=device, problems=[str(error)])


def poll_times(seconds: float, *watched: Transport) -> Iterator[float]:
    """Yield monotonic times, s, for so long: of each look, and of the moments when bytes come from what is watched.

    The last one is after the end: what came while a busy computer did not let this process look is looked at.
    """
    end = time.monotonic() + seconds
    while True:
        now = time.monotonic()
        yield now
        if now >= end:
            return
        descriptors = [each.fileno() for each in watched]
        select.select([each for each in descriptors if each >= 0], [], [], _LOOK)


def counted(dropped: Mapping[str, int]) -> str:
    """Return what was dropped, by kind, in words."""
    return ", ".join(f"{count} × {kind}" for kind, count in dropped.items())


def tell_silence(finding: Finding, transport: Transport, dropped: Mapping[str, int] | None = None) -> None:
    """Note that nothing was received, or nothing but what was dropped (by kind), and what to do."""
    if dropped:
        finding.problems.append(
            f"something comes, but nothing that is understood ({counted(dropped)}): check the baud rate, the sender, "
            "and which messages it is set up to send"
        )
        return
    why = f" ({transport.trouble})" if transport.trouble else ""
    finding.problems.append(f"nothing was received{why}: check its power, its cable and its transport")
