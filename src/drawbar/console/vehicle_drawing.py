"""Vehicle drawing: both bodies to scale, from above and from the side, with every length that can be set up; an SVG."""

from collections.abc import Iterator

import numpy as np

from drawbar.console.set_up_values import LENGTHS, MASTS, SetUpValue
from drawbar.geometry import Floats
from drawbar.report.outline import tractor_outline, trailer_outline
from drawbar.signals import Pose
from drawbar.vehicle.parameters import VehicleParameters

_MARGIN, _ROW = 0.35, 0.3
"""m in the drawing"""
_GROUND, _TYRES = 0.55, 0.35
"""half the bodies' width, and the radius of the wheels in the side view, m"""

_FINGER = 1.7
"""radius of what can be touched around a letter, by its size: 20 pixels on a phone"""


def vehicle_drawing(vehicle: VehicleParameters) -> str:
    """Return the SVG. The tractor's rear axle is at x = 0, and the front is on the right; distances are in m."""
    axle = -vehicle.hitch_length - vehicle.trailer_length
    tracked = axle + vehicle.trailer_antenna
    masts = vehicle.masts.tractor, vehicle.masts.trailer
    antennas = masts[0].forward, tracked + masts[1].forward
    left = min(axle - _TYRES, *antennas) - _MARGIN
    right = max(vehicle.wheelbase + _TYRES, *antennas) + _MARGIN
    size = (right - left) / 24.0
    row = max(_ROW, 1.3 * size)
    highest = max(1.0, *(mast.up for mast in masts))
    side = -max(_GROUND, *(mast.left for mast in masts)) - row - _MARGIN  # of the ground in the side view
    dimensions = list(_dimensions(vehicle, tracked, axle, row))
    bottom = max(y for _, _, _, y in dimensions) + row
    parts = [
        *_bodies(vehicle, tracked),
        *_masts(vehicle, tracked, size),
        *_side_view(vehicle, tracked, axle, side, size),
    ]
    parts += [_dimension(value, low, high, y, size) for value, low, high, y in dimensions]
    top = side - highest - 1.5 * size
    box = f"{left:.3f} {top:.3f} {right - left:.3f} {bottom - top:.3f}"
    return f'<svg class="vehicle-drawing" viewBox="{box}" aria-hidden="true">{"".join(parts)}</svg>'


def _dimensions(
    vehicle: VehicleParameters, tracked: float, axle: float, row: float
) -> Iterator[tuple[SetUpValue, float, float, float]]:
    """Yield each distance along the vehicle: what it is, from where to where, and on which height it is written."""
    joint = -vehicle.hitch_length
    wheelbase, hitch, drawbar, trailer, antenna = LENGTHS
    masts = vehicle.masts
    first = max(_GROUND, -masts.tractor.left, -masts.trailer.left) + 0.35 + row
    yield wheelbase, 0.0, vehicle.wheelbase, first
    yield hitch, joint, 0.0, first
    yield trailer, axle, joint, first
    yield drawbar, joint, joint + vehicle.drawbar_length, first + row
    yield antenna, axle, tracked, first + row
    for value, origin, mast in ((MASTS[0], 0.0, masts.tractor), (MASTS[3], tracked, masts.trailer)):
        yield value, min(origin, origin + mast.forward), max(origin, origin + mast.forward), first + 2.0 * row


def _bodies(vehicle: VehicleParameters, tracked: float) -> Iterator[str]:
    outlines = (
        ("tractor-shape", tractor_outline(Pose(x=0.0, y=0.0, yaw=0.0), 0.0, vehicle)),
        ("trailer-shape", trailer_outline(Pose(x=tracked, y=0.0, yaw=0.0), vehicle)),
    )
    for name, outline in outlines:
        for shape in np.split(outline, np.flatnonzero(np.isnan(outline[:, 0])) + 1):
            corners: Floats = shape[~np.isnan(shape[:, 0])]
            if len(corners):
                points = " ".join(f"{x:.3f},{-y:.3f}" for x, y in corners)
                yield f'<polygon class="{name}" points="{points}"/>'
    yield f'<line class="drawbar" x1="{-vehicle.free_joint_offset}" x2="{-vehicle.hitch_length}" y1="0" y2="0"/>'
    for x in (-vehicle.free_joint_offset, -vehicle.hitch_length):
        yield f'<circle class="joint" cx="{x:.3f}" cy="0" r="0.06"/>'


