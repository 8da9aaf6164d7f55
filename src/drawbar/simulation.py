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
from drawbar.estimation.ideal import ideal_estimate
from drawbar.estimation.settings import IdealEstimatorSettings
from drawbar.geometry import Floats, wrap
from drawbar.guidance.beginning import beginning, demand_near
from drawbar.guidance.demands import demand_steering, demand_trackable
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.importers.load import load_line
from drawbar.guidance.path import Path
from drawbar.machine.base import Machine, MachineWithTruth
from drawbar.machine.physics.settings import PhysicsMachineSettings
from drawbar.machine.simulated import SimulatedMachine
from drawbar.recording.header import run_header
from drawbar.recording.log import Outcome, RunHeader, RunLog
from drawbar.safety.gate import PATIENCE
from drawbar.signals import Estimate, Measurement, Pose, Status, StepRecord
from drawbar.step.autopilot import Autopilot
from drawbar.step.build import ENDURANCE, build_autopilot, build_tubes
from drawbar.termination import heeded_termination

if TYPE_CHECKING:
    from drawbar.guidance.smoothing import DrivablePath


_SWAPPED = math.radians(120.0)
"""facing so far away from the path, a vehicle that drove along it may have its antennas swapped, rad"""
_STUCK = 2
"""a doubt of lean_watch.h: the roll stands still"""


class RunAborted(DrawbarError):  # noqa: N818 -- an outcome, not a mistake
    """The run was given up before the end of the path; the log holds all steps up to then."""


def drive(
    machine: Machine,
    autopilot: Autopilot,
    *,
    time_limit: float,
    estimate: Callable[[], Estimate] | None = None,
    between: Callable[[], None] | None = None,
) -> Iterator[StepRecord]:
    """Yield the record of every step until the tractor reaches the end of the path.

    The last thing that the machine is told is to stop, whatever ends the loop, SIGTERM included (it raises SystemExit,
    unless the program handles it); close the iterator where it may be left early.

    Args:
        machine: to drive.
        autopilot: that has been given its path.
        time_limit: s after the first measurement, when the run is given up; the machine's clock may begin anywhere.
        estimate: in place of the estimator, where that is ideal.
        between: called between a step's two phases, after the command is out.

    Raises:
        RunAborted: the run ended before the path did.
        HardwareError: the machine reports no measurements, or its first one lacks a time or a position.
        PathError: the vehicle stands too far from where the run is to begin, or the autopilot has no path.
        EndOfMeasurements: the machine has no more of them.
        DrawbarError: machine or autopilot is none, or the time limit no positive number.
    """
    demand("machine", machine, Machine, "give a subclass of drawbar.Machine")
    demand("autopilot", autopilot, Autopilot, "give what build_autopilot() returned")
    if not (isinstance(time_limit, Real) and time_limit > 0.0):
        raise DrawbarError(f"time_limit = {time_limit!r} is not allowed; give a positive number of seconds.")
    begin, before = math.nan, Status.OK
    with heeded_termination(), machine:
        while True:
            measurement = _measured(machine)
            if math.isnan(begin):
                begin = _first_time(measurement)
            if estimate is not None:
                autopilot.give(estimate())
            status, command = autopilot.feedback(measurement)
            machine.write(command)
            if status is Status.FINISHED:
                return
            if between is not None:
                between()
            autopilot.prepare()
            if status in (Status.POSITION, Status.START, Status.NO_PATH):
                raise _refusal(status, autopilot, measurement)
            record = autopilot.record(machine.truth() if isinstance(machine, MachineWithTruth) else None)
            yield record
            if status.has_ended:
                raise RunAborted(_reason(status, before, record, autopilot))
            if measurement.time - begin > time_limit:
                raise RunAborted(
                    f"The path was not finished within {time_limit:.0f} s; raise speed or look at the log."
                )
            before = status


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
        self.machine = build_machine(configuration, path, seed)
        reach, both_ways = configuration.guidance.maximum_start_distance, configuration.path.working_width > 0.0
        self.path, at = beginning(path, self.machine.truth().tractor, reach=reach, both_ways=both_ways)
        self.autopilot = build_autopilot(configuration)
        self.autopilot.begin(self.path, at=at)
        self._wrong = _bounded_errors(configuration, "estimate", seed)

    def steps(self, between: Callable[[], None] | None = None) -> Iterator[StepRecord]:
        """Drive; see drive()."""
        ideal = isinstance(self.configuration.estimator, IdealEstimatorSettings)
        return drive(
            self.machine,
            self.autopilot,
            time_limit=longest_time(self.path.length, self.configuration.speed),
            estimate=(lambda: ideal_estimate(self.machine.truth(), self._wrong)) if ideal else None,
            between=between,
        )

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
    """Drive a whole run in simulation and return its log; a run that was given up says so in its outcome.

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
    demand_trackable(path, configuration.vehicle)
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

    drivable = make_drivable(
        line,
        curvature_limit=limit,
        curvature_rate_limit=configuration.guidance.curvature_rate_limit,
        tolerance=configuration.guidance.path_tolerance,
    )
    return drivable.path, drivable


def build_machine(configuration: Configuration, path: Path, seed: int) -> MachineWithTruth:
    """Return the machine that the configuration asks for, standing where its start says.

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


