"""Display: what an operator at a terminal sees of a drive. Pure: states in, text out; fits 60 columns."""

import math
from collections.abc import Iterator

from rich.text import Text

from drawbar.messages import ControllerState, GateState, SupervisorState
from drawbar.safety.causes import BY_CODE, Cause
from drawbar.safety.engagement import LATCHED, STEERING
from drawbar.signals import FixQuality
from drawbar.statuses import Status

GOOD = (SupervisorState.READY, SupervisorState.ENGAGING, SupervisorState.ACTIVE)
WARNING = (SupervisorState.DEGRADED, SupervisorState.STOPPING, SupervisorState.OVERRIDE)
BAD = (SupervisorState.FAULT, SupervisorState.ESTOP)
"""the states that have a colour, by how well it goes"""
STANDS = 0.05
"""slower is standing, m/s"""
_FIRST = 2_000_000_000
"""after the gate's own test, within which the controller reports for the first time, ns"""
_UNKNOWN_AWAY = {
    Cause.UNPROVED,
    Cause.POSITION_UNSURE,
    Cause.POSITION_LOST,
    Cause.HEADING_UNSURE,
    Cause.LINE_LOST,
    Cause.ACROSS_LINE,
    Cause.HITCH_ANGLE,
    Cause.HITCH_FOLDED,
}
"""what stands against engaging wherever the controller is beside no line"""
_UNKNOWN_WITHOUT_RECEIVER = _UNKNOWN_AWAY | {
    Cause.UNSOLVED,
    Cause.FIX_TOO_NEW,
    Cause.FIX_LOST,
    Cause.CORRECTIONS_OLD,
    Cause.CORRECTIONS_LOST,
    Cause.OFF_LINE,
}
"""what stands against engaging wherever no fixes come from a receiver, or never from both at one time"""
_UNKNOWN_IN_SILENCE = _UNKNOWN_WITHOUT_RECEIVER | {Cause.COMMAND_EXPIRED, Cause.CONFIGURATION}
"""what stands against engaging wherever the controller is silent"""
UNTRIED = {Cause.EMERGENCY_UNTRIED, Cause.WIGGLE_UNTRIED}
"""what is tried only before the vehicle is steered"""
OF_ANGLES = {Cause.STEERING_OLD, Cause.STEERING_LOST, Cause.STEERING_APART}
"""what stands against engaging wherever an actuator measures no angle, as some do while nothing commands them"""
_LACKING_RECEIVER = {Cause.RECEIVER_SILENT.value, Cause.RECEIVER_TIMES.value}
MEANINGS = {
    SupervisorState.BOOT: "starting",
    SupervisorState.SELFTEST: "testing itself",
    SupervisorState.STANDBY: "not ready to engage",
    SupervisorState.READY: "ready to engage",
    SupervisorState.ENGAGING: "taking over",
    SupervisorState.ACTIVE: "steering",
    SupervisorState.DEGRADED: "steering, slower",
    SupervisorState.STOPPING: "stopping",
    SupervisorState.STOPPED: "stopped; acknowledge to continue",
    SupervisorState.OVERRIDE: "you took over; acknowledge to continue",
    SupervisorState.FAULT: "steering released; acknowledge to continue",
    SupervisorState.ESTOP: "emergency stop; acknowledge to continue",
}
"""of each state, in words"""
_ACTUATORS = ("front wheels", "joint", "speed")
"""by their bits in GateState.engaged"""
KEYS = "e engage   space stop   r release   x emergency\na acknowledge   + - speed   q quit"


def picture(state: GateState | None, controller: ControllerState | None, refusal: Cause | None = None) -> Text:
    """Return the whole picture.

    State, errors, what stands against engaging, notices about sensors, why the newest key was refused, keys.
    """
    lines = [*_state(state, controller), *_numbers(state, controller)]
    lines += map(reason, refusals(state, controller) if state else ())
    lines += map(reason, notices(controller, state))
    if refusal is not None:
        lines.append(Text(f"refused: {refusal.sentence}: {refusal.advice}", style="yellow"))
    lines.append(Text(KEYS, style="dim"))
    return Text("\n").join(lines)


def headline(state: GateState, controller: ControllerState | None = None) -> Text:
    """Return the state in one line, with its cause, and where that is the end of the controller's run, how it ended."""
    known = {GOOD: "green", WARNING: "yellow", BAD: "bold red"}
    style = next((style for states, style in known.items() if state.state in states), "")
    text = Text(f"{state.state.name}: {MEANINGS[state.state]}", style=style)
    if state.cause:
        text.append(f" ({_led(BY_CODE[state.cause], controller)}{of_actuators(state.concerned)})")
    if math.isfinite(state.remaining):
        text.append(f", {state.remaining:.0f} s left")
    return text


