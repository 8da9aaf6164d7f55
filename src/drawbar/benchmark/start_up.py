"""Start-up: what a user waits for, in processes of their own with compiled libraries in the cache."""

import os
import subprocess
import sys
import tempfile
import time
from statistics import median

_REPEATS = 7
_IMPORT = "import drawbar"
_FIRST_STEP = """
import drawbar.cli.main
from drawbar.config import load_configuration
from drawbar.simulation import Simulation
with Simulation(load_configuration("articulated")) as simulation:
    next(simulation.steps())
"""
_CLOCK = "\nimport os, time; print(time.time(), sum(os.times()[:4]))"


def start_up() -> dict[str, float]:
    """Return medians of the time from a process' start to the import, and to a run's first step, s.

    `cold_...` is of one process that has to compile the solvers first. `..._cpu_s` is the processor's time of the same,
    compilers included, which hangs less on what else the machine does.
    """
    imported, stepped, cold = _spent(_IMPORT), _spent(_FIRST_STEP), _cold(_FIRST_STEP)
    return {
        "cold_first_step_s": cold[0],
        "cold_first_step_cpu_s": cold[1],
        "import_s": imported[0],
        "import_cpu_s": imported[1],
        "first_step_s": stepped[0],
        "first_step_cpu_s": stepped[1],
    }


def _spent(program: str) -> tuple[float, float]:
    """Return how long a new process takes to the end of a program; the first one fills the caches.

    Byte code is kept, as it is where drawbar is installed, whatever the environment variables are.
    """
    with tempfile.TemporaryDirectory() as folder:
        kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        surroundings = {**kept, "PYTHONPYCACHEPREFIX": folder}
        runs = [_once(program, surroundings) for _ in range(_REPEATS + 1)][1:]
    return median(wall for wall, _ in runs), median(cpu for _, cpu in runs)


def _cold(program: str) -> tuple[float, float]:
    """Return how long a new process takes that finds nothing compiled."""
    with tempfile.TemporaryDirectory() as folder:
        return _once(program, {**os.environ, "DRAWBAR_CACHE": folder})


def _once(program: str, surroundings: dict[str, str]) -> tuple[float, float]:
    start = time.time()
    done = subprocess.run(
        [sys.executable, "-c", program + _CLOCK], env=surroundings, check=True, capture_output=True, text=True
    )
    end, cpu = map(float, done.stdout.split()[-2:])
    return end - start, cpu