def _refusal(status: Status, autopilot: Autopilot, first: Measurement) -> DrawbarError:
    """Return the error that says why a run cannot begin."""
    if status is Status.NO_PATH:
        return PathError("the autopilot has no path; call autopilot.begin(path) before it drives")
    if not np.isfinite([first.tractor_x, first.tractor_y, first.trailer_x, first.trailer_y]).all():
        return HardwareError(
            f"The first measurement lacks a position (tractor {first.tractor_x}, {first.tractor_y}; "
            f"trailer {first.trailer_x}, {first.trailer_y}); wait for a fix of both antennas to start."
        )
    try:
        reach = _live(autopilot, "guidance", "guidance.start_distance")
        demand_near(autopilot.path, autopilot.start, first.tractor_x, first.tractor_y, reach)
    except PathError as error:
        return error
    return PathError(Status.START.text)


def _reason(status: Status, before: Status, record: StepRecord, autopilot: Autopilot) -> str:
    """Say why a run has ended; `before`: the status of the step before its last."""
    at = f"At {record.measurement.time:.1f} s"
    if status is Status.OFF_COURSE:
        away, limit = abs(record.reference.tractor.lateral_error), _live(autopilot, "supervisor", "lost")
        return f"{at} the tractor was {away:.2f} m from the path (limit {limit:g} m)."
    if status is Status.BLIND:
        return f"{at} {_without_fixes(autopilot)}"
    if status is Status.STEERING:
        return f"{at} {_not_followed(record, autopilot)}"
    if status is Status.HITCH:
        return f"{at} {_contradicted(record, autopilot)}"
    if status is Status.ROLL:
        return f"{at} {_leans_otherwise(record, autopilot)}"
    if status is Status.STOPPED and before is Status.TIME:
        return f"{at} the machine's time stamps had not increased, or were not finite, for {PATIENCE} s."
    if status is Status.STOPPED:
        return f"{at} the gate had had no valid command to let pass for {PATIENCE} s."
    if status is Status.UNSOLVED:
        return f"{at} estimator and controllers had not all had a solution for {ENDURANCE:.0f} s."
    if status is Status.GUIDANCE:
        return f"{at} {_lost(record.estimate, autopilot)}"
    return f"{at} the run was {status.text}."


def _without_fixes(autopilot: Autopilot) -> str:
    """Say how far the vehicle has gone without a fix, and how far and for how long it may."""
    way, longest, most = (_live(autopilot, "supervisor", name) for name in ("way", "blind", "blind_deviation"))
    return (
        f"neither antenna had had a valid fix for {way:.1f} m; "
        f"the limits are {longest:g} s, and a standard deviation across the line of {most:g} m."
    )


