"""Sections of the page about a run, in their order: a heading, what to look for, and a picture."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from drawbar.recording.log import Columns
from drawbar.report import style
from drawbar.report.figures import (
    ancillary_figure,
    compared_figure,
    error_figure,
    estimate_figure,
    heading_figure,
    hitch_figure,
    margin_figure,
    solve_time_figure,
    speed_figure,
    steering_figure,
)
from drawbar.report.map import map_figure
from drawbar.report.masts import doubt_text, mast_doubt, mounting_text
from drawbar.report.path_errors import Bodies, PathErrors
from drawbar.report.positions import antennas_aside, lasting_residual, position_texts, rejected_share
from drawbar.report.scene import scene_figure
from drawbar.report.shadow import Shadow
from drawbar.report.style import Figure
from drawbar.report.two_antennas import yaw_difference, yaw_text

_FACTORS = {
    "longitudinal_slip": ("μ", style.ESTIMATOR),
    "tractor_slip": ("κ", style.TRACTOR),
    "trailer_slip": ("η", style.TRAILER),
}
_ANGLES = {
    "steering_offset": ("b", style.ESTIMATOR),
    "tractor_crab": ("αr", style.TRACTOR),
    "trailer_crab": ("αi", style.TRAILER),
}
_PARAMETERS = {
    "longitudinal_slip": "speed factor μ",
    "tractor_slip": "steering factor κ of the front wheels",
    "trailer_slip": "steering factor η of the trailer",
    "steering_offset": "offset b of the front wheels",
    "tractor_crab": "side-slip αr of the rear axle",
    "trailer_crab": "side-slip αi of the trailer's axle",
}
"""what the symbols of estimated parameters stand for"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """One picture with its heading and what to look for in it."""

    name: str
    title: str
    note: str
    figure: Figure
    along_path: bool = True


def _views(log: Columns) -> list[Section]:
    whose = "True positions." if log.has_truth else "Estimated positions: a drive does not know the true ones."
    whose = whose if log.steps else "No step was made."
    return [
        Section(
            name="map",
            title="Map",
            note=f"{whose} Scroll to zoom, drag to move; the outlines show the machine at a few moments, "
            "dots follow the pointer in the figures below.",
            figure=map_figure(log),
            along_path=False,
        ),
        Section(
            name="scene",
            title="On the ground",
            note="Heights are to scale; colours show how far the ground is above or below the slope. Drag to turn, "
            "scroll to come nearer. Thin lines are the antennas on their masts, thick ones the points on the ground.",
            figure=scene_figure(log),
            along_path=False,
        ),
    ]


def _driving(log: Columns, errors: Bodies[PathErrors]) -> list[Section]:
    whose = "Of the driver's vehicle, at its" if log.header.shadow else "Of the"
    return [
        Section(
            name="errors",
            title="Distance from the path",
            note=f"{whose} points on the ground. Curves are shaded, with their curvature in 1/m where the path gives "
            f"it.{_doubt(log)}",
            figure=error_figure(log, errors),
        ),
        Section(
            name="heading",
            title="Heading error",
            note="Of both bodies against the path beside them; true yaws where they are known.",
            figure=heading_figure(log),
        ),
        Section(
            name="speed",
            title="Speed",
            note="Of the wheels: what was commanded, measured, and estimated.",
            figure=speed_figure(log),
        ),
        Section(
            name="hitch",
            title="Hitch angle",
            note="Between tractor and drawbar, at the free joint.",
            figure=hitch_figure(log),
        ),
    ]


def _doubt(log: Columns) -> str:
    """Write what makes positions doubtful: masts, askew sensors, and what the fixes contradict."""
    doubt = doubt_text(mast_doubt(log, "tractor"), mast_doubt(log, "trailer"))
    askew = (mounting_text(log, body) for body in ("tractor", "trailer"))
    residual, rejected = (
        Bodies(tractor=figure(log, "tractor"), trailer=figure(log, "trailer"))
        for figure in (lasting_residual, rejected_share)
    )
    of_positions = position_texts(residual, rejected, antennas_aside(log))
    found = [doubt, *askew, yaw_text(yaw_difference(log)), *of_positions]
    return "".join(f" {text[0].upper()}{text[1:]}." for text in found if text)


def _compared(log: Columns, shadow: Shadow) -> list[Section]:
    gaps = "Each command is drawn at the step after which it would have acted; gaps: something stood against engaging."
    titles = {"tractor": ("Steering of the tractor", "Front wheels"), "trailer": ("Steering of the trailer", "Joint")}
    return [
        Section(
            name=f"{body}-steering",
            title=f"{title}: drawbar beside the driver",
            note=f"{what}. {gaps}",
            figure=compared_figure(log, body, getattr(shadow.steerings, body)),
        )
        for body, (title, what) in titles.items()
    ]


def _steering(log: Columns) -> list[Section]:
    reversed_actuator = (
        " The actuator is reversed (joint_sign = -1): the joint goes to the mirror image of its command."
        if log.header.vehicle.joint_sign == -1
        else ""
    )
    return [
        Section(
            name="tractor-steering",
            title="Steering of the tractor",
            note="Front wheels.",
            figure=steering_figure(log, "tractor"),
        ),
        Section(
            name="trailer-steering",
            title="Steering of the trailer",
            note="Actuated joint between drawbar and trailer." + reversed_actuator,
            figure=steering_figure(log, "trailer"),
        ),
    ]


def _laws(log: Columns) -> list[Section]:
    return [
        Section(
            name="ancillary",
            title="What the ancillary law adds",
            note="The part of each command that answers the deviation from the nominal prediction.",
            figure=ancillary_figure(log),
        ),
        Section(
            name="margin",
            title="Margin of the tubes",
            note="How far inside its tube each body is: 100 % at the centre, 0 on the boundary; negative outside, "
            "where declared bounds do not hold.",
            figure=margin_figure(log),
        ),
    ]


def _named(log: Columns, names: Iterable[str], zoom: str) -> str:
    """Return a note that names the parameters that the run's estimator has."""
    words = ", ".join(_PARAMETERS[name] for name in names if name in log.header.estimate_bounds)
    return f"{words[:1].upper()}{words[1:]}. {zoom}"


def _estimates(log: Columns) -> list[Section]:
    zoom = "Dashed: bounds of the estimator, zoom out where they are not in sight."
    return [
        Section(
            name="factors",
            title="Slip",
            note=_named(log, _FACTORS, zoom),
            figure=estimate_figure(log, _FACTORS, "Factor", "", 1.0),
        ),
        Section(
            name="angles",
            title="Steering offset and side-slip",
            note=_named(log, _ANGLES, zoom),
            figure=estimate_figure(log, _ANGLES, "Angle, °", "°", math.degrees(1.0)),
        ),
    ]


def all_sections(log: Columns, errors: Bodies[PathErrors], shadow: Shadow | None = None) -> list[Section]:
    """Return everything the page shows of a run; what its estimator does not have leaves no empty section.

    Of one at which drawbar only looked on, its commands beside the driver's angles come before what came of these.
    """
    solving = Section(
        name="solve-times",
        title="Solve times",
        note="Preparation runs after the actuation, feedback between measurement and command.",
        figure=solve_time_figure(log),
        along_path=False,
    )
    driving = _driving(log, errors)
    driven = [*driving, *_steering(log)] if shadow is None else [*_compared(log, shadow), *driving]
    sections = [*_views(log), *driven, *_laws(log), *_estimates(log), solving]
    return [section for section in sections if section.figure["data"]]
