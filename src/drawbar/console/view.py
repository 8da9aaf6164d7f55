"""View: what a page shows of the drive. Pure: states in, words and numbers out."""

import math
from dataclasses import dataclass
from typing import Any, Literal

from drawbar.console.drawing import Moving
from drawbar.console.language.words import Words
from drawbar.driving.operator.display import BAD, GOOD, STANDS, WARNING, is_beside_line, notices, refusals
from drawbar.driving.operator.requests import wished_speed
from drawbar.messages import ControllerState, GateState, SupervisorState
from drawbar.safety.causes import BY_CODE, Cause
from drawbar.safety.engagement import LATCHED, STEERING
from drawbar.signals import FixQuality
from drawbar.statuses import Status

Tone = Literal["good", "warn", "bad", "idle"]
KMH = 3.6
"""of m/s"""
_SAME = 1e-6
"""lines that are nearer are the same, m"""
_BAR = 0.3
"""lateral error at the ends of the light bar, m"""
_SYMBOLS = {
    SupervisorState.BOOT: "…",
    SupervisorState.SELFTEST: "…",
    SupervisorState.STANDBY: "○",
    SupervisorState.READY: "◎",
    SupervisorState.ENGAGING: "◔",
    SupervisorState.ACTIVE: "●",
    SupervisorState.DEGRADED: "◐",
    SupervisorState.STOPPING: "▼",
    SupervisorState.STOPPED: "■",
    SupervisorState.OVERRIDE: "◇",
    SupervisorState.FAULT: "✖",
    SupervisorState.ESTOP: "!!",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Dashboard:
    """What changes seldom: the state in words, why not, and what may be asked for."""

    word: str
    symbol: str
    tone: Tone
    detail: str
    """what led to the state, and for how long it lasts"""
    brake: bool
    """the driver is to stop the vehicle"""
    steers: bool
    """drawbar steers, or begins to"""
    heading: str
    """over the reasons"""
    reasons: tuple[tuple[str, str], ...]
    """what stands against engaging, or warnings while driving, each with what to do"""
    lease: str
    may_arm: bool
    may_engage: bool
    may_acknowledge: bool
    may_adjust: bool
    """nudge and set speed"""
    may_choose_line: bool
    may_wish: bool
    """ask the holder for the lease"""


def dashboard(
    gate: GateState | None,
    words: Words,
    *,
    stale: bool,
    mine: bool,
    holder: str | None,
    drives: bool,
    speed: float = math.nan,
    controller: ControllerState | None = None,
    corrections: str = "",
) -> Dashboard:
    """Return the dashboard of one visitor.

    Args:
        gate: its newest state.
        words: texts.
        stale: that state is old.
        mine: the visitor holds the lease.
        holder: name of who does; empty: not known; None: nobody.
        drives: the visitor may do more than look and stop.
        speed: of the vehicle, m/s; NaN: not known.
        controller: its newest state; None: not known.
        corrections: why none come; empty: they do, or it is not known.
    """
    if gate is None or stale:
        return _no_contact(words)
    state = gate.state
    latched, ready = state in LATCHED, state is SupervisorState.READY
    driving = state in STEERING
    reasons = _reasons(gate, controller, words, drives=drives)
    reasons += ((words("no_corrections"), words.message(corrections)),) if corrections else ()
    return Dashboard(
        word=words(state.name),
        symbol=_SYMBOLS[state],
        tone="good" if state in GOOD else "warn" if state in WARNING else "bad" if state in BAD else "idle",
        detail=_detail(gate, words, None if controller is None else Status(controller.status)),
        brake=bool(gate.stop) and state is not SupervisorState.STOPPED and not abs(speed) <= STANDS,
        steers=driving,
        heading=words("next" if ready or (latched and drives) else "warnings" if driving else "why_not")
        + _count(reasons),
        reasons=reasons,
        lease=_lease(words, mine=mine, holder=holder, drives=drives),
        may_arm=drives and ready and not (gate.armed and mine) and (mine or holder is None),
        may_engage=drives and ready and mine and bool(gate.armed),
        may_acknowledge=drives and latched,
        may_adjust=drives and mine,
        may_choose_line=drives and not driving and (mine or holder is None),
        may_wish=drives and holder is not None and not mine,
    )


def _no_contact(words: Words) -> Dashboard:
    return Dashboard(
        word=words("NO_CONTACT"),
        symbol="?",
        tone="bad",
        detail=words("no_contact_why"),
        brake=False,
        steers=False,
        heading="",
        reasons=(),
        lease="",
        may_arm=False,
        may_engage=False,
        may_acknowledge=False,
        may_adjust=False,
        may_choose_line=False,
        may_wish=False,
    )


def _detail(gate: GateState, words: Words, status: Status | None) -> str:
    parts = []
    if gate.cause and gate.state is not SupervisorState.READY:
        cause = words.led(BY_CODE[gate.cause], status) + words.of_actuators(gate.concerned)
        parts.append(words("because", cause=cause))
    if math.isfinite(gate.remaining):
        parts.append(words("seconds_left", seconds=math.ceil(gate.remaining)))
    return " · ".join(parts)


def _reasons(
    gate: GateState, controller: ControllerState | None, words: Words, *, drives: bool
) -> tuple[tuple[str, str], ...]:
    """Return what comes next, what is in the way of it, and what else is to be known."""
    if gate.state is SupervisorState.READY and drives:
        found: tuple[tuple[str, str], ...] = ((words("next_ready"), ""),)
    else:
        found = tuple(map(words.cause, refusals(gate, controller)))
        if not found and gate.state is SupervisorState.STANDBY:
            found = ((words("wait_ready"), ""),)
    if gate.state in LATCHED and drives:
        next_step = "next_override" if gate.state is SupervisorState.OVERRIDE else "next_latched"
        found = ((words(next_step), ""), *found)
    return found + tuple(map(words.cause, notices(controller, gate)))


def _count(reasons: tuple[tuple[str, str], ...]) -> str:
    """Return how many there are: on a phone some must be scrolled to."""
    return f" ({len(reasons)})" if len(reasons) > 1 else ""


def _lease(words: Words, *, mine: bool, holder: str | None, drives: bool) -> str:
    if not drives:
        return words("only_viewer")
    if mine:
        return words("you_control")
    if holder is None:
        return words("nobody_controls")
    return words("other_controls", name=display_name(holder, words))


def display_name(name: str, words: Words) -> str:
    """Return how somebody is called; numbers are operators without a name."""
    if not name:
        return words("somebody")
    return words("operator_name", name=name) if name.isdigit() else name


def picture(
    gate: GateState | None,
    controller: ControllerState | None,
    place: Moving | None,
    words: Words,
    *,
    stale: bool,
    satellites: int = 0,
) -> dict[str, Any]:
    """Return what a browser draws ten times a second, as JSON; `seen` is what it acknowledges.

    Args:
        gate: its newest state.
        controller: its newest state.
        place: where both bodies are.
        words: texts.
        stale: the gate's state is old.
        satellites: in use by the receiver that has the fewest; 0: not known.
    """
    errors = controller if is_beside_line(gate, controller) else None
    return {
        "seen": gate.sequence if gate is not None else -1,
        "stale": stale,
        "state": gate.state.name if gate is not None else "NO_CONTACT",
        "unrecorded": gate is not None and Cause.NOT_RECORDING.value in gate.refusals,
        "bodies": [_body(errors, body, words) for body in ("tractor", "trailer")],
        "chips": _chips(controller, satellites, words),
        "moving": place.to_browser() if place is not None else None,
        "error": _finite(errors.tractor_lateral_error) if errors is not None else None,
    }


def _body(controller: ControllerState | None, body: str, words: Words) -> dict[str, Any]:
    error = getattr(controller, f"{body}_lateral_error") if controller is not None else math.nan
    if not math.isfinite(error):
        return {"name": words(body), "figure": "–", "side": words("not_known"), "bar": None, "arrow": ""}
    centimetres = round(abs(error) * 100.0)
    side = "on_line" if not centimetres else "left" if error > 0.0 else "right"
    return {
        "name": words(body),
        "figure": f"{centimetres}",
        "side": words(side),
        "bar": round(max(-1.0, min(1.0, error / _BAR)), 3),
        "arrow": {"left": "◀", "right": "▶", "on_line": "◆"}[side],
    }


def _chips(controller: ControllerState | None, satellites: int, words: Words) -> list[dict[str, Any]]:
    """Return speed, fix with satellites, and corrections, each with whether it is well."""
    if controller is None:
        return [{"name": words(key), "value": "–", "good": False} for key in ("speed", "fix", "corrections")]
    qualities = [FixQuality(each) for each in (controller.tractor_quality, controller.trailer_quality)]
    worst = min(qualities)
    age = controller.correction_age
    fix = words("fix_satellites", count=satellites) if satellites else words("fix")
    speed = controller.wheel_speed if math.isfinite(controller.wheel_speed) else controller.receiver_speed
    return [
        {
            "name": words("speed"),
            "value": f"{words.number(speed * KMH, 1)} km/h" if math.isfinite(speed) else words("not_known"),
            "good": math.isfinite(speed),
        },
        {"name": fix, "value": words(f"fix_{worst.name}"), "good": worst is FixQuality.FIXED},
        {
            "name": words("corrections"),
            "value": f"{words.number(age, 0)} s" if math.isfinite(age) else words("not_known"),
            "good": math.isfinite(age) and age <= 5.0,
        },
    ]


def set_speed_text(gate: GateState | None, words: Words, speed: float) -> str:
    """Return the set speed; speed: at which is driven where the operator wishes none, m/s."""
    if gate is None:
        return "–"
    return f"{words.number(wished_speed(gate, speed) * KMH, 1)} km/h"


def shift_text(gate: GateState | None, *, left: int) -> str:
    """Return how far the line is moved; left: 1 where the driver's left is the line's, else -1."""
    if gate is None or not round(gate.nudge * 100.0):
        return "0 cm"
    return f"{'◀' if left * gate.nudge > 0.0 else '▶'} {abs(round(gate.nudge * 100.0))} cm"


def drives_chosen_line(gate: GateState, controller: ControllerState, working_width: float) -> bool:
    """Return whether the controller drives the line that was chosen and moved; width between lines in m."""
    return abs(controller.line_offset - gate.line * working_width - gate.nudge) < _SAME


def _finite(value: float) -> float | None:
    return round(value, 3) if math.isfinite(value) else None
