"""Logs of arbitrary steps, and their exact comparison."""

import dataclasses
import types
import typing
from datetime import UTC, datetime
from enum import IntEnum, IntFlag

import msgspec
import numpy as np
from mcap.writer import Writer

from drawbar.guidance.figure_eight import figure_eights
from drawbar.recording.encoding import encode_special
from drawbar.recording.log import RunHeader
from drawbar.recording.path_table import PathTable, RecordedPoints
from drawbar.recording.recorder import Recorder
from drawbar.signals import StepRecord
from drawbar.vehicle.parameters import VehicleParameters

SHAPES = {"closest": (4,), "samples": (3, 4), "poses": (3, 3), "steerings": (2,), "deviation": (3,)}
PREDICTED = ("poses", "steerings")
"""what is recorded in single precision"""


def arbitrary(kind, name, rng):
    """Return a random value of a signal's type; every seventh number is missing."""
    if isinstance(kind, types.UnionType):
        kind = kind.__args__[0]
    if dataclasses.is_dataclass(kind):
        hints = typing.get_type_hints(kind)
        return kind(**{field: arbitrary(hint, field, rng) for field, hint in hints.items()})
    if kind is float:
        if name == "time":
            return float(rng.exponential())
        return float("nan") if rng.random() < 1 / 7 else float(rng.normal() * 1e3)
    if isinstance(kind, type) and issubclass(kind, IntEnum | IntFlag):
        return list(kind)[int(rng.integers(len(kind)))]
    if kind in (int, bool):
        return kind(rng.integers(0, 2))
    array = rng.normal(size=SHAPES[name])
    array.flat[0] = np.nan
    return array.astype(np.float32).astype(float) if name in PREDICTED else array


def arbitrary_step(seed):
    return arbitrary(StepRecord, "", np.random.default_rng(seed))


def header():
    return RunHeader(
        configuration_name="articulated",
        configuration="[vehicle]\nwheelbase = 1.4 # ü\n",
        seed=3,
        started=datetime(2026, 5, 4, 3, 2, 1, tzinfo=UTC),
        vehicle=VehicleParameters(joint_sign=-1),
        path=PathTable.of(figure_eights([1.0], 1.0)),
        path_name="eights",
        path_note="as recorded",
        recorded=RecordedPoints.of(np.array([[0.0, 0.1], [3.0, 0.2]]), np.array([0.1, 0.2])),
        estimate_bounds={"longitudinal_slip": (0.25, 1.0)},
    )


def assert_identical(left, right):
    """Exact equality, fields in depth, where NaN equals NaN and arrays keep shape and type."""
    assert type(left) is type(right)
    if dataclasses.is_dataclass(left):
        for field in dataclasses.fields(left):
            assert_identical(getattr(left, field.name), getattr(right, field.name))
    elif isinstance(left, np.ndarray):
        assert left.dtype == right.dtype
        np.testing.assert_array_equal(left, right, strict=True)
    else:
        assert left == right or (left != left and right != right)


def write(file, count):
    records = [arbitrary_step(seed) for seed in range(count)]
    with Recorder(file, header()) as recorder:
        for record in records:
            recorder.write(record)
    return records


def write_as_json(file, count):
    """Write a log as earlier versions did, without chunks."""
    encoder = msgspec.json.Encoder(enc_hook=encode_special)
    with file.open("wb") as stream:
        writer = Writer(stream, use_chunking=False)
        writer.start(profile="drawbar")
        writer.add_attachment(0, 0, "run.json", "application/json", encoder.encode(header()))
        channel = writer.register_channel("/step", "json", writer.register_schema("StepRecord", "jsonschema", b"{}"))
        for seed in range(count):
            writer.add_message(channel, seed, encoder.encode(arbitrary_step(seed)), seed, seed)
        writer.finish()
