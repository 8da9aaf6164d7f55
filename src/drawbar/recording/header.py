"""Header of a run: what is known before its first step, from its configuration and path."""

import math
import os
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from drawbar.config import Configuration, demand_configuration
from drawbar.control.settings import ArticulatedControllerSettings
from drawbar.errors import PathError, demand
from drawbar.geometry import LocalFrame
from drawbar.guidance.demands import largest_off_tracking, steering_shift
from drawbar.guidance.path import Path
from drawbar.recording.log import RunHeader
from drawbar.recording.path_table import PathTable, RecordedPoints

if TYPE_CHECKING:
    from drawbar.guidance.smoothing import DrivablePath


def run_header(
    configuration: Configuration,
    path: Path,
    drivable: "DrivablePath | None",
    seed: int = 0,
    frame: LocalFrame | None = None,
    *,
    shadow: bool = False,
) -> RunHeader:
    """Describe a run that starts now.

    Args:
        configuration: of the run.
        path: to drive along.
        drivable: how a recorded line was made drivable, None for other paths.
        seed: of everything random; a real machine has none.
        frame: of the path, where it is known otherwise than by its line.
        shadow: drawbar only looks on.

    Raises:
        ConfigurationError: the configuration is none.
        PathError: the path is none.
    """
    demand_configuration(configuration)
    demand("path", path, Path, "give one that build_path() made, or Path.through()", PathError)
    frame = frame or (drivable.frame if drivable else None)
    return RunHeader(
        configuration_name=configuration.name,
        configuration=configuration.to_toml(),
        seed=seed,
        started=datetime.now(UTC),
        vehicle=configuration.vehicle,
        path_name=configuration.path.track or os.path.basename(configuration.path.file) or "figure-eights",
        path_note="; ".join(path_notes(configuration, path, drivable)),
        path=PathTable.of(path),
        recorded=RecordedPoints.of(drivable.recorded, drivable.deviations) if drivable else None,
        origin=(frame.latitude, frame.longitude, frame.height) if frame else None,
        estimate_bounds=configuration.estimator.bounds_by_estimate(),
        shadow=shadow,
    )


_TOLD = 0.05
"""m; off-tracking that is reported"""
_ROOM = 0.15
"""m; what a body may be further from its line than off-tracking takes it, within a limit that does not stop it"""
_LITTLE, _ENOUGH = 0.345, 0.5
"""rad s^(-2/3): what the front wheels turn within the horizon, per (wheelbase / speed)^(2/3), with which a vehicle that
begins 1 m beside its line swings about it or loses it, and with which it does not (docs/theory/control.md)"""
_LONGEST = 60
"""samples; of much longer plans a solver may not find the best in the time of a step"""
_OFTEN = 0.3
"""wheelbases from one sample to the next, up to which no simulated vehicle strayed (docs/theory/control.md)"""
_SELDOM = 0.4
"""s from one sample to the next, up to which vehicles at 3 m/s keep their line however many wheelbases that are"""
_SLOWER = (0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1)
"""of the set speed, which are tried"""
_FAST = 0.5
"""m/s; at 0.4 m/s none of these vehicles swung, at 0.65 and 0.8 m/s others did"""


def path_notes(configuration: Configuration, path: Path, drivable: "DrivablePath | None") -> list[str]:
    """Return the warnings before a path is driven, in sentences."""
    notes = [_deviation_note(configuration, drivable)] if drivable else []
    off_tracking, curvature = largest_off_tracking(path, configuration.vehicle)
    if off_tracking > _TOLD:
        notes.append(_off_tracking_note(configuration, off_tracking, curvature))
    return [
        *notes,
        *_sampling_notes(configuration),
        *_shift_notes(configuration, path),
        *_horizon_notes(configuration),
    ]


def _deviation_note(configuration: Configuration, drivable: "DrivablePath") -> str:
    """Return how far a recorded line's points are from the path that will be driven."""
    worst, limit = int(drivable.deviations.argmax()), configuration.guidance.path_tolerance
    return (
        f"made drivable: at most {drivable.deviations[worst]:.2f} m off, at recorded point {worst + 1} of "
        f"{len(drivable.deviations)} (limit {limit:.2f} m)"
    )


