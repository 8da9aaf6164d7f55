"""The closed loops that the measurements are taken from: shipped configurations on the simulated machine."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

from drawbar.benchmark.probe import Probe
from drawbar.config import Configuration, load_configuration
from drawbar.control.centralised import CentralisedController
from drawbar.control.decentralised import DecentralisedController
from drawbar.estimation.moving_horizon import MovingHorizonEstimator
from drawbar.machine.base import Machine
from drawbar.optimal import ControlSolver, EstimationSolver
from drawbar.signals import Command, Measurement, Truth
from drawbar.simulation import drive
from drawbar.step.autopilot import Autopilot
from drawbar.step.build import build_autopilot, build_machine, build_path

HORIZON = 3.0
"""Length of horizon and window, s: 15 samples of 0.2 s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WholeRun:
    """What a whole run costs outside the solvers too."""

    latency: list[float]
    """one control step, measurement in, command out, s"""
    preparation: list[float]
    """what a step does after its command is out, s"""
    real_time_factor: float
    """driven time over elapsed time, simulation included"""


class _TimedMachine(Machine):
    """Passes everything on and takes down when measurements go in and commands come out."""

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self.came = self.went = self.latency = 0.0

    def read(self) -> Measurement:
        measurement = self._machine.read()
        self.came = time.perf_counter()
        return measurement

    def write(self, command: Command) -> None:
        self.latency = time.perf_counter() - self.came
        self._machine.write(command)
        self.went = time.perf_counter()

    def truth(self) -> Truth | None:
        return self._machine.truth()


def probed_runs(name: str, horizons: Sequence[int], steps: int, *, with_other_route: bool) -> list[list[Probe]]:
    """Drive a shipped configuration at several horizons in lockstep; return the probes of the solvers of each.

    In lockstep the machine's moods fall on all horizons alike, and their ratios mean something.

    Args:
        name: of the configuration.
        horizons: samples in horizon and window; they span HORIZON seconds whatever their number, so that all have the
            same to do.
        steps: samples to measure, from when the longest window is full.
        with_other_route: at the first horizon also solve some of the problems by CasADi, condensing and DAQP.
    """
    autopilots = [_autopilot(_stretched(name, stages)) for stages in horizons]
    probes = [
        _probes(name, autopilot, with_other_route=with_other_route and not index)
        for index, autopilot in enumerate(autopilots)
    ]
    for _ in range(steps + max(horizons) + 1):  # the first ones only fill the window
        for autopilot in autopilots:
            autopilot.step()
    return probes


def _stretched(name: str, stages: int) -> Configuration:
    """Return a configuration with so many stages in HORIZON."""
    sample_time = HORIZON / stages
    lengths = [f"controller.horizon={stages}", f"estimator.window={stages}"]
    return load_configuration(name, [*lengths, f"sample_time={sample_time}", f"machine.step={sample_time / 20}"])


def _probes(name: str, autopilot: Autopilot, *, with_other_route: bool) -> list[Probe]:
    solvers = _solvers(name, autopilot)
    return [Probe(problem, solver, with_other_route=with_other_route) for problem, solver in solvers.items()]


def _solvers(name: str, autopilot: Autopilot) -> dict[str, ControlSolver | EstimationSolver]:
    """Return what a configuration has to measure, by the problem's name.

    Beside a centralised controller that is its solver alone: the estimator is the decentralised configuration's.
    """
    controller, estimator = autopilot.controller, autopilot.estimator
    if isinstance(controller, CentralisedController):
        return {name: controller.solver}
    if not isinstance(controller, DecentralisedController) or not isinstance(estimator, MovingHorizonEstimator):
        raise TypeError(f"{name} has no compiled controllers or no moving horizon estimator to measure.")
    return {
        f"{name}-tractor": controller.tractor.solver,
        f"{name}-trailer": controller.trailer.solver,
        f"{name}-estimator": estimator.solver,
    }


def whole_run(name: str) -> WholeRun:
    """Drive a shipped configuration from start to end of its path, unwatched but for the clock."""
    configuration = load_configuration(name)
    path, _ = build_path(configuration)
    machine = _TimedMachine(build_machine(configuration, path, 0))
    autopilot = build_autopilot(configuration, path, machine)
    latency, preparation = [], []
    start = time.perf_counter()
    for _ in drive(autopilot, time_limit=60.0 + 3.0 * path.length / configuration.speed):
        preparation.append(time.perf_counter() - machine.went)
        latency.append(machine.latency)
    factor = len(latency) * configuration.sample_time / (time.perf_counter() - start)
    return WholeRun(latency=latency, preparation=preparation, real_time_factor=factor)


def _autopilot(configuration: Configuration) -> Autopilot:
    path, _ = build_path(configuration)
    return build_autopilot(configuration, path, build_machine(configuration, path, 0))
