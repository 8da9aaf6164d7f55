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
    message: str
    """for the operator: what is wrong and what to do; empty: nothing is"""
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
    """reference station"""
    station_changed: float
    """since the reference station became another one, s; inf: never"""
    dropped: dict[str, int]
    """`bytes` outside frames and frames with a wrong `checksum`"""
