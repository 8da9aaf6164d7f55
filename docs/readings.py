"""Print the tables of docs/theory.md: python docs/readings.py [TEXT ...].

Each row is one change of a shipped configuration, or of what joins its parts, driven with seeds 0 to 4. Distances are
those of each body's true antenna position from the path, in cm, tractor / trailer: means by curvature over all seeds,
and the largest of all seeds; then the largest RMS error of the estimated yaw of any seed, and the solver failures of
all. With TEXT only the rows whose name contains one of the texts. Of the recorded lines only the first comes with the
repository; the others need a real field in ../shared/data, and are left out without it.
"""

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from drawbar.config import Configuration, load_configuration
from drawbar.estimation.estimator import Estimator
from drawbar.estimation.moving_horizon import MovingHorizonEstimator
from drawbar.geometry import Floats, wrap
from drawbar.guidance.look_ahead import LookAhead
from drawbar.guidance.path import Path
from drawbar.machine.base import Machine
from drawbar.machine.simulated import SimulatedMachine
from drawbar.report.path_errors import project_track
from drawbar.signals import Command, Estimate, Measurement, SolveTimes, StepRecord, Truth
from drawbar.simulation import RunAborted, drive
from drawbar.step.autopilot import Autopilot
from drawbar.step.build import build_autopilot, build_machine, build_path

SEEDS = range(5)
ROOT = FilePath(__file__).parents[1]
FIELDS = {
    ROOT / "examples" / "field": ("Cu 14.1°",),
    ROOT.parent / "shared" / "data" / "agopengps-field": ("Cu 275.4°", "Cu 49.9°", "Cu 183.7°"),
}
"""folders of recorded lines, and those that are driven"""
Build = Callable[[Configuration, Path, SimulatedMachine], Autopilot]


class ReversedSensor(Machine):
    """A machine whose joint sensor turns the other way as well, together with its actuator."""

    def __init__(self, machine: SimulatedMachine) -> None:
        """Wrap the machine."""
        self._machine = machine

    def read(self) -> Measurement:
        """Return the measurement with the joint angle's sign reversed."""
        measurement = self._machine.read()
        return replace(measurement, trailer_steering=-measurement.trailer_steering)

    def write(self, command: Command) -> None:
        """Pass the command on."""
        self._machine.write(command)

    def truth(self) -> Truth:
        """Return the machine's own truth."""
        return self._machine.truth()


class BothAdvance(LookAhead):
    """Look-ahead whose trailer reference advances along the path as the tractor's does."""

    def __init__(self, *arguments: Any, **settings: Any) -> None:
        super().__init__(*arguments, **settings)
        advance = self.component.array("advance")
        advance[1] = advance[0]


def with_reversed_sensor(configuration: Configuration, path: Path, machine: SimulatedMachine) -> Autopilot:
    """Build the autopilot on a machine whose joint sensor is reversed too."""
    return build_autopilot(configuration, path, ReversedSensor(machine))


class ToldOfTheSlope(Estimator):
    """A moving horizon estimator that somebody tells when a slope begins: for 1.5 s it lets the slope drift at will."""

    DRIFT = 0.05
    """rad per sample"""

    def __init__(self, estimator: Estimator) -> None:
        """Take over the product's estimator."""
        assert isinstance(estimator, MovingHorizonEstimator)
        self._estimator, self._drift = estimator, estimator.solver.workspace.array("common")
        self._quiet = self._drift.copy()

    def update(self, measurement: Measurement) -> Estimate:
        """Return the estimate at the measurement's time."""
        begins = 25.0 <= measurement.time < 26.5
        self._drift[:] = self._quiet * (self.DRIFT / self._quiet.max() if begins else 1.0)
        return self._estimator.update(measurement)

    def prepare(self, command: Command | None = None) -> None:
        """Prepare for the next measurement."""
        self._estimator.prepare(command)

    @property
    def times(self) -> SolveTimes:
        """Wall-clock times, s."""
        return self._estimator.times


def told_of_the_slope(configuration: Configuration, path: Path, machine: SimulatedMachine) -> Autopilot:
    """Build the autopilot with an estimator that knows when the slope begins."""
    autopilot = build_autopilot(configuration, path, machine)
    autopilot.estimator = ToldOfTheSlope(autopilot.estimator)
    return autopilot


