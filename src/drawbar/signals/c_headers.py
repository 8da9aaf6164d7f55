"""C headers of the signals: structures, enumerations and texts, printed from the declarations.

`python -m drawbar.signals.c_headers` prints them again after a change of `signals/` or `statuses.py`; a test holds them
against each other.
"""

import math
from dataclasses import fields, is_dataclass
from enum import IntEnum, IntFlag
from importlib import resources
from pathlib import Path
from textwrap import wrap
from typing import Any

from drawbar.declared_words import declared_words
from drawbar.signals import (
    Actuation,
    Array,
    BodyActuation,
    BodyDiagnostics,
    BodyPlan,
    BodyReference,
    BodySteering,
    Command,
    Diagnostics,
    Estimate,
    FixQuality,
    FixStatus,
    Flag,
    GateVerdict,
    GuidanceStatus,
    Measurement,
    MonitorVerdict,
    PathNode,
    Pose,
    Quantity,
    SolverStatus,
    Status,
    Truth,
)
from drawbar.signals.layout import base_of, is_small, members_of, note_of

_ENUMERATIONS: dict[type[IntEnum] | type[IntFlag], tuple[str, str]] = {
    Status: ("drawbar_status", "DRAWBAR_"),
    Flag: ("drawbar_flag", "DRAWBAR_"),
    FixStatus: ("drawbar_fix", "DRAWBAR_FIX_"),
    FixQuality: ("drawbar_quality", "DRAWBAR_QUALITY_"),
    SolverStatus: ("drawbar_solver", "DRAWBAR_SOLVER_"),
    GateVerdict: ("drawbar_gate", "DRAWBAR_GATE_"),
    GuidanceStatus: ("drawbar_guidance", "DRAWBAR_GUIDANCE_"),
    MonitorVerdict: ("monitor_verdict", ""),
}
"""C's name of each enumeration, and what its members' names begin with"""
_STRUCTURES: dict[Any, str] = {
    Measurement: "drawbar_measurement",
    Pose: "drawbar_pose",
    PathNode: "drawbar_path_node",
    Estimate: "drawbar_estimate",
    Command: "drawbar_command",
    BodyDiagnostics: "drawbar_body_diagnostics",
    Diagnostics: "drawbar_diagnostics",
    BodyActuation: "drawbar_body_actuation",
    Actuation: "drawbar_actuation",
    BodyReference: "drawbar_body_reference",
    BodyPlan: "drawbar_body_plan",
    BodySteering: "drawbar_body_steering",
    Truth: "drawbar_truth",
}
_PUBLIC_ENUMERATIONS = (Status, Flag, FixStatus, FixQuality, SolverStatus, GateVerdict, GuidanceStatus)
_PUBLIC_STRUCTURES = (
    *(PathNode, Measurement, Pose, Estimate, Command),
    *(BodyDiagnostics, Diagnostics, BodyActuation, Actuation),
)
_WIDTH = 39
"""columns of a member before its comment"""


def _member(text: str, words: str) -> str:
    """Return one line of a structure or an enumeration, and what of its comment does not fit on it."""
    if not words:
        return f"    {text}"
    lead, line, lines = f"    {text}".ljust(_WIDTH) + " /* ", "", []
    for word in words.split():
        if line and _WIDTH + 4 + len(line) + len(word) > 114:
            lines.append(line.rstrip())
            line = ""
        line += word + " "
    lines.append(line.rstrip())
    return lead + ("\n" + " " * _WIDTH + "  * ").join(lines) + " */"


def _enumeration(kind: type[IntEnum] | type[IntFlag], name: str, prefix: str) -> str:
    """Return an enumeration under a name; C++98 has no comma behind the last member."""
    words, members, lines = declared_words(kind), list(kind), []
    for member in members:
        comment = getattr(member, "text", "") or words.get(str(member.name), "")
        comma = "," if member is not members[-1] else ""
        lines.append(_member(f"{prefix}{member.name} = {member.value}{comma}", comment))
    return f"/* {kind.__doc__} */\nenum {name} {{\n" + "\n".join(lines) + "\n};\n"


def _structure(kind: Any) -> str:
    members = members_of(kind)
    arrays = [array for _, hint, _ in members if (array := note_of(hint, Array))]
    counts = [f"    int32_t {array.rows};" for array in arrays if array.counted]
    lines = [_c_member(*member) for member in members] + counts
    if (len(counts) + sum(is_small(hint) for _, hint, _ in members)) % 2:
        lines.append("    int32_t reserved;")
    words = "\n * ".join(wrap(" ".join(kind.__doc__.split()), 114))
    return f"/* {words} */\nstruct {_STRUCTURES[kind]} {{\n" + "\n".join(lines) + "\n};\n"


def _c_member(name: str, hint: Any, words: str) -> str:
    """Return the declaration of one field."""
    base, array, quantity = base_of(hint), note_of(hint, Array), note_of(hint, Quantity)
    if array:
        return _c_array(name, array, words)
    if is_dataclass(base):
        return _member(f"struct {_STRUCTURES[base]} {name};", words)
    if quantity or base is float:
        unit = "" if not quantity or quantity.unit == "1" else quantity.unit
        return _member(f"double {name};", ", ".join(filter(None, (words, unit))))
    known = f"enum {_ENUMERATIONS[base][0]}" if base in _ENUMERATIONS else ""
    return _member(f"int32_t {name};", ", ".join(filter(None, (words, known))))


