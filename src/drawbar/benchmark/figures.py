"""Figures of the benchmark, from measured times to what is shown and written."""

import os
import platform
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from drawbar.codegen.compiler import compiler_identity
from drawbar.geometry import Floats

if TYPE_CHECKING:
    from drawbar.benchmark.probe import Probe


def microseconds(times: Sequence[float] | Floats) -> dict[str, float]:
    """Return median, mean, 99th percentile and maximum, µs, of times (n,), s."""
    values = 1e6 * np.asarray(times)
    return {
        "median": float(np.median(values)),
        "mean": float(values.mean()),
        "p99": float(np.percentile(values, 99)),
        "max": float(values.max()),
    }


def row(probe: "Probe") -> dict[str, Any]:
    """Return the figures of a solver; steps before the estimator's window was full are left out."""
    full = slice(probe.stages + 1, len(probe.floor))
    prepare, feedback = np.asarray(probe.prepare)[full], np.asarray(probe.feedback)[full]
    bounded = np.asarray(probe.iterations)[full] > 0
    total, floor = microseconds(prepare + feedback), float(1e6 * np.median(probe.floor))
    phases = {"prepare": microseconds(prepare), "feedback": microseconds(feedback)}
    return {
        "problem": probe.name,
        "stages": probe.stages,
        "prepare_us": phases["prepare"]["median"],
        "feedback_us": phases["feedback"]["median"],
        "total_us": total,
        "phases_us": phases,
        "floor_us": floor,
        "ratio_to_floor": total["median"] / floor,
        "bounded_share": float(bounded.mean()),
        "feedback_free_us": _some(feedback[~bounded]),
        "feedback_active_us": _some(feedback[bounded]),
        "iterations_max": max(probe.iterations[full]),
    }


def race_rows(probe: "Probe") -> list[dict[str, Any]]:
    """Return the figures of drawbar's quadratic program and its peers, on the stage problems that all were given."""
    times = probe.race.times if probe.race else {}
    return [
        {
            "problem": probe.name,
            "stages": probe.stages,
            "solver": name,
            "free_us": _some(each.free),
            "active_us": _some(each.active),
            "problems": len(each.free) + len(each.active),
            "other_answers": each.others,
        }
        for name, each in times.items()
    ]


def _some(times: Sequence[float] | Floats) -> dict[str, float] | None:
    return microseconds(times) if len(times) else None


def machine() -> dict[str, str]:
    """Return what the figures were measured on."""
    return {
        "processor": processor(),
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


def processor() -> str:
    """Return what the system calls this computer's processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
        return next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