def _live(autopilot: Autopilot, component: str, name: str, place: int = 0) -> float:
    """Return a number of a component."""
    return float(autopilot.library.components[component].live.array(name)[place])


def _not_followed(record: StepRecord, autopilot: Autopilot) -> str:
    """Say which steering does not follow its commands."""
    sensed, angles = record.measurement, []
    for place, body, name in ((0, "tractor", "the front wheels"), (1, "trailer", "the trailer's joint")):
        stuck = _live(autopilot, "actuation", "stuck_for", place) > 0.0
        if stuck or _live(autopilot, "actuation", "odd_for", place) > 0.0:
            measured, asked = (math.degrees(getattr(each, f"{body}_steering")) for each in (sensed, record.command))
            shows = f"the sensor of {name} shows {'the very same ' if stuck else ''}{measured:.1f}°"
            angles.append(f"{shows}, {asked:.1f}° were commanded")
    return (
        f"{'; '.join(angles)}: it is stuck or has the wrong sign, the actuator does not follow its commands, or "
        f"somebody steers; look at `drawbar check --wiggle`."
    )


def _contradicted(record: StepRecord, autopilot: Autopilot) -> str:
    """Say which of the trailer's angles contradicts the motion: the one that is farther from its estimate."""
    names = {"hitch_angle": "hitch angle", "trailer_steering": "trailer's joint"}
    pairs = {name: [math.degrees(getattr(of, name)) for of in (record.measurement, record.estimate)] for name in names}
    stuck = _live(autopilot, "sanity", "hitch.stuck") > 0.0
    worst = "hitch_angle" if stuck else max(names, key=lambda name: abs(pairs[name][0] - pairs[name][1]))
    measured, found = pairs[worst]
    return (
        f"the sensor of the {names[worst]} shows {measured:.1f}°, which contradicts the motion of both bodies "
        f"({found:.1f}° are estimated): it is stuck{'' if stuck else ', has the wrong sign or is off'}."
    )


def _leans_otherwise(record: StepRecord, autopilot: Autopilot) -> str:
    """Say which roll sensor is wrong, and what about it."""
    sensors = []
    for place, body in enumerate(("tractor", "trailer")):
        doubt = _live(autopilot, "alignment", "leans.doubts", place)
        if doubt:
            shown = f"{math.degrees(getattr(record.measurement, f'{body}_roll')):.1f}°"
            wrong = "stands still while it does not" if doubt == _STUCK else "is reversed"
            sensors.append(f"the roll of the {body} ({shown}) {wrong}")
    return (
        f"{' and '.join(sensors)}, as the swing of its antenna, its pitch in other headings and the other body's "
        "attitude show: right side down is positive; look at the sensor's mounting and at the mast's height."
    )


def _lost(estimate: Estimate, autopilot: Autopilot) -> str:
    """Say why guidance had no reference."""
    guidance = autopilot.library.components["guidance"].live
    for pose in (estimate.tractor, estimate.trailer):
        if not math.isfinite(pose.x + pose.y + pose.yaw):
            return f"the estimated {pose} was not finite."
    speed = estimate.longitudinal_slip * estimate.speed
    if not math.isfinite(speed):
        return f"the estimated speed over ground was {speed} m/s."
    tractor, progress = estimate.tractor, guidance.array("guidance.progress")[0]
    turned = wrap(tractor.yaw - float(autopilot.path.sample(np.array(progress))[2]))
    curvature, rate, room = (float(guidance.array(name)[0]) for name in ("limits.curvature", "limits.rate", "room"))
    return (
        f"the tractor at ({tractor.x:z.2f}, {tractor.y:z.2f}) m faced {math.degrees(turned):.0f}° away from the "
        f"path; turns of {curvature:g} 1/m and {rate:g} 1/m² do not lead onto it within "
        f"{room:g} m beside it: turn the vehicle by hand, or raise guidance.turning_room or "
        f"vehicle.curvature_limit{'; or are the antennas swapped?' if abs(turned) > _SWAPPED else ''}"
    )
