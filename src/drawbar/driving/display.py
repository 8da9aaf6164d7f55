"""Display: what an operator at a terminal sees of a drive. Pure: states in, text out; fits 60 columns."""

import math
from collections.abc import Iterator

from rich.text import Text

from drawbar.messages import ControllerState, GateState, SupervisorState
from drawbar.safety.causes import BY_CODE, Cause
from drawbar.signals import FixQuality

GOOD = (SupervisorState.READY, SupervisorState.ENGAGING, SupervisorState.ACTIVE)
WORRIED = (SupervisorState.DEGRADED, SupervisorState.STOPPING, SupervisorState.OVERRIDE)
BAD = (SupervisorState.FAULT, SupervisorState.ESTOP)
"""the states that have a colour, by how well it goes"""
_MEANINGS = {
    SupervisorState.BOOT: "starting",
    SupervisorState.SELFTEST: "testing itself",
    SupervisorState.STANDBY: "not ready to engage",
    SupervisorState.READY: "ready to engage",
    SupervisorState.ENGAGING: "taking over",
    SupervisorState.ACTIVE: "steering",
    SupervisorState.DEGRADED: "steering, slower",
    SupervisorState.STOPPING: "stopping",
    SupervisorState.STOPPED: "stopped; acknowledge to go on",
    SupervisorState.OVERRIDE: "you took over; acknowledge to go on",
    SupervisorState.FAULT: "let go of the steering; acknowledge to go on",
    SupervisorState.ESTOP: "emergency stop; acknowledge to go on",
}
KEYS = "e engage   space stop   r release   x emergency\na acknowledge   + - speed   q quit"


def picture(state: GateState | None, controller: ControllerState | None, refusal: Cause | None = None) -> Text:
    """Return the whole picture: state, errors, what stands against engaging, why the newest key was refused, keys."""
    lines = [*_state(state), *_numbers(controller), *map(reason, refusals(state) if state else ())]
    if refusal is not None:
        lines.append(Text(f"refused: {refusal.sentence}: {refusal.advice}", style="yellow"))
    lines.append(Text(KEYS, style="dim"))
    return Text("\n").join(lines)


def headline(state: GateState) -> Text:
    """Return the state in one line, with its cause."""
    known = {GOOD: "green", WORRIED: "yellow", BAD: "bold red"}
    style = next((style for states, style in known.items() if state.state in states), "")
    text = Text(f"{state.state.name}: {_MEANINGS[state.state]}", style=style)
    if state.cause:
        text.append(f" ({BY_CODE[state.cause].sentence})")
    if math.isfinite(state.remaining):
        text.append(f", {state.remaining:.0f} s left")
    return text


def refusals(state: GateState) -> list[Cause]:
    """Return what stands against engaging."""
    return [BY_CODE[code] for code in state.refusals if code]


def reason(cause: Cause) -> Text:
    """Return what stands against engaging, and what to do, in one line."""
    return Text(f"- {cause.sentence}: {cause.advice}")


def _state(state: GateState | None) -> Iterator[Text]:
    yield headline(state) if state else Text("the gate has not been heard", style="bold red")
    if state and state.stop:
        yield Text("STOP THE VEHICLE", style="bold reverse red")


def _numbers(controller: ControllerState | None) -> Iterator[Text]:
    if controller is None:
        yield Text("the controller has not been heard")
        return
    bodies = ("tractor", "trailer")
    yield Text("   ".join(f"{body} {_side(getattr(controller, f'{body}_lateral_error'))}" for body in bodies))
    fixes = ", ".join(f"{body} {FixQuality(getattr(controller, f'{body}_quality')).name.lower()}" for body in bodies)
    age = f", corrections {controller.correction_age:.0f} s" if math.isfinite(controller.correction_age) else ""
    yield Text(f"{_speed(controller.wheel_speed)}   fix: {fixes}{age}")


def _side(error: float) -> str:
    """Return a distance from the line as people say it."""
    if not math.isfinite(error):
        return "not known"
    centimetres = round(abs(error) * 100.0)
    return f"{centimetres} cm {'left' if error > 0.0 else 'right'}" if centimetres else "on the line"


def _speed(speed: float) -> str:
    return f"{speed * 3.6:.1f} km/h" if math.isfinite(speed) else "speed not known"
