"""Python's signals and C's are the same ones: every member goes by its name through a compiled function and back."""

import ctypes
import dataclasses
import re
from collections.abc import Iterator
from enum import IntEnum
from typing import Any

import numpy as np
import pytest

from drawbar.codegen import Workspace, build
from drawbar.codegen.cache import runtime_sources
from drawbar.control.settings import Coupling
from drawbar.control.subsystem import coupling_settings
from drawbar.exchange import CBodyPlan, CBodyReference, CBodySteering, CCommand, CEstimate, CMeasurement
from drawbar.guidance.guidance import GuidanceStatus
from drawbar.safety.supervisor import Supervision
from drawbar.signals import (
    BodyPlan,
    BodyReference,
    BodySteering,
    Command,
    Estimate,
    FixStatus,
    GateVerdict,
    Measurement,
    Pose,
    SolverStatus,
)

MEASUREMENT = Measurement(
    time=1.5,
    tractor_x=2.5,
    tractor_y=3.5,
    trailer_x=4.5,
    trailer_y=5.5,
    hitch_angle=6.5,
    speed=7.5,
    tractor_steering=8.5,
    trailer_steering=9.5,
)
COMMAND = Command(time=1.5, tractor_steering=2.5, trailer_steering=3.5, speed=4.5)
ESTIMATE = Estimate(
    time=1.5,
    tractor=Pose(x=2.5, y=3.5, yaw=4.5),
    trailer=Pose(x=5.5, y=6.5, yaw=7.5),
    hitch_angle=8.5,
    speed=9.5,
    tractor_steering=10.5,
    trailer_steering=11.5,
    longitudinal_slip=12.5,
    tractor_slip=13.5,
    trailer_slip=14.5,
    steering_offset=15.5,
    tractor_crab=16.5,
    trailer_crab=17.5,
    status=SolverStatus.NOT_FINITE,
    tractor_fix=FixStatus.STALE,
    trailer_fix=FixStatus.REJECTED,
)
STEERING = BodySteering(nominal=1.5, ancillary=2.5, command=3.5, margin=4.5, saturated=True)
REFERENCE = BodyReference(
    progress=1.5, lateral_error=2.5, closest=np.arange(4.0) + 3.5, samples=np.arange(12.0).reshape(3, 4)
)
PLAN = BodyPlan(
    steering=1.5,
    poses=np.arange(9.0).reshape(3, 3),
    steerings=np.array([2.5, 3.5]),
    deviation=np.array([4.5, 5.5, 6.5]),
    status=SolverStatus.INFEASIBLE,
)
SIGNALS = {"measurement": MEASUREMENT, "command": COMMAND, "estimate": ESTIMATE, "body_steering": STEERING}
"""plain ones, by the names of their structures"""
ENUMS = {
    "DRAWBAR_FIX_": FixStatus,
    "GUIDANCE_": GuidanceStatus,
    "": (SolverStatus, GateVerdict, Supervision),
}
"""by what C puts before the names"""


def leaves(value: Any, place: str = "") -> Iterator[tuple[str, float]]:
    """Yield the C expression of each number of a signal, with the number."""
    for field in dataclasses.fields(value):
        inner = getattr(value, field.name)
        if dataclasses.is_dataclass(inner):
            yield from leaves(inner, f"{place}{field.name}.")
        else:
            yield f"{place}{field.name}", float(inner)


def members() -> Iterator[tuple[str, int]]:
    """Yield C's name of each member of each enumeration, with Python's number."""
    for prefix, kinds in ENUMS.items():
        for kind in kinds if isinstance(kinds, tuple) else (kinds,):
            assert issubclass(kind, IntEnum)
            yield from ((f"{prefix}{member.name}", member.value) for member in kind)
    for coupling in Coupling:
        yield coupling.name, coupling_settings(coupling)["coupling"]


