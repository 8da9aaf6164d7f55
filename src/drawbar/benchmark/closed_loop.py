"""The closed loops that the measurements are taken from: shipped configurations on the simulated machine."""

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from drawbar.benchmark.probe import Probe
from drawbar.benchmark.step_in_c import StepTimes, step_times
from drawbar.config import Configuration, load_configuration
from drawbar.optimal import SolverUnit
from drawbar.recording.log import LOG_NAME
from drawbar.recording.recorder import Recorder
from drawbar.signals import Measurement
from drawbar.simulation import Simulation
from drawbar.step.autopilot import Autopilot

HORIZON = 3.0
"""Length of horizon and window, s: 15 samples of 0.2 s."""
_RUNS = 5
"""whole runs that a real-time factor is the median of"""


@dataclass(frozen=True, slots=True, kw_only=True)
class WholeRun:
    """What a whole run costs outside the solvers too."""

    latency: list[float]
    """one control step, measurement in, command out, from Python, s"""
    in_c: StepTimes
    """the same steps as a caller in C has them"""
    bounded: list[bool]
    """whether a solver had bounds active, of each step"""
    python: list[float]
    """the same step when the run has ended, and C has nothing to do: what is Python's, s"""
    real_time_factor: float
    """driven time over elapsed time, simulation included"""
    real_time_factor_logged: float
    """the same with a log, each step of which reaches the operating system"""


def probed_runs(
    name: str,
    horizons: Sequence[int],
    steps: int,
    *,
    with_peers: bool,
    changes: Sequence[str] = (),
    make: Callable[..., Probe] = Probe,
) -> list[list[Probe]]:
    """Drive a shipped configuration at several horizons in lockstep; return the probes of the solvers of each.

    In lockstep the machine's moods fall on all horizons alike, and their ratios mean something.

    Args:
        name: of the configuration.
        horizons: samples in horizon and window; they span HORIZON seconds whatever their number, so that all have the
            same to do.
        steps: samples to measure, from when the longest window is full.
        with_peers: also give some of the stage problems to HPIPM, DAQP and PIQP.
        changes: KEY=VALUE, to the configuration.
        make: a probe.
    """
    simulations = [Simulation(_stretched(name, stages, changes)) for stages in horizons]
    make = partial(make, with_peers=with_peers)
    probes = [_probes(name, simulation.autopilot, make) for simulation in simulations]
    with ExitStack() as stack:
        runs = [stack.enter_context(simulation).steps() for simulation in simulations]
        for _ in range(steps + max(horizons) + 1):  # the first ones only fill the window
            for run in runs:
                next(run)
    return probes


def _stretched(name: str, stages: int, changes: Sequence[str]) -> Configuration:
    """Return a configuration with so many stages in HORIZON."""
    sample_time = HORIZON / stages
    lengths = [f"controller.horizon={stages}", f"estimator.window={stages}"]
    times = [f"sample_time={sample_time}", f"machine.step={sample_time / 20}"]
    return load_configuration(name, [*lengths, *times, *changes])


def _probes(name: str, autopilot: Autopilot, make: Callable[..., Probe]) -> list[Probe]:
    """Watch what a configuration has to measure.

    Beside a centralised controller that is its solver alone: the estimator is the decentralised configuration's.
    """
    library, components = autopilot.library, autopilot.library.components
    if "controller" in components:
        return [make(name, library, components["controller"])]
    return [make(f"{name}-{body}", library, components[body]) for body in ("tractor", "trailer", "estimator")]


def whole_run(name: str) -> WholeRun:
    """Drive a shipped configuration from start to end of its path, unwatched but for the clock."""
    simulation = Simulation(load_configuration(name))
    autopilot, machine = simulation.autopilot, simulation.machine
    components = autopilot.library.components.values()
    rounds = [each.live.array("qp.iterations") for each in components if isinstance(each.unit, SolverUnit)]
    latency, bounded, measurements, clock = list[float](), list[bool](), list[Measurement](), time.perf_counter
    with simulation:
        while True:
            measurement = machine.read()
            came = clock()
            status, command = autopilot.feedback(measurement)
            latency.append(clock() - came)
            machine.write(command)
            bounded.append(any(each[0] > 0 for each in rounds))
            measurements.append(measurement)
            autopilot.prepare()
            if status.has_ended:
                break
        python = [_timed(lambda: autopilot.feedback(measurement)) for _ in range(1000)]
    return WholeRun(
        latency=latency,
        in_c=step_times(autopilot, simulation.path, measurements),
        bounded=bounded,
        python=python,
        real_time_factor=median(_real_time_factor(name, logged=False) for _ in range(_RUNS)),
        real_time_factor_logged=median(_real_time_factor(name, logged=True) for _ in range(_RUNS)),
    )


def _timed(call: Callable[[], object]) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def _real_time_factor(name: str, *, logged: bool) -> float:
    """Return driven time over elapsed time of a whole run with its records."""
    simulation = Simulation(load_configuration(name))
    with TemporaryDirectory() as folder, Recorder(Path(folder) / LOG_NAME, simulation.header()) as log, simulation:
        start = time.perf_counter()
        for record in simulation.steps():
            if logged:
                log.write(record)
        elapsed = time.perf_counter() - start
    return (record.step + 1) * simulation.configuration.sample_time / elapsed
