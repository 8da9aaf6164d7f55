"""What the example needs: the configuration's own path, and measurements of a simulated run along it."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import astuple, fields
from itertools import islice

from drawbar.guidance.path import Path
from drawbar.signals import Measurement
from drawbar.simulation import Simulation

SECONDS = 30.0
"""how long the run is that is recorded; a shorter path ends it before"""
MEASURED = tuple(field.name for field in fields(Measurement))


def path_table(path: Path) -> str:
    """Return the path's nodes as CSV."""
    return _table(("arc_length", "x", "y", "yaw"), path.nodes.tolist())


def measurement_table(measurements: Iterable[Measurement]) -> str:
    """Return measurements as CSV; a missing value is empty."""
    return _table(MEASURED, map(astuple, measurements))


def record(simulation: Simulation) -> list[Measurement]:
    """Return what the sensors report in the first seconds of a run."""
    count = round(SECONDS / simulation.configuration.sample_time)
    with simulation:
        return [record.measurement for record in islice(simulation.steps(), count)]


def _table(names: Sequence[str], rows: Iterable[Sequence[float]]) -> str:
    lines = [",".join("" if math.isnan(value) else repr(value) for value in row) for row in rows]
    return "\n".join((",".join(names), *lines, ""))