def source() -> str:
    """Return a unit that fills each plain signal by name, and counts what in it differs from that."""
    functions = []
    for name, signal in SIGNALS.items():
        fills = " ".join(f"s->{place} = {value!r};" for place, value in leaves(signal))
        differs = " + ".join(f"(s->{place} != {value!r})" for place, value in leaves(signal))
        arguments = f"struct work *work, struct drawbar_{name} *s"
        functions.append(f"int fill_{name}({arguments}) {{ (void)work; {fills} return 0; }}")
        functions.append(f"int differs_{name}({arguments}) {{ (void)work; return {differs}; }}")
    numbers = ", ".join(name for name, _ in members())
    (coupling,) = re.findall(r"enum coupling .*;", runtime_sources()["subsystem.h"])  # the rest of it wants a solver
    return f"""
#include "fields.h"
#include "signals.h"
#include "status.h"
#include "verdicts.h"
#include "guidance_status.h"
{coupling}
struct work {{ int32_t numbers[{len(list(members()))}]; }};
int64_t drawbar_size = sizeof(struct work);
const struct drawbar_field drawbar_fields[] = {{
    FIELD(work, numbers, 1, {len(list(members()))}, 0, 0) END_OF_FIELDS
}};
int name(struct work *work)
{{
    const int32_t numbers[] = {{{numbers}}};
    for (unsigned i = 0; i < sizeof numbers / sizeof *numbers; ++i)
        work->numbers[i] = numbers[i];
    return 0;
}}
{chr(10).join(functions)}
int differs_reference(struct work *work, const struct drawbar_body_reference *r)
{{
    int differs = (r->progress != 1.5) + (r->lateral_error != 2.5);
    (void)work;
    for (int i = 0; i < 4; ++i)
        differs += r->closest[i] != i + 3.5;
    for (int i = 0; i < 12; ++i)
        differs += r->samples[i / 4][i % 4] != i;
    return differs;
}}
int differs_plan(struct work *work, const struct drawbar_body_plan *p)
{{
    int differs = (p->steering != 1.5) + (p->deviations != 3) + (p->status != INFEASIBLE);
    (void)work;
    for (int i = 0; i < 9; ++i)
        differs += p->poses[i / 3][i % 3] != i;
    for (int i = 0; i < 2; ++i)
        differs += p->steerings[i] != i + 2.5;
    for (int i = 0; i < 3; ++i)
        differs += p->deviation[i] != i + 4.5;
    return differs;
}}
"""


@pytest.fixture(scope="module")
def unit() -> Workspace:
    return Workspace(build("exchange", source()))


@pytest.mark.parametrize(
    ("structure", "name"), [(CEstimate, "estimate"), (CCommand, "command"), (CBodySteering, "body_steering")]
)
def test_what_c_fills_by_name_is_read_by_name(unit: Workspace, structure: Any, name: str) -> None:
    filled = structure()
    unit.function(f"fill_{name}", pointers=1)(ctypes.byref(filled))
    assert filled.read() == SIGNALS[name]


@pytest.mark.parametrize(
    ("structure", "name"), [(CEstimate, "estimate"), (CCommand, "command"), (CMeasurement, "measurement")]
)
def test_what_is_written_by_name_c_finds_by_name(unit: Workspace, structure: Any, name: str) -> None:
    written = structure()
    differs = unit.function(f"differs_{name}", pointers=1)
    assert differs(ctypes.byref(written)) == len(list(leaves(SIGNALS[name]))), "nothing is written yet"
    written.write(SIGNALS[name])
    assert differs(ctypes.byref(written)) == 0


def test_a_reference_arrives_with_its_samples(unit: Workspace) -> None:
    written = CBodyReference()
    written.write(REFERENCE, stages=3)
    assert unit.function("differs_reference", pointers=1)(ctypes.byref(written)) == 0


def test_a_plan_arrives_with_its_arrays_and_comes_back(unit: Workspace) -> None:
    written = CBodyPlan()
    written.write(PLAN)
    assert unit.function("differs_plan", pointers=1)(ctypes.byref(written)) == 0
    back = written.read(horizon=2)
    assert (back.steering, back.status) == (PLAN.steering, PLAN.status)
    for name in ("poses", "steerings", "deviation"):
        np.testing.assert_array_equal(getattr(back, name), getattr(PLAN, name))


def test_enumerations_have_the_same_numbers(unit: Workspace) -> None:
    unit.function("name")()
    names, numbers = zip(*members(), strict=True)
    found = dict(zip(names, unit.array("numbers").tolist(), strict=True))
    assert found == dict(zip(names, numbers, strict=True))