def _c_array(name: str, array: Array, words: str) -> str:
    if not array.rows:
        return _member(f"double {name}[{array.columns}];", words)
    pointer = f"const double (*{name})[{array.columns}];" if array.columns else f"const double *{name};"
    return _member(pointer, f"({array.rows}) {words}")


def _texts() -> str:
    """Return the function that returns the meaning of a status."""
    flags = [(f"DRAWBAR_{flag.name}", f"a new command; {flag.text}") for flag in Flag]
    statuses = [(f"DRAWBAR_{status.name}", status.text) for status in Status]
    cases = "".join(f'    case {name}:\n        return "{text}";\n' for name, text in (*statuses, *flags))
    return f"""\
const char *drawbar_status_text(int status)
{{
    if (status > DRAWBAR_OK && status < DRAWBAR_REFUSED && (status & (status - 1)) != 0)
        return "a new command; several flags are set";
    switch (status) {{
{cases}    default:
        return "no status of this library";
    }}
}}
"""


def _limits() -> str:
    """Return the largest magnitude of each measured double but the time, in the structure's order."""
    limits = []
    for name, hint, _ in members_of(Measurement):
        if name != "time" and (quantity := note_of(hint, Quantity)):
            text = repr(quantity.limit) if math.isfinite(quantity.limit) else "DBL_MAX"
            limits.append(f"    {text},".ljust(32) + f"/* {name} */")
    return "static const double measurement_limits[] = {\n" + "\n".join(limits) + "\n};\n"


def _nothing() -> str:
    """Return the macro of a measurement in which every value has its default, and is missing where it has none."""
    defaults = {field.name: field.default for field in fields(Measurement)}
    values = []
    for name, hint, _ in members_of(Measurement):
        default = defaults[name]
        if is_small(hint):
            values.append(_ENUMERATIONS[base_of(hint)][1] + default.name)
        else:
            values.append(repr(default) if isinstance(default, float) and math.isfinite(default) else "(double)NAN")
    lines = wrap(", ".join(values), 100)
    return "#define DRAWBAR_NOTHING_MEASURED {" + "".join(f" \\\n    {line}" for line in lines) + "}\n"


_NOTE = """\
 *
 * Generated from signals/ and statuses.py by `python -m drawbar.signals.c_headers`; change them there. */"""
_PUBLIC = f"""\
/* Signals that enter and leave one control step. SI units, radians, x east, y north, yaw counter-clockwise from
 * east and continuous, steering left positive. A missing value is NaN; so is what a machine has no sensor for.
{_NOTE}
#ifndef DRAWBAR_SIGNALS_H
#define DRAWBAR_SIGNALS_H

#include <math.h>
#include <stdint.h>

"""
_NOTHING = """\
/* A measurement of nothing. Let every measurement begin as this, then write into it what the sensors report. Zeros are
 * something else: they report rates of zero, and fixes with a deviation of zero, which count as missing. */
"""
_INNER = f"""\
/* Signals between the components of one control step. Arrays behind pointers are their maker's own and valid until
 * its next call.
{_NOTE}
#ifndef DRAWBAR_INNER_SIGNALS_H
#define DRAWBAR_INNER_SIGNALS_H

#include <float.h>
#include <math.h>
#include "drawbar_signals.h"

"""
_TEXTS = f"""\
/* Status texts: one line for each status.
{_NOTE}
#ifndef DRAWBAR_STATUS_TEXT_H
#define DRAWBAR_STATUS_TEXT_H

#include "drawbar.h"

/* What a status means, in one line. No table: its pointers would be data that a shared library relocates. */
"""
_SOLVER = f"""\
/* Status of a solver's call.
{_NOTE}
#ifndef DRAWBAR_STATUS_H
#define DRAWBAR_STATUS_H

"""


def headers() -> dict[str, str]:
    """Return the text of each generated header by its place in the package."""
    public = [_enumeration(kind, *_ENUMERATIONS[kind]) for kind in _PUBLIC_ENUMERATIONS]
    for kind in _PUBLIC_STRUCTURES:
        public += [_structure(kind), *([_NOTHING + _nothing()] if kind is Measurement else [])]
    inner = [_enumeration(MonitorVerdict, *_ENUMERATIONS[MonitorVerdict])]
    inner += [_structure(kind) for kind in (BodyReference, BodyPlan, BodySteering, Truth)]
    inner += [
        "/* Largest magnitudes that sensors can mean, of the measurement's numbers but the time, in order. */\n"
        + _limits(),
    ]
    end = "\n#endif\n"
    return {
        "step/public/drawbar_signals.h": _PUBLIC + "\n".join(public) + end,
        "step/status_text.h": _TEXTS + _texts() + end,
        "signals/signals.h": _INNER + "\n".join(inner) + end,
        "solver/status.h": _SOLVER + _enumeration(SolverStatus, "qp_status", "") + end,
    }


def main() -> None:
    """Write the generated headers into the package."""
    with resources.as_file(resources.files("drawbar")) as root:
        for name, text in headers().items():
            Path(root / name).write_text(text, "utf-8", newline="\n")


if __name__ == "__main__":
    main()