def with_look_ahead(
    kind: type[LookAhead],
    speed: float,
    configuration: Configuration,
    path: Path,
    machine: SimulatedMachine,
) -> Autopilot:
    """Build the autopilot with another kind of look-ahead, advancing at the given speed, m/s."""
    autopilot, first = build_autopilot(configuration, path, machine), machine.read()
    autopilot.guidance = kind(
        path,
        configuration.guidance,
        stages=configuration.controller.horizon,
        interval=configuration.sample_time,
        speed=speed,
        tractor=(first.tractor_x, first.tractor_y),
        trailer=(first.trailer_x, first.trailer_y),
    )
    return autopilot


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """One row: a name, a shipped configuration, and what is changed."""

    name: str
    base: str
    changes: Sequence[str] = ()
    build: Build = build_autopilot


def _paper(name: str, *changes: str, build: Build = build_autopilot) -> Reading:
    return Reading(name=name, base="paper", changes=changes, build=build)


def _product(name: str, *changes: str) -> Reading:
    return Reading(name=name, base="articulated", changes=changes)


DEVIATION_DRIFT = (
    "estimator.drift={position=10.0, yaw=0.1, slip=0.25, hitch_angle=0.1745, speed=0.1}"  # D_update as printed
)
READINGS = (
    _paper("as shipped"),
    _paper("joint_sign = 1 (geometric)", "vehicle.joint_sign=1"),
    _paper("joint sensor reversed too", build=with_reversed_sensor),
    _paper("H = diag(sigma)^-2", "estimator.weighting=statistical"),
    _paper("D_update as deviations", DEVIATION_DRIFT),
    _paper("stage cost times dt", "controller.position_weight=0.2", "controller.steering_weight=2.0"),
    _paper("tractor reference constant", build=partial(with_look_ahead, LookAhead, 0.0)),
    _paper("trailer reference advances", build=partial(with_look_ahead, BothAdvance, 1.0)),
    _paper("N = 15", "controller.horizon=15"),
    _paper("N = 15, reference constant", "controller.horizon=15", build=partial(with_look_ahead, LookAhead, 0.0)),
    _paper("coupling measured", "controller.coupling=measured"),
    _paper("coupling planned", "controller.coupling=planned"),
    _paper("centralised", "controller.structure=centralised"),
    _paper("centralised, joint_sign = 1", "controller.structure=centralised", "vehicle.joint_sign=1"),
    _paper("no ancillary law", "tube.tractor.yaw=0.0", "tube.trailer.yaw=0.0"),
    _paper("look-ahead from the front axle", "guidance.look_ahead=3.0"),
    _paper("window 1 s", "estimator.window=5"),
    _paper("window 6 s", "estimator.window=30"),
    _paper("trailer antenna over its axle", "vehicle.trailer_antenna=0.0"),
    _paper("trailer antenna half way to RJ2", "vehicle.trailer_antenna=0.65"),
    _paper("estimator on the chain", "estimator={model='articulated'}"),
    _product("as shipped"),
    _product("estimator on the tricycle", "estimator={model='tricycle', weighting='statistical'}"),
    _product("coupling neglected", "controller.coupling=neglected"),
    _product("coupling planned", "controller.coupling=planned"),
    _product("centralised", "controller.structure=centralised"),
    _product("tractor keeps to the path", "controller.sharing={share=0.0, widening=0.0}"),
    Reading(name="as shipped", base="articulated-no-ancillary"),
    Reading(name="as shipped", base="articulated-steering-off"),
    _product("window 1 s", "estimator.window=5"),
    _product("window 6 s", "estimator.window=30"),
)
SLOPE_READINGS = (
    _product("as shipped"),
    _product("no common drift", "estimator.drift.slope=0.0"),
    _product("no common drift, more of each", "estimator.drift={slope=0.0, crab=0.003, steering_offset=0.001}"),
    _product("common drift 0.004", "estimator.drift.slope=0.004"),
    _product("window 3 s", "estimator.window=15"),
    Reading(name="told when the slope begins", base="articulated", build=told_of_the_slope),
    Reading(name="the true state", base="articulated-ideal"),
)
"""what the estimator is told of slopes"""
EVENTS = {
    "no event": "",
    "GPS lost for 3 s": "{kind='gps_loss', start=25.0, duration=3.0}",
    "GPS lost for 10 s": "{kind='gps_loss', start=25.0, duration=10.0}",
    "GPS repeats its last fix for 10 s": "{kind='gps_loss', start=25.0, duration=10.0, report='held'}",
    "mu falls to 0.7": "{kind='slip_step', start=25.0, factor='longitudinal_slip', value=0.7}",
    "kappa falls to 0.7": "{kind='slip_step', start=25.0, factor='tractor_slip', value=0.7}",
    "bump of 5.6 cm and 2.3°": "{kind='bump', start=25.0, lateral=0.056, tractor_yaw=0.04}",
    "side slope, 3° of crab": "{kind='side_slope', start=25.0, crab=0.0524}",
}
"""on the first curve of one eight of radius 8 m"""
SLOPE_SEEDS = range(20)
SLOPE_COLUMNS = ("side slope, 3° of crab", "GPS lost for 10 s", "no event")
JUMPS = (0.05, 0.1, 0.12, 0.15, 0.2, 0.25, 0.3, 1.0, 5.0)
"""of one antenna, m"""
DIRECTIONS = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class Figures:
    """What one run is judged by."""

    means: Floats
    """(2, classes) mean distance of tractor and trailer by class of the path, m"""
    largest: Floats
    """(2,) largest distance, m"""
    yaw: Floats
    """(2,) RMS yaw error, rad"""
    failures: int
    finished: bool


