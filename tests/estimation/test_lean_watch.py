"""Roll sensors that are reversed or stuck: seen by the swing of antennas, by the slope, by the other body."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import count, islice, pairwise

import numpy as np
import pytest
from alignment import Alignment
from ordinary import believed, measured

from drawbar.config import load_configuration
from drawbar.experiment.alteration import InterceptedMachine
from drawbar.geometry import arm_offset
from drawbar.signals import Measurement, Pose, Status
from drawbar.simulation import Simulation
from drawbar.vehicle.parameters import Mast, Masts, VehicleParameters
from drawbar.vehicle.sensors import SensorNoise

SAMPLE = 0.2
UP = 2.5
NOISE = math.radians(0.2)
MASTS = VehicleParameters(masts=Masts(tractor=Mast(up=UP), trailer=Mast(up=UP)))
LEVEL = VehicleParameters()
Lean = Callable[[float], float]
Slope = Callable[[float, float], tuple[float, float]]


def level(_east: float, _north: float) -> tuple[float, float]:
    return 0.0, 0.0


def hills(seed: int, rms: float, length: float) -> Slope:
    """Return by how much ground rises to the east and to the north at a place, rad.

    It is the sum of six waves of random directions and of lengths about `length`, m; `rms` of the gradient, rad.
    """
    rng = np.random.default_rng(seed)
    number, heading = 2.0 * math.pi / (length * rng.uniform(0.7, 1.4, 6)), rng.uniform(0.0, 2.0 * math.pi, 6)
    phase, size = rng.uniform(0.0, 2.0 * math.pi, 6), rms / math.sqrt(3.0)

    def slope(x: float, y: float) -> tuple[float, float]:
        rise = size * np.cos(number * (np.cos(heading) * x + np.sin(heading) * y) + phase)
        return float(rise @ np.cos(heading)), float(rise @ np.sin(heading))

    return slope


def passes(way: float) -> float:
    """Return the yaw on passes of 40 m, with half circles of 6 m between them to either side in turn, rad."""
    turn = 6.0 * math.pi
    on = way % (2.0 * (40.0 + turn))
    turned = math.pi * max(on % (40.0 + turn) - 40.0, 0.0) / turn
    return turned if on < 40.0 + turn else math.pi - turned


def east(_: float) -> float:
    return 0.0


def circle(way: float) -> float:
    """Return the yaw on a circle of 8 m after so much way, rad."""
    return way / 8.0


def wavy(way: float) -> float:
    """Return the roll on uneven ground, rad."""
    return math.radians(1.4) * (math.sin(1.1 * way) + math.sin(0.45 * way + 1.0))


@dataclass(frozen=True)
class Drive:
    """A vehicle whose bodies lean as the ground has it."""

    vehicle: VehicleParameters = MASTS
    yaw: Callable[[float], float] = east
    slope: float = 0.0
    """to the south, rad"""
    ground: Slope = level
    """beside it"""
    tractor: Lean = east
    """roll beside the slope's over the way, rad"""
    trailer: Lean = east
    speed: float = 1.0
    zeros: tuple[float, float] = (0.0, 0.0)
    """of both roll sensors, rad"""
    late: float = 0.0
    """by how much the ground that both roll sensors tell of is late, s"""
    noise: float = 0.02
    """of the fixes, m"""
    seed: int = 0

    def measurements(self) -> Iterator[tuple[Measurement, list[Pose]]]:
        """Yield what is measured, and where both ground points are, sample by sample."""
        rng, x, y = np.random.default_rng(self.seed), 0.0, 0.0
        for k in count():
            way, step = SAMPLE * k * self.speed, SAMPLE * self.speed
            yaw = self.yaw(way)
            x, y = (x + step * math.cos(yaw), y + step * math.sin(yaw)) if k else (0.0, 0.0)
            poses = [Pose(x=x - back * math.cos(yaw), y=y - back * math.sin(yaw), yaw=yaw) for back in (0.0, 2.15)]
            values: dict[str, float] = {"time": SAMPLE * k, "speed": self.speed}
            sensors = zip(("tractor", "trailer"), poses, (self.tractor, self.trailer), self.zeros, strict=True)
            for body, pose, lean, zero in sensors:
                beside, told = lean(way), lean(way - self.late * self.speed)
                mast = getattr(self.vehicle.masts, body)
                rises, north = self.ground(pose.x, pose.y)
                north += self.slope
                roll = north * math.cos(yaw) - rises * math.sin(yaw) + beside
                pitch = north * math.sin(yaw) + rises * math.cos(yaw)
                arm = arm_offset(yaw, roll, pitch, (mast.forward, mast.left, mast.up))
                fix = np.array([pose.x, pose.y]) + arm + rng.normal(0.0, self.noise, 2)
                values |= {f"{body}_x": fix[0], f"{body}_y": fix[1]}
                values[f"{body}_roll"] = roll + told - beside + zero + rng.normal(0.0, NOISE)
                values[f"{body}_pitch"] = pitch + rng.normal(0.0, NOISE)
            fixes = [values.pop(name) for name in ("tractor_x", "tractor_y", "trailer_x", "trailer_y")]
            yield measured(*fixes, **values), poses


