"""Reasons: why a run cannot begin, and why it has ended, in sentences."""

import math

import numpy as np

from drawbar.errors import DrawbarError, HardwareError, PathError
from drawbar.geometry import wrap
from drawbar.guidance.beginning import demand_near
from drawbar.safety.gate import PATIENCE
from drawbar.signals import Estimate, Measurement, Status, StepRecord
from drawbar.step.autopilot import Autopilot
from drawbar.step.build import ENDURANCE

_SWAPPED = math.radians(120.0)
"""facing so far away from the path, a vehicle that drove along it may have its antennas swapped, rad"""
_SIDE_SLIP = 4.5
"""HITCH_SIDE_SLIP of hitch_watch.h, degrees"""
_STUCK = 2
"""a doubt of lean_watch.h: the roll stands still"""


def refusal(status: Status, autopilot: Autopilot, first: Measurement) -> DrawbarError:
    """Return the error with the reason why a run cannot begin."""
    if status is Status.NO_PATH:
        return PathError("the autopilot has no path; call autopilot.begin(path) before it drives")
    if not np.isfinite([first.tractor_x, first.tractor_y, first.trailer_x, first.trailer_y]).all():
        return HardwareError(
            f"The first measurement lacks a position (tractor {first.tractor_x}, {first.tractor_y}; "
            f"trailer {first.trailer_x}, {first.trailer_y}); wait for a fix of both antennas to start."
        )
    try:
        reach = _live(autopilot, "guidance", "guidance.start_distance")
        demand_near(autopilot.path, autopilot.start, first.tractor_x, first.tractor_y, reach)
    except PathError as error:
        return error
    return PathError(Status.START.text)


def reason(status: Status, before: Status, record: StepRecord, autopilot: Autopilot) -> str:
    """Return why a run has ended; `before`: the status of the step before its last."""
    at = f"At {record.measurement.time:.1f} s"
    if status is Status.OFF_COURSE:
        return f"{at} {_off_course(abs(record.reference.tractor.lateral_error), autopilot)}"
    if status is Status.BLIND:
        return f"{at} {_without_fixes(autopilot)}"
    if status is Status.STEERING:
        return f"{at} {_not_followed(record, autopilot)}"
    if status is Status.HITCH:
        return f"{at} {_contradicted(record, autopilot)}"
    if status is Status.ROLL:
        return f"{at} {_leans_otherwise(record, autopilot)}"
    if status is Status.STOPPED and before is Status.TIME:
        return f"{at} the machine's time stamps had not increased, or were not finite, for {PATIENCE} s."
    if status is Status.STOPPED:
        return f"{at} the gate had refused every command for as long as one may be repeated ({PATIENCE:g} s)."
    if status is Status.UNSOLVED:
        return f"{at} estimator and controllers had not all had a solution for {ENDURANCE:.0f} s."
    if status is Status.GUIDANCE:
        return f"{at} {_lost(record.estimate, autopilot)}"
    return f"{at} the run was {status.text}."


def _off_course(away: float, autopilot: Autopilot) -> str:
    """Return how far (m) the tractor was from the path, and how far it may be."""
    lost, leaving = (_live(autopilot, "run_monitor", name) for name in ("lost", "leaving"))
    if away > lost or math.isnan(away):
        return f"the tractor was {away:.2f} m from the path (limit {lost:g} m)."
    return (
        f"the tractor, which had followed the path, was {away:.2f} m from it (limit {leaving:g} m, sanity.leaving): "
        f"its steering does not suffice for the path, or does not do what is commanded."
    )


def _without_fixes(autopilot: Autopilot) -> str:
    """Return how far the vehicle has gone without a fix, and how far and for how long it may."""
    distance, longest, most = (
        _live(autopilot, "run_monitor", name) for name in ("distance", "blind", "blind_deviation")
    )
    return (
        f"neither antenna had had a valid fix for {distance:.1f} m; "
        f"the limits are {longest:g} s, and a standard deviation across the line of {most:g} m."
    )


def _live(autopilot: Autopilot, component: str, name: str, place: int = 0) -> float:
    """Return a number of a component."""
    return float(autopilot.library.components[component].live.array(name)[place])


