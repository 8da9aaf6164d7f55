"""Start-up: what a user waits for, in processes of their own with compiled libraries in the cache."""

import subprocess
import sys
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
_CLOCK = "\nimport time; print(time.time())"


def start_up() -> dict[str, float]:
    """Return medians of the time from a process' start to the import, and to a run's first step, s."""
    return {"import_s": _waited(_IMPORT), "first_step_s": _waited(_FIRST_STEP)}


def _waited(program: str) -> float:
    """Return how long a new process takes to reach the end of a program; the first one warms the caches."""
    return median([_once(program) for _ in range(_REPEATS + 1)][1:])


def _once(program: str) -> float:
    start = time.time()
    done = subprocess.run([sys.executable, "-c", program + _CLOCK], check=True, capture_output=True, text=True)
    return float(done.stdout.split()[-1]) - start