def run(reading: Reading, seed: int) -> Figures:
    """Drive the whole path once."""
    configuration = load_configuration(reading.base, reading.changes)
    path, _ = build_path(configuration)
    autopilot = reading.build(configuration, path, build_machine(configuration, path, seed))
    records: list[StepRecord] = []
    finished = True
    try:
        records.extend(drive(autopilot, time_limit=2.0 * path.length / configuration.speed))
    except RunAborted:
        finished = False
    figures = [_body(path, records, body) for body in ("tractor", "trailer")]
    means, largest, yaw = (np.array(column) for column in zip(*figures, strict=True))
    failures = sum(record.solver_failures for record in records)
    return Figures(means=means, largest=largest, yaw=yaw, failures=failures, finished=finished)


def _body(path: Path, records: list[StepRecord], body: str) -> tuple[Floats, float, float]:
    """Return mean distance by class, largest distance (m) and RMS yaw error (rad) of one body."""
    truth = [getattr(record.truth, body) for record in records]
    believed = [getattr(record.estimate, body).yaw for record in records]
    first = getattr(records[0].reference, body).progress
    x, y = (np.array([getattr(pose, axis) for pose in truth]) for axis in ("x", "y"))
    errors = project_track(path, x, y, first)
    size = np.abs(errors.error)
    means = np.array([np.mean(size[errors.labels == name]) for name in path.label_names])
    yaw = [wrap(guess - pose.yaw) for guess, pose in zip(believed, truth, strict=True)]
    return means, float(size.max()), float(np.sqrt(np.mean(np.square(yaw))))


def row(reading: Reading) -> str:
    """Return the reading's row of the table."""
    runs = [run(reading, seed) for seed in SEEDS]
    pairs = (100.0 * np.mean([each.means for each in runs], axis=0)).T
    cells = [f"{tractor:.1f} / {trailer:.1f}" for tractor, trailer in pairs]
    largest, yaw = (np.max([getattr(each, name) for each in runs], axis=0) for name in ("largest", "yaw"))
    cells.append("{:.0f} / {:.0f}".format(*(100.0 * largest)))
    cells.append("{:.1f} / {:.1f}".format(*np.degrees(yaw)))
    cells.append(str(sum(each.failures for each in runs)))
    lost = sum(not each.finished for each in runs)
    return f"| {reading.base}: {reading.name} | {' | '.join(cells)} |" + (
        f" {lost} of {len(runs)} lost" if lost else ""
    )


def event_row(name: str, event: str) -> str:
    """Return the row of one event: the largest distances of both configurations."""
    changes = ("path.radii=[8.0]", f"machine.events=[{event}]")
    cells = []
    for base in ("paper", "articulated"):
        runs = [run(Reading(name=name, base=base, changes=changes), seed) for seed in SEEDS]
        lost = sum(not each.finished for each in runs)
        tractor, trailer = 100.0 * np.max([each.largest for each in runs], axis=0)
        cells.append(f"{tractor:.0f} / {trailer:.0f}" + (f" ({lost} of {len(runs)} lost)" if lost else ""))
    return f"| {name} | {' | '.join(cells)} |"


