"""Manifest of a library, manifest.json: what it is and what it needs, for people and programs that build on it."""

import hashlib
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from drawbar import __version__
from drawbar.codegen import Component
from drawbar.codegen.cache import runtime_sources
from drawbar.config import Configuration
from drawbar.export.memory import Memory
from drawbar.export.stack import CallGraph
from drawbar.export.targets import Precision
from drawbar.export.toolchain import Built
from drawbar.optimal import SolverUnit

ENTRIES = tuple(
    f"drawbar_{name}"
    for name in (
        *(
            "init",
            "set_path",
            "begin_at",
            "change_path",
            "set_offset",
            "set_speed",
            "set_engaged",
            "feedback",
            "prepare",
            "step",
        ),
        *("actuate_init", "actuate", "line_path", "line_nearest", "line_reverse"),
    )
)
"""functions whose stack is stated"""
_BOUNDS = {
    "stages": "N",
    "states": "NX",
    "inputs": "NU",
    "bounded_variables": "NB",
    "interior_point_iterations": "IP_ITERATIONS",
    "warm_start_passes": "PN_WARM_PASSES",
    "projected_newton_passes": "PN_PASSES",
    "active_set_passes": "ACTIVE_PASSES",
    "active_set_columns": "ACTIVE_COLUMNS",
}
"""a solver's size and what limits its work, and their names in C, which a unit or else the runtime defines"""
_SWEEPS_OF_ITERATION = 2
"""of the interior point: predictor and corrector"""
_COLUMNS = "COLUMNS"
"""C's name of whether a solver has columns at all"""
_REJECTIONS = "CORRECTOR_REJECTIONS"
"""C's name of how many of its iterations have one more, a centring step in the place of a rejected corrector"""


def configuration_hash(configuration: Configuration) -> str:
    """Return the SHA-256 of the complete configuration as written out."""
    return _sha256(configuration.to_toml().encode())


def manifest(
    configuration: Configuration,
    precision: Precision,
    components: Sequence[Component],
    memory: Memory,
    builds: Sequence[Built],
) -> dict[str, Any]:
    """Return the manifest.

    Args:
        configuration: what was exported.
        precision: of its numbers.
        components: of its control step.
        memory: that these need.
        builds: what was built, one entry a target.
    """
    return {
        "drawbar": __version__,
        "configuration": {"name": configuration.name, "sha256": configuration_hash(configuration)},
        "precision": precision,
        "state_bytes": 8 * memory.state_doubles,
        "actuate_state_bytes": 8 * _defined("DRAWBAR_ACTUATE_DOUBLES", runtime_sources().values()),
        "components_bytes": {**memory.components, "work": memory.work},
        "bounds": {
            component.name: _bounds(component.unit)
            for component in components
            if isinstance(component.unit, SolverUnit)
        },
        "targets": {build.target.name: _target(build) for build in builds},
    }


def _target(build: Built) -> dict[str, Any]:
    sizes = sum((unit.sizes for unit in build.units), start=Counter[str]())
    return {
        "triple": build.target.triple,
        "compiler": build.compiler,
        "flags": " ".join(build.flags),
        "files": {
            file.name: {"bytes": file.stat().st_size, "sha256": _sha256(file.read_bytes())} for file in build.files
        },
        "sections_bytes": {kind: sizes[kind] for kind in (".text", ".rodata", ".data", ".bss")},
        **(_calls(build) if build.target.stack_known else {}),
    }


def _calls(build: Built) -> Mapping[str, Any]:
    graph = CallGraph(build.units)
    uses = {name: graph.worst(name) for name in ENTRIES}
    return {
        "stack_bytes": {name: use.size for name, use in uses.items()},
        "deepest_chain": list(uses["drawbar_step"].chain),
        "needs": graph.outside(),
    }


def _bounds(unit: SolverUnit) -> Mapping[str, int]:
    """Return a solver's bounds, and with them how often one feedback factorises and sweeps at most.

    A sweep for the bounds that were active before, by the factorisation of the preparation, and both for each further
    pass with them. One factorisation and one sweep without bounds. Then one of three: a sweep for projected
    Newton to begin with, both for each of its passes and to take it back; a sweep for each column of the
    active set, two to publish its answer and two to take both back; two factorisations and a sweep, to regularise a
    cost that leaves something undetermined. Then the interior point: a factorisation and a sweep for its start,
    and its iterations.
    """
    sources = [unit.source, *runtime_sources().values()]
    bounds = {name: _defined(macro, sources) for name, macro in _BOUNDS.items()}
    columns = _defined(_COLUMNS, sources) * bounds["active_set_columns"]
    bounds["active_set_columns"] = min(columns, bounds["bounded_variables"])
    iterations = bounds["interior_point_iterations"]
    newton = bounds["projected_newton_passes"] + 1
    warm = bounds["warm_start_passes"]
    sweeps = warm + 1 + max(1 + newton, bounds["active_set_columns"] + 4) + 1
    sweeps += _SWEEPS_OF_ITERATION * iterations + min(_defined(_REJECTIONS, sources), iterations)
    return bounds | {"factorisations": warm + max(newton, 2) + 1 + iterations, "sweeps": sweeps}


def _defined(macro: str, sources: Iterable[str]) -> int:
    """Return the number that the first of the sources to do so defines under this name."""
    for text in sources:
        if found := re.search(rf"^#define {macro} (\d+)", text, re.MULTILINE):
            return int(found[1])
    raise LookupError(macro)


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
