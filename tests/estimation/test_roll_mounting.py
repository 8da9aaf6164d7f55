"""A roll sensor that is mounted askew is found while driving, as far as turns on slopes show it."""

import math
from collections.abc import Callable, Iterator
from itertools import count

import numpy as np
import pytest
from alignment import Alignment
from ordinary import believed, measured

from drawbar.config import load_configuration
from drawbar.geometry import Floats
from drawbar.report.masts import mounting_text
from drawbar.report.path_errors import true_path_errors
from drawbar.signals import Actuation, Measurement, Pose
from drawbar.simulation import Simulation
from drawbar.vehicle.parameters import Mast, Masts, VehicleParameters

DEGREE = math.radians(1.0)
STEP = 0.5
"""m of way between two samples, which are 0.2 s apart"""


UP = 2.5


def vehicle(deviation: float) -> VehicleParameters:
    mast = Mast(up=UP, roll_deviation=deviation)
    return VehicleParameters(masts=Masts(tractor=mast, trailer=mast))


def laps(straight: float, turn: float) -> Iterator[float]:
    """Yield the yaws of laps, always to the left, of two straights and two half circles of such ways, m."""
    for number in count():
        lap, way = divmod(STEP * number, 2.0 * (straight + turn))
        half, way = divmod(way, straight + turn)
        yield math.pi * (2.0 * lap + half + max(way - straight, 0.0) / turn)


def eight(radius: float) -> Iterator[float]:
    """Yield the yaws of a figure-eight that begins at its crossing, heading east, to the left first."""
    arc = 1.5 * math.pi
    for number in count():
        way = STEP * number / radius  # in radii: a straight of 1, an arc, a straight of 2, an arc, a straight
        yield min(max(way - 1.0, 0.0), arc) - min(max(way - 3.0 - arc, 0.0), arc)


def plane(_: float) -> float:
    return 1.0


def hill(x: float) -> float:
    """Return by which share of its slope ground falls so far east, m: the other way on both sides of its ridge."""
    return math.tanh((x - 10.0) / 5.0)


def driven(
    deviation: float,
    yaws: Iterator[float],
    lean: Floats,
    samples: int,
    ground_falls: Callable[[float], float] = plane,
) -> tuple[Actuation, float, list[Measurement]]:
    """Drive a tractor whose sensor shows lean = (slope to the south, roll on all headings), rad.

    The slope is so many times as steep at a place, by how far east that is, m.

    Returns what is told at the end, what was taken off the last roll, rad, and all measurements.
    """
    alignment, sent = Alignment(vehicle(deviation)), list[Measurement]()
    rng, x, y, before = np.random.default_rng(0), 0.0, 0.0, None
    for number in range(samples):
        yaw = next(yaws)
        x, y = x + STEP * math.cos(yaw), y + STEP * math.sin(yaw)
        slope = ground_falls(x) * lean[0]
        now = [Pose(x=x - back * math.cos(yaw), y=y - back * math.sin(yaw), yaw=yaw) for back in (0.0, 2.15)]
        m = measured(
            now[0].x,
            now[0].y,
            now[1].x,
            now[1].y,
            time=0.2 * number,
            speed=STEP / 0.2,
            tractor_roll=slope * math.cos(yaw) + lean[1] + rng.normal(0.0, 1e-4),  # else it is stuck
            tractor_pitch=slope * math.sin(yaw),
        )
        if before is not None:
            past = believed(*before, time=m.time - 0.2, speed=m.speed)
            ground = alignment.apply(m, past, believed(*now, time=m.time, speed=m.speed))
            sent.append(m)
        before = now
    left = math.cos(yaw) * (ground.tractor_y - m.tractor_y) - math.sin(yaw) * (ground.tractor_x - m.tractor_x)
    return alignment.found(), m.tractor_roll - math.asin(left / UP), sent


def conditioned(sent: list[Measurement], yaws: Iterator[float], deviation: float) -> tuple[float, float]:
    """Return mean and deviation of the tractor's roll offset by one Gaussian for all samples at once."""
    rows, values, ways = [], [], []
    next(yaws)
    for number, m in enumerate(sent, start=1):
        yaw = next(yaws)
        for value, row in (
            (m.tractor_roll, (-math.sin(yaw), math.cos(yaw), 1.0, 0.0)),
            (m.tractor_pitch, (math.cos(yaw), math.sin(yaw), 0.0, 1.0)),
        ):
            rows.append(row)
            values.append(value)
            ways.append(STEP * number)
    h, way = np.array(rows), np.array(ways)
    prior = np.diag([8.0 * DEGREE, 8.0 * DEGREE, deviation, 1.5 * DEGREE]) ** 2
    walk = np.diag([0.2, 0.2, 0.01, 0.01]) ** 2 * DEGREE**2
    noise = np.maximum(3.0 / np.where(way == way[0], 3.0 + STEP, STEP), 1.0) * DEGREE**2
    together = h @ prior @ h.T + np.minimum.outer(way, way) * (h @ walk @ h.T) + np.diag(noise)
    with_state = (prior + way[-1] * walk) @ h.T - (way[-1] - way) * (walk @ h.T)
    gain = np.linalg.solve(together, with_state.T).T
    left = prior + way[-1] * walk - gain @ with_state.T
    return float(gain[2] @ np.array(values)), math.sqrt(left[2, 2])


