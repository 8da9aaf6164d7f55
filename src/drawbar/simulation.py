"""Simulation: drives a path from its start to its end, step by step. The loop of every run; whole simulated runs."""

import math
import time
from collections.abc import Callable, Iterator
from numbers import Integral, Real
from pathlib import Path as FilePath
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from drawbar.bounded import BoundedSequence, Draw
from drawbar.config import Configuration, demand_configuration
from drawbar.control.tube.adversary import worst_signs
from drawbar.errors import ConfigurationError, DrawbarError, HardwareError, PathError, demand
from drawbar.estimation.ideal import TrueState
from drawbar.estimation.settings import IdealEstimatorSettings
from drawbar.geometry import Floats
from drawbar.guidance.beginning import beginning
from drawbar.guidance.demands import demand_steering
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.importers.load import load_line
from drawbar.guidance.path import Path
from drawbar.machine.base import Machine, MachineWithTruth
from drawbar.machine.physics.settings import PhysicsMachineSettings
from drawbar.machine.sampled import SampledMachine
from drawbar.machine.simulated import SimulatedMachine
from drawbar.recording.header import run_header
from drawbar.recording.log import Outcome, RunHeader, RunLog
from drawbar.signals import Estimate, Measurement, Pose, Status, StepRecord
from drawbar.step.autopilot import Autopilot
from drawbar.step.build import build_autopilot, build_tubes
from drawbar.step.reasons import reason, refusal
from drawbar.termination import termination_as_exit

if TYPE_CHECKING:
    from drawbar.guidance.smoothing import DrivablePath


class RunAborted(DrawbarError):  # noqa: N818 -- an outcome, not a mistake
    """The run was given up before the end of the path; the log holds all steps up to then."""


def drive(
    machine: Machine,
    autopilot: Autopilot,
    *,
    time_limit: float,
    estimate: Callable[[float], Estimate] | None = None,
    between: Callable[[], None] | None = None,
) -> Iterator[StepRecord]:
    """Yield the record of every step until the tractor reaches the end of the path.

    The last call of the machine is to stop, whatever ends the loop, SIGTERM included (it raises SystemExit,
    unless the program handles it); close the iterator where it may be left early.

    Args:
        machine: to drive.
        autopilot: that has been given its path.
        time_limit: s after the first measurement, when the run is given up; the machine's clock may begin anywhere.
        estimate: gives an ideal estimator each sample's estimate; called with the last step's body lag, s.
        between: called between a step's two phases, after the command is out.

    Raises:
        RunAborted: the run ended before the path did.
        HardwareError: the machine reports no measurements, or its first one lacks a time or a position.
        PathError: the vehicle stands too far from where the run is to begin, or the autopilot has no path.
        EndOfMeasurements: the machine has no more of them.
        DrawbarError: machine or autopilot is none, or the time limit no positive number.
    """
    _demand_arguments(machine, autopilot, time_limit)
    begin, before, body_lag = math.nan, Status.OK, 0.0
    with termination_as_exit(), machine:
        while True:
            measurement = _measured(machine)
            if math.isnan(begin):
                begin = _first_time(measurement)
            if estimate is not None:
                autopilot.give(estimate(body_lag))
            status, command = autopilot.feedback(measurement)
            machine.write(command)
            if status is Status.FINISHED:
                return
            if between is not None:
                between()
            autopilot.prepare()
            if status in (Status.POSITION, Status.START, Status.NO_PATH):
                raise refusal(status, autopilot, measurement)
            record = autopilot.record(machine.truth() if isinstance(machine, MachineWithTruth) else None)
            yield record
            if status.has_ended:
                raise RunAborted(reason(status, before, record, autopilot))
            if measurement.time - begin > time_limit:
                raise RunAborted(
                    f"The path was not finished within {time_limit:.0f} s; raise speed or look at the log."
                )
            before, body_lag = status, record.actuation.body_lag