def slope_row(reading: Reading) -> str:
    """Return the row of one estimator: means over 20 seeds of the largest distance, by event."""
    cells = []
    for column in SLOPE_COLUMNS:
        changes = (*reading.changes, "path.radii=[8.0]", f"machine.events=[{EVENTS[column]}]")
        runs = [run(replace(reading, changes=changes), seed).largest for seed in SLOPE_SEEDS]
        cells.append("{:.1f} / {:.1f}".format(*(100.0 * np.mean(runs, axis=0))))
    return f"| {reading.name} | {' | '.join(cells)} |"


def jump_row(antenna: str) -> str:
    """Return the row of one antenna: the largest distances of any run by size of a jump that lasts 20 s."""
    cells = []
    for size in JUMPS:
        turns = np.exp(2j * np.pi * np.arange(DIRECTIONS) / DIRECTIONS)
        events = [
            f"{{kind='gps_jump', start=25.0, duration=20.0, antenna='{antenna}', east={jump.real}, north={jump.imag}}}"
            for jump in size * turns
        ]
        readings = [
            Reading(name=event, base="articulated", changes=("path.radii=[8.0]", f"machine.events=[{event}]"))
            for event in events
        ]
        tractor, trailer = 100.0 * np.max([run(each, seed).largest for each in readings for seed in SEEDS[:2]], axis=0)
        cells.append(f"{tractor:.0f} / {trailer:.0f}")
    return f"| {antenna}'s antenna | {' | '.join(cells)} |"


def line_row(field: FilePath, track: str) -> str:
    """Return the row of one recorded line: means by class, the largest distance, and what making it drivable cost."""
    where = (f'path.file="{field.as_posix()}"', f'path.track="{track}"')
    runs = [run(Reading(name=track, base="articulated", changes=where), seed) for seed in SEEDS]
    straight, curve, kink = 100.0 * np.mean([each.means for each in runs], axis=0).T
    tractor, trailer = 100.0 * np.max([each.largest for each in runs], axis=0)
    cells = [f"{pair[0]:.1f} / {pair[1]:.1f}" for pair in (straight, curve, kink)]
    cells.append(f"{tractor:.0f} / {trailer:.0f}")
    cells.append(" / ".join(f"{_deviation(where, limit):.3f}" for limit in (0.3, 0.41)))
    return f"| {track} | {' | '.join(cells)} |"


def _deviation(where: tuple[str, ...], limit: float) -> float:
    """Return the largest deviation of a line's points from its drivable path under a curvature limit (1/m), m."""
    changes = (*where, f"vehicle.curvature_limit={limit}", "guidance.path_tolerance=1.0")
    _, drivable = build_path(load_configuration("articulated", changes))
    assert drivable is not None
    return float(drivable.deviations.max())


def main(wanted: Sequence[str]) -> None:
    """Print the rows whose name contains one of the wanted texts, or all of them."""
    print("| reading | straight | 0.1 | 0.125 | 0.15 | largest, cm | yaw, ° | failures |")
    print("|---|---|---|---|---|---|---|---|")
    for reading in READINGS:
        if not wanted or any(text in f"{reading.base}: {reading.name}" for text in wanted):
            print(row(reading), flush=True)
    print("\n| event, largest distance in cm | paper | articulated |\n|---|---|---|")
    for name, event in EVENTS.items():
        if not wanted or any(text in name for text in wanted):
            print(event_row(name, event), flush=True)
    print(f"\n| what the estimator knows of slopes | {' | '.join(SLOPE_COLUMNS)} |\n|---|---|---|---|")
    for reading in SLOPE_READINGS:
        if not wanted or any(text in f"slopes: {reading.name}" for text in wanted):
            print(slope_row(reading), flush=True)
    print(f"\n| jump of | {' | '.join(f'{size:g} m' for size in JUMPS)} |\n|{'---|' * (len(JUMPS) + 1)}")
    for antenna in ("tractor", "trailer"):
        if not wanted or any(text in f"jump of {antenna}" for text in wanted):
            print(jump_row(antenna), flush=True)
    print("\n| line | straights | curves | kinks | largest | deviation at 0.3 / 0.41 1/m, m |")
    print("|---|---|---|---|---|---|")
    for field, track in ((field, track) for field, tracks in FIELDS.items() if field.exists() for track in tracks):
        if not wanted or any(text in track for text in wanted):
            print(line_row(field, track), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
