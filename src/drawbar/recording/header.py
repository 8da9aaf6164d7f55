"""Header of a run: what is known before its first step, from its configuration and path."""

import os
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from drawbar.config import Configuration, demand_configuration
from drawbar.errors import PathError, demand
from drawbar.geometry import LocalFrame
from drawbar.guidance.path import Path
from drawbar.recording.log import PathTable, RecordedPoints, RunHeader

if TYPE_CHECKING:
    from drawbar.guidance.smoothing import DrivablePath


def run_header(
    configuration: Configuration,
    path: Path,
    drivable: "DrivablePath | None",
    seed: int = 0,
    frame: LocalFrame | None = None,
) -> RunHeader:
    """Describe a run that starts now.

    Args:
        configuration: of the run.
        path: to drive along.
        drivable: how a recorded line was made drivable, None for other paths.
        seed: of everything random; a real machine has none.
        frame: of the path, where it is known otherwise than by its line.

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
        path_note=deviation_note(configuration, drivable) if drivable else "",
        path=PathTable.of(path),
        recorded=RecordedPoints.of(drivable.recorded, drivable.deviations) if drivable else None,
        origin=(frame.latitude, frame.longitude, frame.height) if frame else None,
        estimate_bounds=configuration.estimator.bounds_by_estimate(),
    )


def deviation_note(configuration: Configuration, drivable: "DrivablePath") -> str:
    """Return how far a recorded line's points are from the path that will be driven."""
    worst, limit = int(drivable.deviations.argmax()), configuration.guidance.path_tolerance
    return (
        f"made drivable: at most {drivable.deviations[worst]:.2f} m off, at recorded point {worst + 1} of "
        f"{len(drivable.deviations)} (limit {limit:.2f} m)"
    )
