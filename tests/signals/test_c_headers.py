"""The signals in C are those of signals/: every member goes by its name through a compiled function and back."""

import ctypes
import dataclasses
import math
import re
from collections.abc import Iterator
from enum import IntEnum
from importlib import resources
from itertools import count
from typing import Any, get_type_hints

import pytest
from ordinary import measured

from drawbar.codegen import Workspace, build
from drawbar.codegen.cache import runtime_sources
from drawbar.control.settings import Coupling
from drawbar.control.subsystem import coupling_settings
from drawbar.errors import SignalError
from drawbar.signals import (
    BodySteering,
    Command,
    Diagnostics,
    Estimate,
    FixQuality,
    Flag,
    Measurement,
    SolverStatus,
    Status,
)
from drawbar.signals.c_headers import headers
from drawbar.signals.layout import Layout

SIGNALS = {
    "measurement": Measurement,
    "command": Command,
    "estimate": Estimate,
    "body_steering": BodySteering,
    "diagnostics": Diagnostics,
}
"""plain ones, by the names of their structures"""


def example(kind: Any, numbers: Iterator[int]) -> Any:
    """Return a signal whose numbers are all different."""
    values = {}
    for name, hint in get_type_hints(kind).items():
        number = next(numbers)
        if dataclasses.is_dataclass(hint):
            values[name] = example(hint, numbers)
        elif hint in (float, bool, int):
            values[name] = hint(number)
        else:
            values[name] = list(hint)[-1]
    return kind(**values)


EXAMPLES = {name: example(kind, count(1)) for name, kind in SIGNALS.items()}


def leaves(value: Any, place: str = "") -> Iterator[tuple[str, float]]:
    """Yield the C expression of each number of a signal, with the number."""
    for field in dataclasses.fields(value):
        inner = getattr(value, field.name)
        if dataclasses.is_dataclass(inner):
            yield from leaves(inner, f"{place}{field.name}.")
        else:
            yield f"{place}{field.name}", int(inner) if isinstance(inner, int) else float(inner)


def source() -> str:
    """Return a unit that fills each plain signal by name, and counts what in it differs from that."""
    functions = []
    for name, signal in EXAMPLES.items():
        fills = " ".join(f"s->{place} = {value!r};" for place, value in leaves(signal))
        differs = " + ".join(f"(s->{place} != {value!r})" for place, value in leaves(signal))
        arguments = f"struct work *work, struct drawbar_{name} *s"
        functions.append(f"int fill_{name}({arguments}) {{ (void)work; {fills} return 0; }}")
        functions.append(f"int differs_{name}({arguments}) {{ (void)work; return {differs}; }}")
        functions.append(f"int size_{name}(struct work *work) {{ (void)work; return sizeof(struct drawbar_{name}); }}")
    (coupling,) = re.findall(r"enum coupling .*;", runtime_sources()["subsystem.h"])  # the rest of it wants a solver
    couplings = ", ".join(member.name for member in Coupling)
    return f"""
#include "fields.h"
#include "signals.h"
{coupling}
struct work {{ int32_t couplings[{len(Coupling)}]; }};
int64_t drawbar_size = sizeof(struct work);
const struct drawbar_field drawbar_fields[] = {{ FIELD(work, couplings, 1, {len(Coupling)}, 0, 0) END_OF_FIELDS }};
int name(struct work *work)
{{
    const int32_t couplings[] = {{{couplings}}};
    for (int i = 0; i < {len(Coupling)}; ++i)
        work->couplings[i] = couplings[i];
    return 0;
}}
int nothing(struct work *work, struct drawbar_measurement *s)
{{
    (void)work;
    *s = (struct drawbar_measurement)DRAWBAR_NOTHING_MEASURED;
    return 0;
}}
{chr(10).join(functions)}
"""


@pytest.fixture(scope="module")
def unit() -> Workspace:
    return Workspace(build("exchange", source()))


def test_the_generated_headers_are_those_of_today() -> None:
    with resources.as_file(resources.files("drawbar")) as root:
        for name, text in headers().items():
            assert (root / name).read_text("utf-8") == text, f"{name} is stale: python -m drawbar.signals.c_headers"


@pytest.mark.parametrize("name", SIGNALS)
def test_what_c_fills_by_name_is_read_by_name(unit: Workspace, name: str) -> None:
    layout = Layout(SIGNALS[name])
    filled = layout.buffer()
    unit.function(f"fill_{name}", pointers=1)(ctypes.byref(filled))
    assert layout.unpack(filled) == EXAMPLES[name]


@pytest.mark.parametrize("name", SIGNALS)
def test_what_is_written_by_name_c_finds_by_name(unit: Workspace, name: str) -> None:
    layout = Layout(SIGNALS[name])
    written = layout.buffer()
    differs = unit.function(f"differs_{name}", pointers=1)
    assert differs(ctypes.byref(written)) == len(list(leaves(EXAMPLES[name]))), "nothing is written yet"
    layout.pack(written, EXAMPLES[name])
    assert differs(ctypes.byref(written)) == 0
    assert unit.function(f"size_{name}")() == layout.size


def test_a_measurement_of_nothing_has_every_default_and_is_missing_where_there_is_none(unit: Workspace) -> None:
    layout = Layout(Measurement)
    filled = layout.buffer()
    unit.function("nothing", pointers=1)(ctypes.byref(filled))
    found = layout.unpack(filled)
    for field in dataclasses.fields(Measurement):
        expected = math.nan if field.default is dataclasses.MISSING else field.default
        assert getattr(found, field.name) == pytest.approx(expected, abs=0.0, nan_ok=True), field.name


def test_couplings_have_the_same_numbers(unit: Workspace) -> None:
    unit.function("name")()
    assert unit.array("couplings").tolist() == [coupling_settings(coupling)["coupling"] for coupling in Coupling]


def test_a_status_that_is_a_set_of_flags_stays_below_the_others() -> None:
    assert max(Flag) * 2 <= Status.REFUSED
    assert all(flag.bit_count() == 1 for flag in Flag)
    for kind in (Status, Flag):
        texts = [member.text for member in kind]
        assert all(texts)
        assert len(set(texts)) == len(texts)


@pytest.mark.parametrize("kind", [SolverStatus, FixQuality])
def test_nothing_is_the_first_member_of_what_a_zeroed_structure_holds(kind: type[IntEnum]) -> None:
    assert kind(0) in (SolverStatus.SOLVED, FixQuality.UNKNOWN)


def test_a_value_that_is_no_number_is_refused_by_name():
    measurement = measured()
    layout = Layout(Measurement)
    for wrong in ({"hitch_angle": None}, {"speed": "1.0"}, {"tractor_fix_quality": 1.0}):
        ((name, value),) = wrong.items()
        with pytest.raises(SignalError, match=re.escape(f"Measurement: {name} = {value!r}: a number is needed")):
            layout.pack(layout.buffer(), dataclasses.replace(measurement, **wrong))
    with pytest.raises(SignalError, match=r"Measurement: .*format requires"):
        layout.pack(layout.buffer(), dataclasses.replace(measurement, tractor_fix_quality=2**40))