def _demand_arguments(machine: object, autopilot: object, time_limit: object) -> None:
    demand("machine", machine, Machine, "give a subclass of drawbar.Machine")
    demand("autopilot", autopilot, Autopilot, "give what build_autopilot() returned")
    if not (isinstance(time_limit, Real) and float(time_limit) > 0.0):
        raise DrawbarError(f"time_limit = {time_limit!r} is not allowed; give a positive number of seconds.")


def _measured(machine: Machine) -> Measurement:
    """Return the machine's next measurement, once it is seen to be one."""
    measurement: object = machine.read()
    if not isinstance(measurement, Measurement):
        raise HardwareError(
            f"{type(machine).__name__}.read() returned {repr(measurement)[:60]}; it must return a drawbar.Measurement."
        )
    return measurement


def _first_time(first: Measurement) -> float:
    """Return the time of the first measurement, s."""
    if not math.isfinite(first.time):
        raise HardwareError(
            f"The first measurement has time = {first.time}; give seconds of the machine's own clock, from any zero."
        )
    return first.time


def longest_time(length: float, speed: float) -> float:
    """Return the time (s) after which a run along a path of this length (m) at this set speed (m/s) is given up."""
    return 60.0 + 3.0 * length / speed


class Simulation:
    """A configuration's run on the simulated machine; as a context it leaves the machine stopped."""

    def __init__(self, configuration: Configuration, seed: int = 0, path: Path | None = None) -> None:
        """Build path, machine and autopilot.

        Args:
            configuration: of the run.
            seed: of everything random.
            path: in place of the configuration's.

        Raises:
            PathError: the line cannot be read or driven, or the machine stands too far from its start.
            ConfigurationError: the configuration contradicts itself, or the seed is none.
            CompilerError: the control step could not be compiled.
        """
        demand_configuration(configuration)
        if path is not None:
            demand("path", path, Path, "give one that build_path() made, or Path.through()", PathError)
        given: Any = seed
        if not (isinstance(given, Integral) and int(given) >= 0):
            raise ConfigurationError(f"seed = {seed!r} is not allowed; give a whole number of 0 or more.")
        self.configuration, self.seed = configuration, seed
        path, self.drivable = build_path(configuration) if path is None else (path, None)
        machine = build_machine(configuration, path, seed)
        self.machine: MachineWithTruth = machine
        self._slide = machine.slide
        reach, both_ways = configuration.guidance.maximum_start_distance, configuration.path.both_ways
        self.path, at = beginning(path, self.machine.truth().tractor, reach=reach, both_ways=both_ways)
        self.autopilot = build_autopilot(configuration)
        self.autopilot.begin(self.path, at=at)
        self._truth = TrueState(configuration.sample_time, _bounded_errors(configuration, "estimate", seed))

    def steps(self, between: Callable[[], None] | None = None) -> Iterator[StepRecord]:
        """Drive; see drive()."""
        ideal = isinstance(self.configuration.estimator, IdealEstimatorSettings)
        return drive(
            self.machine,
            self.autopilot,
            time_limit=longest_time(self.path.length, self.configuration.speed),
            estimate=self._true_state if ideal else None,
            between=between,
        )

    def _true_state(self, body_lag: float) -> Estimate:
        truth = self.machine.truth()
        return self._truth.estimate(truth, self._slide(truth.speed), body_lag)

    def log(self, between: Callable[[], None] | None = None) -> RunLog:
        """Drive to the end and return the log; see drive()."""
        header, records, times = self.header(), [], []
        stopped = None
        try:
            for record in self.steps(between):
                records.append(record)
                times.append(time.time())
        except RunAborted as error:
            stopped = error
        return RunLog(header=header, records=tuple(records), wall_time=np.array(times), outcome=Outcome.of(stopped))

    def header(self) -> RunHeader:
        """Describe the run, as starting now."""
        return run_header(self.configuration, self.path, self.drivable, self.seed)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.machine.stop()


