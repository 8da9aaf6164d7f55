"""Guidance: from where the vehicle is to what its two controllers shall follow (guidance.h).

The closest point of each body is searched in a window around that body's last progress, never on the whole path: where
the path crosses itself a global search would jump to the other branch.
"""

from collections.abc import Mapping

from numpy.typing import ArrayLike

from drawbar.codegen import Unit
from drawbar.guidance.settings import GuidanceSettings
from drawbar.vehicle.parameters import VehicleParameters


def preview_unit(settings: GuidanceSettings, vehicle: VehicleParameters, *, stages: int, interval: float) -> Unit:
    """Return guidance by the path itself, at the pace at which the vehicle will cover it (preview.h).

    Stage j of each body is the path at its progress plus j mu v dt; it never moves back. A tractor that faces away from
    what it shall follow is led onto the path by turns (approach.h); the trailer comes after as it may.

    Args:
        settings: of the guidance.
        vehicle: how tightly it turns.
        stages: of the references, which have one sample more.
        interval: between stages, s.
    """
    values: dict[str, ArrayLike] = {
        "limits.curvature": vehicle.curvature_limit,
        "limits.rate": settings.curvature_rate_limit,
        "interval": interval,
        "wheelbase": vehicle.wheelbase,
        "room": settings.turning_room,
        "guidance.tracked[TRACTOR].arm": vehicle.tracked.tractor.arm,
        "guidance.tracked[TRAILER].arm": vehicle.tracked.trailer.arm,
        "guidance.tracked[TRAILER].axle": vehicle.trailer_antenna,
    }
    return _unit("preview.h", stages, settings, values)


def look_ahead_unit(settings: GuidanceSettings, *, stages: int, interval: float, speed: float) -> Unit:
    """Return the paper's guidance: references from the point a fixed distance ahead of the closest one (look_ahead.h).

    The tractor's reference advances from that point at nominal speed (m/s), the trailer's stays there.
    """
    values: dict[str, ArrayLike] = {"look_ahead": settings.look_ahead, "advance": (speed * interval, 0.0)}
    return _unit("look_ahead.h", stages, settings, values)


def _unit(header: str, stages: int, settings: GuidanceSettings, values: Mapping[str, ArrayLike]) -> Unit:
    """Return the unit of a kind of guidance with that kind's own settings."""
    every = {
        **values,
        "guidance.window_behind": settings.window_behind,
        "guidance.window_ahead": settings.window_ahead,
        "guidance.start_distance": settings.maximum_start_distance,
    }
    source = f'#define STAGES {stages}\n#include "{header}"\n'
    return Unit(name="guidance", source=source, configure=lambda workspace: workspace.write(every))