def _off_tracking_note(configuration: Configuration, off_tracking: float, curvature: float) -> str:
    """Return how far apart the tracks of both bodies stay in the tightest curve, and who leaves the line for it."""
    limit = math.degrees(configuration.vehicle.trailer_steering_limit)
    taken = _taken_by_the_tractor(configuration, off_tracking)
    shared = f"; the tractor takes {taken:.2f} m of it by leaving its own line (controller.sharing)" if taken else ""
    return (
        f"in curves of {curvature:.3g} 1/m the trailer runs {off_tracking:.2f} m beside the tractor's track even with "
        f"its steering at its limit of {limit:.0f}° (vehicle.trailer_steering_limit); no controller takes that away, "
        f"wider curves or a larger limit do{shared}{_stops(configuration, taken, off_tracking - taken)}"
    )


def _stops(configuration: Configuration, tractor: float, trailer: float) -> str:
    """Return which limits stop a vehicle whose bodies leave their line so far (m), and what lets them."""
    limits = {
        "safety.drive.leaving": (configuration.safety.drive.leaving, max(tractor, trailer)),
        "sanity.leaving": (configuration.sanity.leaving, tractor),
    }
    raised = [
        f"{key} = {limit:g} m to {math.ceil(10.0 * (distance + _ROOM)) / 10.0:g} m"
        for key, (limit, distance) in limits.items()
        if distance + _ROOM > limit
    ]
    return f"; so far from their line the vehicle is stopped: raise {' and '.join(raised)}" if raised else ""


def _taken_by_the_tractor(configuration: Configuration, off_tracking: float) -> float:
    """Return how far the tractor leaves its line for a trailer that is so far beside it, m."""
    controller = configuration.controller
    if not isinstance(controller, ArticulatedControllerSettings) or controller.structure == "centralised":
        return 0.0
    sharing = controller.sharing
    return min(sharing.share * max(off_tracking - sharing.accepted_error, 0.0), 0.5 * off_tracking)


def _sampling_notes(configuration: Configuration) -> list[str]:
    """Return the warning about samples that are far apart."""
    speed, enough = configuration.speed, _OFTEN * configuration.vehicle.wheelbase
    if configuration.sample_time <= _SELDOM or speed * configuration.sample_time <= enough:
        return []
    return [
        f"a sample comes every {speed * configuration.sample_time:.2f} m, which is more than {_OFTEN:g} wheelbases "
        f"({enough:.2f} m): the vehicle may stray by decimetres in curves, or swing; lower sample_time to "
        f"{_floored(enough / speed):g} s, or speed to {_floored(enough / configuration.sample_time):g} m/s"
    ]


def _floored(value: float) -> float:
    return math.floor(100.0 * value) / 100.0


def _shift_notes(configuration: Configuration, path: Path) -> list[str]:
    """Return the warning about front wheels that take longer for the path's curves than these give them."""
    vehicle, limit = configuration.vehicle, configuration.guidance.path_tolerance

    def shift(speed: float) -> float:
        return steering_shift(path, vehicle, speed=speed, tolerance=limit)

    speed, now = configuration.speed, shift(configuration.speed)
    if not now > _TOLD:
        return []
    calm = next((share * speed for share in _SLOWER if not shift(share * speed) > _TOLD), None)
    slower = f"; at {calm:.2g} m/s it is {shift(calm):.2f} m" if calm else ""
    return [
        f"where the path's curves begin or end the tractor leaves its line by {now:.2f} m or more: at {speed:g} m/s "
        f"front wheels that turn at {vehicle.tractor_steering_rate:.2g} rad/s (vehicle.tractor_steering_rate) are too "
        f"slow for less{slower}"
    ]


def _horizon_notes(configuration: Configuration) -> list[str]:
    """Return the warning about a horizon within which the front wheels hardly turn."""
    controller, vehicle = configuration.controller, configuration.vehicle
    if not isinstance(controller, ArticulatedControllerSettings):
        return []
    scale = (vehicle.wheelbase / configuration.speed) ** (2.0 / 3.0)
    turned = vehicle.tractor_steering_rate * configuration.sample_time
    if configuration.speed < _FAST or turned * controller.horizon >= _LITTLE * scale:
        return []
    enough = math.ceil(_ENOUGH * scale / turned)
    longer = f", or raise controller.horizon to {enough}" if enough <= _LONGEST else ""
    return [
        f"plans reach {controller.horizon * configuration.sample_time:.2g} s ahead, in which the front wheels turn by "
        f"{controller.horizon * turned:.2g} rad: from 1 m beside its line the vehicle may swing about it or lose it; "
        f"begin on the line{longer}"
    ]