def reversed_rolls(*bodies: str) -> Callable[[Measurement], Measurement]:
    return lambda m: replace(m, **{f"{body}_roll": -getattr(m, f"{body}_roll") for body in bodies})


def stuck_rolls(begins: float, *bodies: str) -> Callable[[Measurement], Measurement]:
    still: dict[str, float] = {}

    def change(m: Measurement) -> Measurement:
        if m.time < begins:
            return m
        names = [f"{body}_roll" for body in bodies]
        return replace(m, **{name: still.setdefault(name, getattr(m, name)) for name in names})

    return change


def watched(
    drive: Drive, change: Callable[[Measurement], Measurement] = lambda m: m, lasts: float = 60.0
) -> tuple[float, list[int]]:
    """Return when the run is ended for a roll, s, inf: it is not, and what is doubted of both bodies."""
    alignment = Alignment(drive.vehicle, SensorNoise(position=max(drive.noise, 0.03)))
    states = drive.measurements()
    for (_, before), (m, now) in pairwise(states):
        past = believed(*before, time=m.time - SAMPLE, speed=drive.speed)
        alignment.apply(change(m), past, believed(*now, time=m.time, speed=drive.speed))
        if alignment.status:
            assert alignment.status == Status.ROLL
            return m.time, alignment.live.array("positions.leans.faults").tolist()
        if m.time >= lasts:
            break
    return math.inf, alignment.live.array("positions.leans.faults").tolist()


REVERSED, STUCK = 1, 2


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("body", "faults"), [("tractor", [REVERSED, 0]), ("trailer", [0, REVERSED])])
def test_an_antenna_that_swings_against_its_roll_names_the_sensor(body: str, faults: list[int], seed: int) -> None:
    drive = Drive(tractor=wavy, trailer=lambda way: wavy(way - 2.4), seed=seed)
    when, found = watched(drive, reversed_rolls(body))
    assert when <= 8.0
    assert found == faults


@pytest.mark.parametrize("seed", range(3))
def test_a_late_roll_of_a_body_that_rocks_is_not_reversed(seed: int) -> None:
    """0.2 s are nearly half a period of its rocking."""

    def rocking(way: float) -> float:
        return 0.5 * wavy(way) + math.radians(1.2) * math.sin(2.2 * 2.0 * math.pi * way)

    drive = Drive(tractor=rocking, trailer=lambda way: rocking(way - 2.4), late=0.2, seed=seed)
    assert watched(drive, lasts=120.0) == (math.inf, [0, 0])
    assert watched(replace(drive, late=0.0), reversed_rolls("tractor"))[1] == [REVERSED, 0]


def test_two_bodies_that_lean_away_from_each_other_are_seen_at_once() -> None:
    for body in ("tractor", "trailer"):
        when, faults = watched(Drive(vehicle=LEVEL, slope=math.radians(5.0)), reversed_rolls(body))
        assert when <= 2.0
        assert faults == [REVERSED, REVERSED]  # which of them is wrong does not show


def test_a_roll_that_turns_round_on_a_slope_is_seen_within_metres() -> None:
    drive, reverse = Drive(vehicle=LEVEL, slope=math.radians(3.0), yaw=circle), reversed_rolls("tractor")
    when, faults = watched(drive, lambda m: reverse(m) if m.time > 100.0 else m, lasts=150.0)
    assert 100.0 < when <= 115.0
    assert faults == [REVERSED, 0]


def test_a_slope_shows_both_rolls_reversed_in_the_first_curve_and_not_before() -> None:
    slope = math.radians(5.0)
    straight = Drive(vehicle=LEVEL, slope=slope)
    assert watched(straight, reversed_rolls("tractor", "trailer"))[0] == math.inf
    when, faults = watched(replace(straight, yaw=circle), reversed_rolls("tractor", "trailer"))
    assert when <= 10.0  # a turn by 70°
    assert faults == [REVERSED, REVERSED]


