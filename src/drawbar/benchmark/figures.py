"""From measured times to the figures that are shown and written."""

import os
import platform
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from drawbar.benchmark.probe import Probe
from drawbar.codegen.compiler import compiler_identity


def microseconds(times: Sequence[float]) -> dict[str, float]:
    """Return median, 99th percentile and maximum of times given in s, in µs."""
    values = 1e6 * np.asarray(times)
    return {
        "median": float(np.median(values)),
        "p99": float(np.percentile(values, 99)),
        "max": float(values.max()),
    }


def rows(probe: Probe) -> list[dict[str, Any]]:
    """Return one row per route; steps before the estimator's window was full are left out."""
    full = slice(probe.stages + 1, len(probe.floor))
    own = _row(probe, "drawbar", np.asarray(probe.prepare)[full], np.asarray(probe.feedback)[full])
    bounded = np.asarray(probe.iterations)[full] > 0
    total = np.asarray(probe.prepare)[full] + np.asarray(probe.feedback)[full]
    own["ratio_to_floor"] = own["total_us"]["median"] / own["floor_us"]
    own["bounded_share"] = float(bounded.mean())
    own["bounds_inactive_us"] = microseconds(total[~bounded]) if not bounded.all() else None
    own["bounds_active_us"] = microseconds(total[bounded]) if bounded.any() else None
    own["iterations_max"] = max(probe.iterations[full])
    if not probe.other_feedback:
        return [own]
    count = len(probe.other_feedback)
    other = _row(probe, "casadi-daqp", np.asarray(probe.other_prepare[:count]), np.asarray(probe.other_feedback))
    return [own, other]


def machine() -> dict[str, str]:
    """Return what the figures were measured on."""
    return {
        "processor": _processor(),
        "system": platform.platform(),
        "compiler": compiler_identity(),
        "python": platform.python_version(),
        **{name: version(name) for name in ("drawbar", "casadi", "numpy")},
    }


def one_core() -> None:
    """Stay on one core for the rest of the process, where the system lets a process choose."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


@contextmanager
def on_one_core() -> Iterator[None]:
    """Stay on one core for a while, this thread alone, where the system lets it choose."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    allowed = os.sched_getaffinity(0)
    one_core()
    try:
        yield
    finally:
        os.sched_setaffinity(0, allowed)


def _row(probe: Probe, route: str, prepare: Any, feedback: Any) -> dict[str, Any]:
    return {
        "problem": probe.name,
        "stages": probe.stages,
        "route": route,
        "prepare_us": float(1e6 * np.median(prepare)),
        "feedback_us": float(1e6 * np.median(feedback)),
        "total_us": microseconds(prepare + feedback),
        "phases_us": {"prepare": microseconds(prepare), "feedback": microseconds(feedback)},
        "floor_us": float(1e6 * np.median(probe.floor)),
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
        return next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