def _not_followed(record: StepRecord, autopilot: Autopilot) -> str:
    """Return which steering does not follow its commands."""
    sensed, angles = record.measurement, []
    for place, body, name in ((0, "tractor", "the front wheels"), (1, "trailer", "the trailer's joint")):
        stuck = _live(autopilot, "actuation", "stuck_time", place) > 0.0
        if stuck or _live(autopilot, "actuation", "unexplained_time", place) > 0.0:
            measured, asked = (math.degrees(getattr(each, f"{body}_steering")) for each in (sensed, record.command))
            shows = f"the sensor of {name} shows {'the very same ' if stuck else ''}{measured:.1f}°"
            angles.append(f"{shows}, {asked:.1f}° were commanded")
    return (
        f"{'; '.join(angles)}: it is stuck or has the wrong sign, the actuator does not follow its commands, or "
        f"somebody steers; look at `drawbar check --wiggle`."
    )


def _contradicted(record: StepRecord, autopilot: Autopilot) -> str:
    """Return which of the trailer's angles contradicts the motion: the one that is farther from its estimate."""
    names = {"hitch_angle": "hitch angle", "trailer_steering": "trailer's joint"}
    pairs = {name: [math.degrees(getattr(of, name)) for of in (record.measurement, record.estimate)] for name in names}
    crabs = [math.degrees(angle) for angle in (record.estimate.tractor_crab, record.estimate.trailer_crab)]
    if abs(crabs[0] - crabs[1]) > _SIDE_SLIP:
        return (
            f"by the measured angles of hitch and joint the tractor slides sideways by {crabs[0]:.1f}° and the "
            f"trailer by {crabs[1]:.1f}°, which no firm ground does: one of both sensors drifts or is off, a length "
            f"is, or wheels slide."
        )
    stuck = _live(autopilot, "sanity", "hitch.stuck_time") > 0.0
    worst = "hitch_angle" if stuck else max(names, key=lambda name: abs(pairs[name][0] - pairs[name][1]))
    measured, found = pairs[worst]
    why = "it is stuck" if stuck else "it is stuck, has the wrong sign or is off, a stated length is, or wheels slide"
    return (
        f"the sensor of the {names[worst]} shows {measured:.1f}°, which contradicts the motion of both bodies "
        f"({found:.1f}° are estimated): {why}."
    )


def _leans_otherwise(record: StepRecord, autopilot: Autopilot) -> str:
    """Return which roll sensor is wrong, and what about it."""
    sensors = []
    for place, body in enumerate(("tractor", "trailer")):
        doubt = _live(autopilot, "alignment", "positions.leans.faults", place)
        if doubt:
            shown = f"{math.degrees(getattr(record.measurement, f'{body}_roll')):.1f}°"
            wrong = "stands still while it does not" if doubt == _STUCK else "is reversed"
            sensors.append(f"the roll of the {body} ({shown}) {wrong}")
    return (
        f"{' and '.join(sensors)}, as the swing of its antenna, its pitch in other headings and the other body's "
        "attitude show: right side down is positive; look at the sensor's mounting and at the mast's height."
    )


def _lost(estimate: Estimate, autopilot: Autopilot) -> str:
    """Return why guidance had no reference."""
    guidance = autopilot.library.components["guidance"].live
    for pose in (estimate.tractor, estimate.trailer):
        if not math.isfinite(pose.x + pose.y + pose.yaw):
            return f"the estimated {pose} was not finite."
    speed = estimate.longitudinal_slip * estimate.speed
    if not math.isfinite(speed):
        return f"the estimated speed over ground was {speed} m/s."
    tractor, progress = estimate.tractor, guidance.array("guidance.progress")[0]
    turned = wrap(tractor.yaw - float(autopilot.path.sample(np.array(progress))[2]))
    curvature, rate, room = (float(guidance.array(name)[0]) for name in ("limits.curvature", "limits.rate", "room"))
    return (
        f"the tractor at ({tractor.x:z.2f}, {tractor.y:z.2f}) m faced {math.degrees(turned):.0f}° away from the "
        f"path; turns of {curvature:g} 1/m and {rate:g} 1/m² do not lead onto it within "
        f"{room:g} m beside it: turn the vehicle by hand, or raise guidance.turning_room or "
        f"vehicle.curvature_limit{'; or are the antennas swapped?' if abs(turned) > _SWAPPED else ''}"
    )