@pytest.mark.parametrize(
    ("drive", "bodies", "within"),
    [
        (Drive(tractor=wavy, trailer=wavy, vehicle=LEVEL), ("trailer",), 5.0),  # by the other body
        (Drive(tractor=wavy, trailer=wavy), ("tractor", "trailer"), 6.0),  # by the antennas
        (Drive(vehicle=LEVEL, slope=0.09, yaw=circle), ("tractor", "trailer"), 8.0),  # by the slope
    ],
)
def test_a_roll_that_stands_still_is_stuck(drive: Drive, bodies: tuple[str, ...], within: float) -> None:
    when, faults = watched(drive, stuck_rolls(10.0, *bodies))
    assert 10.0 < when <= 10.0 + within
    named = {body for body, doubt in zip(("tractor", "trailer"), faults, strict=True) if doubt}
    assert named <= set(bodies)
    assert set(faults) <= {0, STUCK}


def test_what_is_stated_of_fixes_counts_where_receivers_tell_nothing() -> None:
    tall = VehicleParameters(masts=Masts(tractor=Mast(up=3.7), trailer=Mast(up=3.7)))
    for seed in range(40):
        coarse = Drive(vehicle=tall, slope=0.01, noise=0.05, seed=seed)
        assert watched(coarse, lasts=15.0)[0] == math.inf
    swinging = Drive(vehicle=tall, tractor=wavy, trailer=wavy, noise=0.05)
    assert watched(swinging, reversed_rolls("tractor"))[0] <= 12.0


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    "drive",
    [
        Drive(),
        Drive(slope=0.09, yaw=circle, zeros=(0.035, -0.035)),
        Drive(tractor=wavy, trailer=lambda way: wavy(way - 2.4), slope=0.05, yaw=circle, speed=2.0),
        Drive(tractor=wavy, trailer=lambda way: wavy(1.3 * way), zeros=(-0.02, 0.05)),
        Drive(vehicle=LEVEL, tractor=lambda way: 2.0 * wavy(way), trailer=lambda way: 2.0 * wavy(1.3 * way)),
    ],
)
def test_sensors_with_noise_and_zeros_are_believed(drive: Drive, seed: int) -> None:
    assert watched(replace(drive, seed=seed), lasts=200.0) == (math.inf, [0, 0])


def test_on_hills_sensors_are_believed_and_their_zeros_are_as_uncertain_as_told() -> None:
    """A slope that changes within metres is no error of a sensor."""
    off, degree = list[float](), math.radians(1.0)
    for seed in range(20):
        alignment = Alignment(LEVEL)
        drive = Drive(vehicle=LEVEL, yaw=passes, speed=1.5, ground=hills(seed, 4.0 * degree, 40.0))
        for (_, before), (m, now) in islice(pairwise(drive.measurements()), 750):
            past = believed(*before, time=m.time - SAMPLE, speed=drive.speed)
            alignment.apply(m, past, believed(*now, time=m.time, speed=drive.speed))
            assert not alignment.status
        zero = alignment.live.array("positions.leans.bank.states").reshape(4, 6)[0, 2]
        off.append(zero / math.sqrt(alignment.live.array("positions.leans.bank.covariance").reshape(6, 6)[2, 2]))
    assert np.sqrt(np.mean(np.square(off))) < 2.0


@pytest.mark.parametrize("seed", range(4))
def test_a_roll_that_never_changes_on_level_ground_is_believed(seed: int) -> None:
    """The noise of the fixes, beside a roll without any, is no swing."""
    drive = Drive(yaw=circle, seed=seed)
    assert watched(drive, lambda m: replace(m, tractor_roll=0.0, trailer_roll=0.0), lasts=600.0)[0] == math.inf


def test_one_sensor_or_none_is_enough() -> None:
    for bodies in (("trailer",), ("tractor", "trailer")):
        missing = {f"{body}_{angle}": math.nan for body in bodies for angle in ("roll", "pitch")}
        drive = Drive(tractor=wavy, trailer=wavy)
        assert watched(drive, lambda m, missing=missing: replace(m, **missing))[0] == math.inf
    missing = {"trailer_roll": math.nan, "trailer_pitch": math.nan}
    reverse = reversed_rolls("tractor")
    assert watched(drive, lambda m: replace(reverse(m), **missing))[1] == [REVERSED, 0]