def _led(cause: Cause, controller: ControllerState | None) -> str:
    """Return what led to a state."""
    if cause is not Cause.CONTROLLER_STOPS or controller is None or not Status(controller.status).has_ended:
        return cause.sentence
    return f"{cause.sentence}: {Status(controller.status).text}"


def of_actuators(bits: int) -> str:
    """Return which actuators something is of, by bits of GateState.engaged, to be put behind it."""
    names = [name for bit, name in enumerate(_ACTUATORS) if bits >> bit & 1]
    return f": {', '.join(names)}" if names else ""


def is_beside_line(state: GateState | None, controller: ControllerState | None) -> bool:
    """Return whether the controller has the vehicle's place beside a line; past the line's end it has none."""
    if state is not None and state.state in STEERING:
        return True
    if controller is None or Status(controller.status).has_ended:
        return False
    return math.isfinite(controller.tractor_lateral_error)


def refusals(state: GateState, controller: ControllerState | None) -> list[Cause]:
    """Return what stands against engaging, without what follows from the rest.

    Nothing while the gate still tests itself. Where the vehicle is to stand first, not that it stands; where the
    controller is silent, not what it alone reports, nor that it is before it can have reported; without a receiver not
    what follows from that; away from any line, as on a headland, not what only a controller beside a line can know;
    where drawbar only looks on, not what is to be tried before it steers, nor angles that nothing measures then.
    """
    if state.state in (SupervisorState.BOOT, SupervisorState.SELFTEST):
        return []
    found = [BY_CODE[code] for code in state.refusals if code]
    hidden = {Cause.CONTROLLER_SILENT} if controller is None and state.time - state.since < _FIRST else set()
    if state.state in LATCHED or Cause.EMERGENCY_UNTRIED in found:
        hidden.add(Cause.TOO_SLOW)
    if Cause.SHADOW in found:
        hidden |= UNTRIED if state.tractor_angle_time and state.trailer_angle_time else UNTRIED | OF_ANGLES
    if state.state is SupervisorState.ENGAGING:  # which turns the wheels there
        hidden.add(Cause.STEERING_APART)
    if controller is not None and not is_beside_line(state, controller):
        hidden |= _UNKNOWN_AWAY
        if found and not hidden.isdisjoint(found):
            found = [Cause.OFF_LINE, *(cause for cause in found if cause is not Cause.OFF_LINE)]
    if controller is not None and not _LACKING_RECEIVER.isdisjoint(controller.notices):
        hidden |= _UNKNOWN_WITHOUT_RECEIVER
    if Cause.CONTROLLER_SILENT in found:
        hidden |= _UNKNOWN_IN_SILENCE
    return [cause for cause in found if cause not in hidden]


def notices(controller: ControllerState | None, state: GateState | None) -> list[Cause]:
    """Return what the controller reports of sensors, but for what the gate reports itself."""
    said = state.refusals if state else ()
    return [BY_CODE[code] for code in controller.notices if code in BY_CODE and code not in said] if controller else []


def reason(cause: Cause) -> Text:
    """Return what stands against engaging, and what to do, in one line."""
    return Text(f"- {cause.sentence}: {cause.advice}")


def _state(state: GateState | None, controller: ControllerState | None) -> Iterator[Text]:
    yield headline(state, controller) if state else Text("the gate reports nothing yet", style="bold red")
    if state and state.stop and not stands(controller):
        yield Text("STOP THE VEHICLE", style="bold reverse red")


def stands(controller: ControllerState | None) -> bool:
    """Return whether the vehicle is known to stand, by its wheels, without them by the receiver."""
    if controller is None:
        return False
    wheels = controller.wheel_speed
    return abs(wheels if math.isfinite(wheels) else controller.receiver_speed) <= STANDS


def _numbers(state: GateState | None, controller: ControllerState | None) -> Iterator[Text]:
    if controller is None:
        yield Text("the controller reports nothing yet")
        return
    bodies, known = ("tractor", "trailer"), is_beside_line(state, controller)
    errors = [getattr(controller, f"{body}_lateral_error") if known else math.nan for body in bodies]
    yield Text("   ".join(f"{body} {_side(error)}" for body, error in zip(bodies, errors, strict=True)))
    age = f"   corrections {controller.correction_age:.0f} s" if math.isfinite(controller.correction_age) else ""
    yield Text(f"{_speed(controller.wheel_speed)}{age}")
    fixes = ", ".join(f"{body} {FixQuality(getattr(controller, f'{body}_quality')).name.lower()}" for body in bodies)
    yield Text(f"fix: {fixes}")


def _side(error: float) -> str:
    """Return a distance from the line in words."""
    if not math.isfinite(error):
        return "not known"
    centimetres = round(abs(error) * 100.0)
    return f"{centimetres} cm {'left' if error > 0.0 else 'right'}" if centimetres else "on the line"


def _speed(speed: float) -> str:
    return f"{speed * 3.6:.1f} km/h" if math.isfinite(speed) else "speed not known"
