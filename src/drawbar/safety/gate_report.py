"""Gate's report of itself: the GateState record of a tick. Pure."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from drawbar.messages import GateState
from drawbar.nanoseconds import nanoseconds
from drawbar.protocols.actuator import Readiness, SteeringReport
from drawbar.protocols.speed_actuator import SpeedReport
from drawbar.safety.causes import BY_READINESS, Cause, Response
from drawbar.safety.engagement import ENGAGING, STOPPING, Engagement
from drawbar.safety.operator_requests import OperatorRequests

REFUSALS = 8
COUNTS = 2**32


@dataclass(frozen=True, slots=True, kw_only=True)
class Actuation:
    """What was measured at, reported by and sent to the actuators at a tick."""

    tractor: SteeringReport | None
    """None: there is no such actuator"""
    trailer: SteeringReport | None
    speed: SpeedReport | None

    @property
    def reports(self) -> list[SteeringReport | SpeedReport]:
        """Those of the actuators that there are, steering first."""
        return self.steering if self.speed is None else [*self.steering, self.speed]

    @property
    def bodies(self) -> tuple[SteeringReport | None, SteeringReport | None]:
        """Those of the steering of tractor and trailer."""
        return (self.tractor, self.trailer)

    @property
    def steering(self) -> list[SteeringReport | SpeedReport]:
        """Those of the steering actuators that there are."""
        return [report for report in self.bodies if report is not None]

    @property
    def angles(self) -> tuple[float, float]:
        """Measured angles, rad; 0 where there is no such actuator, NaN where it is not known."""
        return (_angle(self.tractor), _angle(self.trailer))

    @property
    def engaged(self) -> int:
        """Which actuators report that they do as asked, as bits of GateState.engaged."""
        reports = (self.tractor, self.trailer, self.speed)
        return sum(1 << bit for bit, report in enumerate(reports) if report is not None and report.engaged)

    def concerned(self, cause: Cause | None) -> int:
        """Return which actuators report this cause, as bits of GateState.engaged."""
        reports = (self.tractor, self.trailer, self.speed)
        return sum(1 << bit for bit, report in enumerate(reports) if report is not None and _is_of(cause, report))


@dataclass(frozen=True, slots=True, kw_only=True)
class Tick:
    """What the gate found and asked for at a tick."""

    now: float
    """s"""
    causes: Sequence[Cause]
    """against steering"""
    actuation: Actuation
    angles: tuple[float, float]
    """asked of tractor and trailer, rad; they mean something while the gate steers"""
    speed_limit: float
    """fastest that the vehicle may drive, m/s"""


@dataclass(slots=True)
class Counts:
    """What the gate counts, since its start."""

    states: int = 0
    """records published"""
    clips: int = 0
    rejects: int = 0
    dropped: int = 0


def gate_state(
    tick: Tick, engagement: Engagement, requests: OperatorRequests, counts: Counts, *, valid: float
) -> GateState:
    """Return the record of a tick, which means something for `valid` s."""
    now, actuation, time = tick.now, tick.actuation, nanoseconds(tick.now)
    tractor, trailer = (
        _steering(report, angle if engagement.steers else math.nan)
        for report, angle in zip((actuation.tractor, actuation.trailer), tick.angles, strict=True)
    )
    return GateState(
        sequence=counts.states % COUNTS,
        time=time,
        valid_until=time + nanoseconds(valid),
        state=engagement.state,
        steers=engagement.steers,
        engaged=actuation.engaged,
        stop=2 if engagement.hurries(now) else int(engagement.state is STOPPING),
        armed=engagement.armed(now),
        cause=_code(engagement.cause),
        answer=_code(requests.answer),
        answered=requests.answered,
        lease=requests.lease,
        since=nanoseconds(engagement.since),
        refusals=_refusals(engagement, tick.causes),
        remaining=engagement.remaining(now),
        tractor_angle=tractor.angle,
        tractor_angle_time=tractor.time,
        trailer_angle=trailer.angle,
        trailer_angle_time=trailer.time,
        tractor_set_point=tractor.set_point,
        trailer_set_point=trailer.set_point,
        speed_limit=tick.speed_limit,
        set_speed=requests.set_speed,
        nudge=requests.nudge,
        clips=counts.clips % COUNTS,
        rejects=counts.rejects % COUNTS,
        dropped=counts.dropped % COUNTS,
        line=requests.line,
        concerned=engagement.concerned,
    )


class _Steering(NamedTuple):
    """One steering in a record."""

    angle: float = math.nan
    """measured, rad"""
    time: int = 0
    """of the angle, ns"""
    set_point: float = math.nan
    """rad"""


def _steering(report: SteeringReport | None, set_point: float) -> _Steering:
    """Return a steering's part of a record; without an actuator nothing is known or given."""
    return _Steering() if report is None else _Steering(report.angle, nanoseconds(report.angle_time), set_point)


def _refusals(engagement: Engagement, causes: Sequence[Cause]) -> tuple[int, ...]:
    """Return the codes of what stands against engaging, or of causes while driving."""
    driving = engagement.steers and engagement.state is not ENGAGING
    codes = [cause.value for cause in causes if (cause.response is not Response.NONE if driving else cause.refuses)]
    return (*codes, *[0] * REFUSALS)[:REFUSALS]


def _is_of(cause: Cause | None, report: SteeringReport | SpeedReport) -> bool:
    if cause in (Cause.OPERATOR_STEERS, Cause.OVERRIDDEN):
        return report.overridden
    if cause is Cause.ACTUATOR_RELEASED:
        return not report.engaged
    return report.readiness is not Readiness.READY and BY_READINESS[report.readiness] is cause


def _code(cause: Cause | None) -> int:
    return 0 if cause is None else int(cause.value)


def _angle(report: SteeringReport | None) -> float:
    return 0.0 if report is None else report.angle