@pytest.mark.parametrize("jump", [-5.0, -1.0, 0.45, 5.0])
def test_a_jump_of_the_antenna_is_no_roll(jump: float) -> None:
    drive = Drive(slope=0.05, tractor=lambda way: 0.2 * wavy(way), trailer=lambda way: 0.2 * wavy(way - 2.4), seed=1)
    jumps = watched(drive, lambda m: replace(m, tractor_y=m.tractor_y + (jump if m.time > 30.0 else 0.0)), lasts=50.0)
    assert jumps == (math.inf, [0, 0])


def test_a_body_without_a_sensor_is_not_named() -> None:
    missing = {"trailer_roll": math.nan, "trailer_pitch": math.nan}
    reverse = reversed_rolls("tractor")
    drive = Drive(vehicle=LEVEL, slope=math.radians(5.0), yaw=circle)
    assert watched(drive, lambda m: replace(reverse(m), **missing))[1] == [REVERSED, 0]


def test_the_bank_finds_what_conditioning_all_measurements_at_once_finds() -> None:
    """Slope and zeros of the likeliest hypothesis, against one Gaussian for all samples together."""
    drive, samples = Drive(vehicle=LEVEL, slope=0.006, yaw=circle, zeros=(0.004, -0.003)), 120
    alignment, rows, values, ways = Alignment(LEVEL), [], [], []
    for (_, before), (m, now) in pairwise(drive.measurements()):
        if len(ways) == 4 * samples:
            break
        alignment.apply(m, believed(*before, time=m.time - SAMPLE, speed=1.0), believed(*now, time=m.time, speed=1.0))
        for body, pose in zip(("tractor", "trailer"), now, strict=True):
            sine, cosine = math.sin(pose.yaw), math.cos(pose.yaw)
            for angle, row in (("roll", (-sine, cosine)), ("pitch", (cosine, sine))):
                rows.append([*row, *np.eye(4)[len(rows) % 4]])
                values.append(getattr(m, f"{body}_{angle}"))
                ways.append(m.time)
    h, way = np.array(rows), np.array(ways)
    degree = math.radians(1.0)
    prior = np.diag(np.array([8.0, 8.0, 1.5, 1.5, 1.5, 1.5]) * degree) ** 2
    walk = np.diag(np.array([0.2, 0.2, 0.01, 0.01, 0.01, 0.01]) * degree) ** 2
    together = (h @ prior @ h.T) + np.minimum.outer(way, way) * (h @ walk @ h.T)
    counts = np.maximum(3.0 / np.where(way == way[0], 3.0 + SAMPLE, SAMPLE), 1.0)
    with_state = (prior + way[-1] * walk) @ h.T - (way[-1] - way) * (walk @ h.T)
    gain = np.linalg.solve(together + np.diag(counts * degree**2), with_state.T).T
    states = alignment.live.array("positions.leans.bank.states").reshape(4, 6)
    covariance = alignment.live.array("positions.leans.bank.covariance").reshape(6, 6)
    assert states[0] == pytest.approx(gain @ np.array(values), abs=1e-9)
    assert covariance == pytest.approx(prior + way[-1] * walk - gain @ with_state.T, abs=1e-12)
    assert states[0, [2, 4]] == pytest.approx(drive.zeros, abs=0.3 * degree)


LEANS = (
    "path.radii=[8.0]",
    "machine.attitude={tractor={present=true},trailer={present=true}}",
    "vehicle.masts={tractor={up=2.5},trailer={up=2.0}}",
)


@pytest.mark.parametrize(
    ("terrain", "change", "names", "until"),
    [
        ("unevenness=0.04", reversed_rolls("tractor"), ["roll of the tractor"], 6.0),
        ("unevenness=0.04", reversed_rolls("trailer"), ["roll of the trailer"], 10.0),
        ("slope=0.0873", reversed_rolls("trailer"), ["tractor", "trailer"], 2.0),
        ("slope=0.0873", reversed_rolls("tractor", "trailer"), ["tractor", "trailer"], 20.0),
        ("unevenness=0.04", stuck_rolls(10.0, "trailer"), ["roll of the trailer", "stands still"], 18.0),
        ("slope=0.0873", stuck_rolls(10.0, "tractor"), ["roll of the tractor", "stands still"], 22.0),
    ],
)
def test_a_run_ends_with_the_name_of_the_sensor(
    terrain: str, change: Callable[[Measurement], Measurement], names: list[str], until: float
) -> None:
    with Simulation(load_configuration("articulated", [*LEANS, f"machine.terrain={{{terrain}}}"])) as simulation:
        simulation.machine = InterceptedMachine(simulation.machine, change)
        log = simulation.log()
    assert all(name in log.outcome.reason for name in names), log.outcome.reason
    assert log.records[-1].measurement.time <= until
