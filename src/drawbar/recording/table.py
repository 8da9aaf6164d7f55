"""Table: the numbers of a log's steps as a CSV file, a row for each step and a column for each number."""

import csv
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from drawbar.recording.log import RunLog
from drawbar.signals import StepRecord

_LONG = ("samples", "poses", "steerings")
"""what has the length of the horizon has no column"""


def write_csv(log: RunLog, file: Path) -> None:
    """Write all steps, with names as `RunLog.column` takes them; a missing number is an empty cell.

    Raises:
        OSError: the file cannot be written.
    """
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        names = list(column_names(log))
        writer.writerow(["wall_time", *names])
        columns = [log.wall_time, *(log.column(name) for name in names)]
        for row in zip(*columns, strict=True):
            writer.writerow(["" if np.isnan(number) else repr(float(number)) for number in row])


def column_names(log: RunLog) -> Iterator[str]:
    """Yield the names of all numbers of a step, in the order of their declaration."""
    if log.records:  # a step that ends a run has no plan
        yield from number_names(max(log.records, key=_deviations))


def _deviations(record: StepRecord) -> int:
    return record.plan.tractor.deviation.size + record.plan.trailer.deviation.size


def number_names(value: Any, name: str = "") -> Iterator[str]:
    """Yield the names of all numbers of a signal, each after the name of what it is in."""
    if is_dataclass(value):
        for field in fields(value):
            if field.name not in _LONG:
                yield from number_names(getattr(value, field.name), f"{name}.{field.name}" if name else field.name)
    elif isinstance(value, np.ndarray):
        yield from (f"{name}.{index}" for index in range(value.size))
    elif value is not None:
        yield name