@pytest.mark.parametrize("deviation", [0.2 * DEGREE, 0.7 * DEGREE, 1.5 * DEGREE])
def test_offset_and_deviation_are_those_of_all_measurements_at_once(deviation: float) -> None:
    lean = np.array([4.0, 1.0]) * DEGREE
    told, off, sent = driven(deviation, laps(20.0, 25.0), lean, 200)
    offset, spread = conditioned(sent, laps(20.0, 25.0), deviation)
    # the stated deviation comes in at the end, behind a change by 0.1 degree on 100 m
    assert told.tractor_roll_offset == pytest.approx(offset, abs=0.25 * spread)
    assert told.tractor_roll_deviation == pytest.approx(spread, rel=0.12)
    doubt = told.tractor_roll_deviation / told.tractor_roll_offset
    assert off == pytest.approx(told.tractor_roll_offset * (1.0 - doubt**2), rel=0.02)


def test_on_one_heading_a_slope_is_no_offset() -> None:
    told, off, _ = driven(0.7 * DEGREE, iter([0.3] * 400), np.array([5.0, 0.0]) * DEGREE, 400)
    assert abs(told.tractor_roll_offset) < 0.1 * DEGREE
    assert told.tractor_roll_deviation > 0.9 * 0.7 * DEGREE
    assert off == pytest.approx(0.0, abs=1e-9)


def test_ground_whose_slope_changes_is_no_offset() -> None:
    """A figure-eight across a ridge, with a sensor that is not askew."""
    taken = [
        driven(0.7 * DEGREE, eight(20.0), np.array([6.0, 0.0]) * DEGREE, samples, hill)[1] / DEGREE
        for samples in (200, 300, 400, 540)
    ]
    print("\non a hill taken off: " + ", ".join(f"{off:.2f}" for off in taken) + " degrees")
    assert np.abs(taken).max() < 0.5


def test_an_offset_that_is_exact_is_left_as_it_is() -> None:
    told, off, _ = driven(0.0, laps(20.0, 25.0), np.array([0.0, 1.0]) * DEGREE, 200)
    assert told.tractor_roll_offset == told.tractor_roll_deviation == told.trailer_roll_offset == 0.0
    assert off == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("deviation", "most"), [(0.7, 0.85), (0.1, 0.05)])
def test_laps_round_a_ridge_look_askew_by_what_the_deviation_allows(deviation: float, most: float) -> None:
    """Both sides of a ridge fall by 1 degree, and laps to the left have it always on the left."""
    off = driven(deviation * DEGREE, laps(200.0, 40.0), np.array([0.0, -1.0]) * DEGREE, 4000)[1]
    print(f"\n{deviation} degrees stated: {-off / DEGREE:.2f} of 1 degree taken off after 2 km")
    assert 0.0 < -off < most * DEGREE


MASTS = "vehicle.masts={tractor={up=2.5%s},trailer={up=2.0%s}}"
FIELD = ("path.radii=[8.0]", "machine.terrain={slope=0.0873,creep=0.36,unevenness=0.02}")
ASKEW = "machine.attitude={tractor={present=true,roll_bias=0.01745},trailer={present=true}}"


def run(*changes: str) -> tuple[float, Actuation, str]:
    """Return the tractor's mean error in the second loop, m, what is told at the end, and what the report says."""
    with Simulation(load_configuration("articulated", [*FIELD, ASKEW, *changes]), seed=2) as simulation:
        log = simulation.log()
    errors = np.abs(true_path_errors(log).tractor.error)
    return (
        float(np.nanmean(errors[len(errors) // 2 :])),
        log.records[-1].actuation,
        mounting_text(log, "tractor") + mounting_text(log, "trailer"),
    )


def test_a_run_with_a_roll_sensor_that_is_askew_finds_it() -> None:
    error, told, text = run(MASTS % ("", ""))
    left, untold, silent = run(MASTS % (",roll_deviation=0", ",roll_deviation=0"))
    found, doubt = told.tractor_roll_offset / DEGREE, told.tractor_roll_deviation / DEGREE
    print(f"\nsecond loop {100.0 * left:.1f} -> {100.0 * error:.1f} cm; found {found:.2f} ± {doubt:.2f} degrees")
    assert error < 0.6 * left
    assert abs(told.tractor_roll_offset - DEGREE) < 2.0 * told.tractor_roll_deviation < 0.6 * DEGREE
    assert abs(told.trailer_roll_offset) < 2.0 * told.trailer_roll_deviation
    assert "the tractor's roll sensor shows" in text
    assert "vehicle.masts.tractor.roll_offset = 0.01" in text
    assert "trailer" not in text
    assert untold.tractor_roll_offset == 0.0
    assert silent == ""


def test_what_a_report_recommends_is_the_whole_offset() -> None:
    _, told, text = run(MASTS % (",roll_offset=0.03,roll_deviation=0.02", ""))
    assert told.tractor_roll_offset == pytest.approx(0.01745 - 0.03, abs=2.0 * told.tractor_roll_deviation)
    stated = float(text.split("roll_offset = ")[1].split()[0])
    assert stated == pytest.approx(0.03 + told.tractor_roll_offset, abs=1e-4)
