"""A recorded step lies in bytes as C, the log's schema and Python say alike."""

import dataclasses
import math
from itertools import count
from typing import Any, get_type_hints

import numpy as np
import pytest

from drawbar.errors import DrawbarError, SignalError
from drawbar.recompute import Comparison
from drawbar.signals import StepRecord
from drawbar.step import layout
from drawbar.step.layout import StepLayout, packed, step_schema, unpacked


@pytest.fixture(scope="module")
def record(build: Any) -> StepRecord:
    steps = build("articulated").steps()
    found: StepRecord = [next(steps) for _ in range(20)][-1]
    steps.close()
    return found


@pytest.fixture(scope="module")
def plain(record: StepRecord) -> StepRecord:
    """Return the same step without the bytes that C made of it."""
    return dataclasses.replace(record)


def differences(one: StepRecord, other: StepRecord) -> tuple[Any, ...]:
    comparison = Comparison(common_only=False)
    comparison.add(0, one, other, names=[field.name for field in dataclasses.fields(StepRecord)])
    return comparison.replay([]).differences


def test_bytes_that_c_made_are_those_that_python_makes(record: StepRecord, plain: StepRecord) -> None:
    assert packed(record) is record.__dict__["packed"]
    assert "packed" not in plain.__dict__
    assert packed(plain) == packed(record)


def test_a_step_comes_out_of_its_bytes_as_it_was(record: StepRecord) -> None:
    assert differences(record, unpacked(packed(record))) == ()
    assert unpacked(packed(record)).truth == record.truth


def test_each_number_has_a_place_of_its_own(plain: StepRecord) -> None:
    numbers = count(1)

    def numbered(value: Any) -> Any:
        if dataclasses.is_dataclass(value):
            hints = get_type_hints(type(value))
            return type(value)(**{name: numbered(getattr(value, name)) for name in hints})
        if isinstance(value, np.ndarray):
            return np.array([next(numbers) for _ in value.flat], float).reshape(value.shape)
        return float(next(numbers)) if isinstance(value, float) else value

    step = numbered(plain)
    assert differences(step, unpacked(packed(step))) == ()


def test_changed_steps_do_not_keep_their_bytes(record: StepRecord) -> None:
    changed = dataclasses.replace(record, truth=None, step=7)
    again = unpacked(packed(changed))
    assert (again.truth, again.step) == (None, 7)


def test_a_number_that_the_schema_lacks_has_its_default(plain: StepRecord) -> None:
    names = ("fix_latency", "tractor_roll", "tractor_fix_quality")
    earlier = "\n".join(
        line for line in step_schema(20).splitlines() if not any(f" {name} " in f"{line} " for name in names)
    )
    old = StepLayout.of_schema(earlier)
    step = old.reader()(old.pack(plain))
    assert (step.actuation.fix_latency, step.measurement.tractor_fix_quality) == (0.0, 0)
    assert math.isnan(step.measurement.tractor_roll)
    assert step.measurement.tractor_steering == plain.measurement.tractor_steering
    assert step.status == plain.status


def test_a_number_that_the_schema_lacks_and_every_step_has_is_named() -> None:
    earlier = (
        step_schema(3).replace("float64 hitch_angle  # beta\n", "").replace("hitch_angle  # beta", "angle  # beta")
    )
    with pytest.raises(DrawbarError, match=r"its steps lack measurement\.hitch_angle, .*use the drawbar that wrote it"):
        StepLayout.of_schema(earlier).reader()


def test_numbers_that_only_a_later_schema_has_are_passed_over(plain: StepRecord) -> None:
    later = step_schema(20).replace(
        "float64 speed  # of the wheels, m/s", "float64 new\nfloat64 speed  # of the wheels, m/s"
    )
    assert later != step_schema(20)
    there = StepLayout.of_schema(later)
    data = bytearray(there.size)
    for name, cell in StepLayout.of(20).cells.items():
        size, at = layout.calcsize(cell.code) * max(1, cell.length), there.cells[name].offset
        data[at : at + size] = packed(plain)[cell.offset : cell.offset + size]
    assert differences(there.reader()(bytes(data)), plain) == ()


@pytest.mark.parametrize("stages", [1, 2, 15, 20, 50])
def test_the_size_tells_how_many_stages_there_are(stages: int) -> None:
    assert StepLayout.of_size(StepLayout.of(stages).size) is StepLayout.of(stages)


@pytest.mark.parametrize("size", [0, 4, StepLayout.of(1).size - 32, StepLayout.of(3).size + 8])
def test_bytes_of_another_size_are_no_step(size: int) -> None:
    with pytest.raises(ValueError, match=f"no step has {size} bytes"):
        unpacked(bytes(size))


def test_what_is_no_number_is_refused(plain: StepRecord) -> None:
    command = dataclasses.replace(plain.command, speed="fast")
    with pytest.raises(SignalError, match="a StepRecord of numbers and arrays is needed"):
        packed(dataclasses.replace(plain, command=command))
    tractor = dataclasses.replace(plain.plan.tractor, deviation=np.zeros(5))
    with pytest.raises(SignalError, match=r"plan\.tractor\.deviation holds 5 numbers instead of 4"):
        packed(dataclasses.replace(plain, plan=dataclasses.replace(plain.plan, tractor=tractor)))