def _masts(vehicle: VehicleParameters, tracked: float, size: float) -> Iterator[str]:
    """Yield the antennas from above, and how far left of the middle they stand."""
    for origin, mast, value in (
        (0.0, vehicle.masts.tractor, MASTS[1]),
        (tracked, vehicle.masts.trailer, MASTS[4]),
    ):
        x = origin + mast.forward
        yield f'<circle class="antenna" cx="{x:.3f}" cy="{-mast.left:.3f}" r="0.09"/>'
        if mast.left:
            yield f'<line class="dimension" x1="{x:.3f}" x2="{x:.3f}" y1="0" y2="{-mast.left:.3f}"/>'
        yield _letter(value, x + 0.8 * size, -0.5 * mast.left - 0.35 * size, size)


def _side_view(vehicle: VehicleParameters, tracked: float, axle: float, ground: float, size: float) -> Iterator[str]:
    left, right = axle - _TYRES, vehicle.wheelbase + _TYRES
    yield f'<line class="ground" x1="{left:.3f}" x2="{right:.3f}" y1="{ground:.3f}" y2="{ground:.3f}"/>'
    for x, radius, name in (
        (0.0, _TYRES, "tractor-shape"),
        (vehicle.wheelbase, 0.7 * _TYRES, "tractor-shape"),
        (axle, 0.75 * _TYRES, "trailer-shape"),
    ):
        yield f'<circle class="{name}" cx="{x:.3f}" cy="{ground - radius:.3f}" r="{radius:.3f}"/>'
    for origin, mast, value in (
        (0.0, vehicle.masts.tractor, MASTS[2]),
        (tracked, vehicle.masts.trailer, MASTS[5]),
    ):
        x, top = origin + mast.forward, ground - mast.up
        if mast.up:
            yield f'<line class="mast" x1="{x:.3f}" x2="{x:.3f}" y1="{ground:.3f}" y2="{top:.3f}"/>'
            yield f'<circle class="antenna" cx="{x:.3f}" cy="{top:.3f}" r="0.09"/>'
        above = 0.5 * (ground + top) if mast.up else ground - 2.0 * _TYRES - 0.5 * size
        yield _letter(value, x + 0.8 * size, above, size)


def _dimension(value: SetUpValue, low: float, high: float, y: float, size: float) -> str:
    """Return a distance with its ends and its letter."""
    ends = "".join(
        f'<line class="end" x1="{x:.3f}" x2="{x:.3f}" y1="{y - 0.3 * size:.3f}" y2="{y + 0.3 * size:.3f}"/>'
        for x in (low, high)
    )
    line = f'<line class="dimension" x1="{low:.3f}" x2="{high:.3f}" y1="{y:.3f}" y2="{y:.3f}"/>'
    return ends + line + _letter(value, 0.5 * (low + high), y - 0.25 * size, size)


def _letter(value: SetUpValue, x: float, y: float, size: float) -> str:
    """Return a letter that leads to its number, with room for a finger around it."""
    act = f"document.getElementById('{number_id(value)}')?.focus()"
    text = f'<text x="{x:.3f}" y="{y:.3f}" font-size="{size:.3f}" text-anchor="middle">{value.letter}</text>'
    room = f'<circle cx="{x:.3f}" cy="{y - 0.35 * size:.3f}" r="{_FINGER * size:.3f}"/>'
    return f'<g class="letter" onclick="{act}">{room}{text}</g>'


def number_id(value: SetUpValue) -> str:
    """Return the id of the input of a value in the page."""
    return "set-" + value.key.replace(".", "-")
