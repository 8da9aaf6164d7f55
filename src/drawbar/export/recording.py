"""Recording for the example: the configuration's own path, and measurements of a simulated run along it."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import astuple, fields
from itertools import islice

from drawbar.guidance.path import Path
from drawbar.signals import Measurement, PathNode
from drawbar.simulation import Simulation

SECONDS = 30.0
"""how long the run is that is recorded; a shorter path ends it before"""


def path_table(path: Path) -> str:
    """Return the path's nodes as CSV, in the order of struct drawbar_path_node."""
    return _table(PathNode, path.nodes.tolist())


def path_array(path: Path) -> str:
    """Return the path's nodes as a C header: an array of struct drawbar_path_node for drawbar_set_path."""
    rows = "".join(f"    {{{', '.join(map(repr, row))}}},\n" for row in path.nodes.tolist())
    return (
        f"/* A path for drawbar_set_path: {len(path.nodes)} nodes, {path.length:.1f} m; written by drawbar path. */\n"
        f'#include "drawbar.h"\n\n'
        f"#define DRAWBAR_PATH_COUNT {len(path.nodes)}\n\n"
        f"static const struct drawbar_path_node drawbar_path[DRAWBAR_PATH_COUNT] = {{\n{rows}}};\n"
    )


def measurement_table(measurements: Iterable[Measurement]) -> str:
    """Return measurements as CSV, in the order of struct drawbar_measurement; a missing value is empty."""
    return _table(Measurement, map(astuple, measurements))


def record(simulation: Simulation) -> list[Measurement]:
    """Return what the sensors report in the first seconds of a run."""
    count = round(SECONDS / simulation.configuration.sample_time)
    with simulation:
        return [record.measurement for record in islice(simulation.steps(), count)]


def _table(kind: type[PathNode | Measurement], rows: Iterable[Sequence[float]]) -> str:
    names = (field.name for field in fields(kind))
    lines = [",".join(map(_text, row)) for row in rows]
    return "\n".join((",".join(names), *lines, ""))


def _text(value: float) -> str:
    """Return a number as it reads back; an enumeration's member as its number."""
    if isinstance(value, int):
        return str(int(value))
    return "" if math.isnan(value) else repr(value)