def simulate(configuration: Configuration, seed: int = 0) -> RunLog:
    """Drive a whole run in simulation and return its log; the outcome of an aborted run gives the reason.

    Args:
        configuration: of the run.
        seed: of everything random.

    Raises:
        DrawbarError: the configuration cannot be built, or its run cannot begin.
    """
    with Simulation(configuration, seed) as simulation:
        return simulation.log()


def build_path(configuration: Configuration) -> "tuple[Path, DrivablePath | None]":
    """Return the path to drive and, for a recorded line, how it was made drivable.

    Raises:
        PathError: the line cannot be read or driven.
    """
    demand_configuration(configuration)
    line, drivable = _shaped_path(configuration)
    path = line.beside(configuration.path.offset)
    demand_steering(
        path, configuration.vehicle, speed=configuration.speed, tolerance=configuration.guidance.path_tolerance
    )
    return path, drivable


def _shaped_path(configuration: Configuration) -> "tuple[Path, DrivablePath | None]":
    settings, limit = configuration.path, configuration.vehicle.curvature_limit
    if not settings.file:
        for radius in settings.radii:
            if not 1.0 / radius <= limit:
                raise PathError(
                    f"path.radii holds {radius} m; the vehicle turns no tighter than {1.0 / limit:.2f} m, "
                    f"by vehicle.curvature_limit = {limit} 1/m"
                )
        return figure_eights(settings.radii, settings.straight_length), None
    line = load_line(FilePath(settings.file), settings.track or None, settings.extension)
    from drawbar.guidance.smoothing import make_drivable  # takes long to import, and only recorded lines need it

    drivable = make_drivable(line, configuration.guidance.line_limits(limit))
    return drivable.path, drivable


def build_machine(configuration: Configuration, path: Path, seed: int) -> SampledMachine:
    """Return the machine that the configuration asks for, standing at the configured start.

    Raises ConfigurationError when it cannot be built, or needs what is not installed.
    """
    x, y, yaw, _ = path.sample(np.zeros(1))[0].tolist()
    start, settings = configuration.start, configuration.machine
    faces, left = yaw + start.yaw, configuration.vehicle.tracked.tractor.left
    pose = Pose(
        x=x + start.ahead * math.cos(yaw) - start.left * math.sin(yaw) + left * math.sin(faces),
        y=y + start.ahead * math.sin(yaw) + start.left * math.cos(yaw) - left * math.cos(faces),
        yaw=faces,
    )
    vehicle, sample_time = configuration.vehicle, configuration.sample_time
    if isinstance(settings, PhysicsMachineSettings):
        from drawbar.machine.physics.machine import PhysicsMachine

        return PhysicsMachine(vehicle=vehicle, settings=settings, sample_time=sample_time, start=pose, seed=seed)
    return SimulatedMachine(
        vehicle=vehicle,
        settings=settings,
        sample_time=sample_time,
        start=pose,
        seed=seed,
        unknown=_bounded_errors(configuration, "ground", seed),
    )


def _bounded_errors(configuration: Configuration, kind: str, seed: int) -> Callable[[], Floats] | None:
    """Return what draws the errors of the ground or of the estimate, None where all their bounds are zero."""
    errors = configuration.bounded_errors
    bounds = errors.scale * np.array([bound for _, bound in getattr(errors, kind)])
    if not bounds.any():
        return None
    worst = np.ones((1, len(bounds)))
    if errors.draw is Draw.ADVERSARIAL:
        tubes = build_tubes(configuration)
        if tubes is None:
            raise ConfigurationError(
                f'bounded_errors.draw = "adversarial" needs tubes to attack, which controller.model = '
                f'"{configuration.controller.model}" does not have; use "random" or "vertices"'
            )
        worst = dict(zip(("ground", "estimate"), worst_signs(tubes), strict=True))[kind]
    return BoundedSequence(errors.draw, bounds, seed=seed, worst=worst).draw
