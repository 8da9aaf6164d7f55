"""Status of the corrections: states of the client, and a snapshot for the supervisor and the operator."""

from dataclasses import dataclass
from enum import Enum


class CorrectionsState(Enum):
    """How far the client is."""

    WAITING = "waits before the next attempt"
    CONNECTING = "connects to the caster"
    ASKING = "waits for the caster's answer"
    LISTENING = "waits for corrections"
    FLOWING = "receives corrections"


@dataclass(frozen=True, slots=True, kw_only=True)
class CorrectionsStatus:
    """The corrections at an instant."""

    state: CorrectionsState
    failure: str
    """what is wrong and what to do; empty: nothing is"""
    next_attempt: float
    """s from now; 0 unless it waits"""
    attempts: int
    """connections begun"""
    received: int
    """bytes of streams"""
    uploads: int
    """positions sent"""
    types: dict[int, int]
    """frames by RTCM message type"""
    observation_age: float
    """since the last observations, s; inf: none yet"""
    station: int | None
    """reference station; another one means that the base was switched: positions may jump"""
    dropped: dict[str, int]
    """`bytes` outside frames and frames with a wrong `checksum`"""

    @property
    def message(self) -> str:
        """For the operator: what is wrong, what to do, and when the next attempt begins; empty: nothing is wrong."""
        wait = f"; next attempt in {self.next_attempt:.0f} s" if self.failure and self.next_attempt else ""
        return self.failure + wait


class CorrectionsNews:
    """Changes of the corrections, in words for the operator, each reported once."""

    def __init__(self) -> None:
        self._failure = ""
        self._stations = set[int]()

    def update(self, status: CorrectionsStatus) -> list[str]:
        """Return what is new since the last status."""
        news = []
        if status.failure != self._failure:
            self._failure = status.failure
            news.append(status.message or "corrections come again")
        if status.station is not None and status.station not in self._stations:
            if self._stations:  # those that a stream holds in turns are reported once
                news.append(f"corrections come from another base, station {status.station}: positions may jump")
            self._stations.add(status.station)
        return news
