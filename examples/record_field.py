"""Drive the lines of examples/field by hand, in simulation; write them as AgOpenGPS writes a field, and one as CSV.

Nobody's field. The driver looks at the border some metres ahead, judges it roughly, reacts late and moves the wheel
only when it seems worth it, on a tractor that turns tighter than a trailer can follow. Where a corner is too sharp, or
a pole is in the way, the recording is paused for a manoeuvre. So the lines wave, hold the receiver's noise and have
kinks. The same seed gives the same lines. Run: python examples/record_field.py [FOLDER [SEED]]
"""

import cmath
import math
import random
import sys
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

FOLDER, SEED = Path(__file__).parent, 8
ORIGIN = "50.8642,4.6781"  # degrees: where the metres count from
STEP, FIX_INTERVAL = 0.02, 0.1  # s, of the simulation and of the receiver
WHEELBASE, LOCK, WHEEL_RATE, WHEEL_LAG = 1.4, math.radians(35.0), math.radians(25.0), 0.3  # m, rad, rad/s, s
SPEED = 1.5  # m/s on a straight; slower while the wheels are turned
CRAB, CRAB_TIME = math.radians(0.4), 5.0  # rad, s: how the tractor drifts sideways
GAZE, REACTION, GLANCE = 4.0, 0.4, 0.6  # m ahead, s until the hands move, s between looks at the border
JUDGEMENT, INDIFFERENCE = math.radians(1.0), math.radians(1.0)  # rad: error of a look; change not worth a move
RESUMED = 0.1  # m: how far beside the border the recording begins again
NOISE, DRIFT, DRIFT_TIME = 0.008, 0.015, 60.0  # m, m, s: white and slow error of the receiver, each coordinate
SPACING, TAIL = 1.0, 15  # m between points; points by which AgOpenGPS extends a curve, straight, at either end

Leg = tuple[complex, ...]
"""corners of the border that one recording without a pause follows, east + north j, m"""
CURVES: tuple[tuple[Leg, ...], ...] = (
    (  # the headland along the hedge, past a pole, around two sharp corners and one that can be steered
        (-60 + 6j, -22 + 0j, -6 + 1.5j),
        (1 + 2.5j, 30 + 6j, 72 - 4j),
        (72 - 4j, 92 + 32j, 84 + 68j),
        (84 + 68j, 30 + 84j, 6 + 68j, -40 + 62j),
    ),
    ((-58 + 24j, -30 + 20j, 0 + 27j, 32 + 25j, 60 + 34j),),  # along the brook
)
AB_LINE = (-40 + 12j, 45 + 8.5j)


def ahead(leg: Leg, position: complex) -> complex:
    """Return the point GAZE ahead of the one closest to the position; the leg goes on straight beyond its end."""
    sides = list(pairwise(leg))
    shares = [min(max(((position - a) / (b - a)).real, 0.0), 1.0) for a, b in sides]
    feet = [a + share * (b - a) for (a, b), share in zip(sides, shares, strict=True)]
    nearest = min(range(len(feet)), key=lambda i: abs(feet[i] - position))
    point, left = feet[nearest], GAZE
    for corner in leg[nearest + 1 : -1]:
        if left <= abs(corner - point):
            return point + left * unit(corner - point)
        left -= abs(corner - point)
        point = corner
    return point + left * unit(leg[-1] - leg[-2])


def unit(direction: complex) -> complex:
    """Return a direction of length one."""
    return direction / abs(direction)


def drive(leg: Leg, chance: random.Random) -> Iterator[complex]:
    """Yield the true position (m) at every step, from the leg's beginning past its end."""
    first, last = unit(leg[1] - leg[0]), unit(leg[-1] - leg[-2])
    position, yaw = leg[0] + RESUMED * 1j * first * chance.uniform(-1.0, 1.0), cmath.phase(first)
    steering = wanted = decided = crab = time = looks_at = moves_at = 0.0
    while ((position - leg[-1]) / last).real < 0.0:
        if time >= looks_at:
            aim = ahead(leg, position) - position
            bearing = cmath.phase(aim * cmath.exp(-1j * yaw)) + chance.gauss(0.0, JUDGEMENT)
            seen = math.atan(2.0 * WHEELBASE * math.sin(bearing) / abs(aim))
            if abs(seen - decided) > INDIFFERENCE:
                decided, moves_at = seen, time + REACTION
            looks_at = time + GLANCE * chance.uniform(0.7, 1.3)
        if time >= moves_at:
            wanted = min(max(decided, -LOCK), LOCK)
        steering += STEP * min(max((wanted - steering) / WHEEL_LAG, -WHEEL_RATE), WHEEL_RATE)
        crab = wandered(crab, CRAB, STEP / CRAB_TIME, chance)
        way = STEP * SPEED / (1.0 + 2.0 * abs(steering))
        position += way * cmath.exp(1j * (yaw + crab))
        yaw += way * math.tan(steering) / WHEELBASE
        time += STEP
        yield position


def wandered(value: float, deviation: float, share: float, chance: random.Random) -> float:
    """Return what a slow error of this standard deviation becomes after a share of its time constant."""
    return (1.0 - share) * value + deviation * math.sqrt(2.0 * share) * chance.gauss(0.0, 1.0)


def recorded(legs: Sequence[Leg], chance: random.Random) -> list[complex]:
    """Return the points that AgOpenGPS records of a drive, m."""
    points: list[complex] = []
    east, north = chance.gauss(0.0, DRIFT), chance.gauss(0.0, DRIFT)
    for leg in legs:
        for position in list(drive(leg, chance))[:: round(FIX_INTERVAL / STEP)]:
            east, north = (wandered(each, DRIFT, FIX_INTERVAL / DRIFT_TIME, chance) for each in (east, north))
            fix = position + complex(east + chance.gauss(0.0, NOISE), north + chance.gauss(0.0, NOISE))
            if not points or abs(fix - points[-1]) >= SPACING:
                points.append(fix)
    return points


def heading(direction: complex) -> float:
    """Return a direction as AgOpenGPS counts it: clockwise from north, 0 .. 2 pi, rad."""
    return (0.5 * math.pi - cmath.phase(direction)) % (2.0 * math.pi)


def pair(point: complex) -> str:
    """Return a point as AgOpenGPS writes it: east, north to the millimetre."""
    return f"{round(point.real, 3)},{round(point.imag, 3)}"


def head(kind: str, mean: float, ends: Sequence[complex], mode: int, count: int) -> list[str]:
    """Return the rows above a line's points: name, mean heading (rad), A, B, nudge, mode, visible, number of points."""
    return [f"{kind} {math.degrees(mean):.1f}°", repr(mean), *map(pair, ends), "0", str(mode), "True", str(count)]


def curve(points: list[complex]) -> list[str]:
    """Return the rows of a curve through the points, extended at both ends."""
    ways = [unit(b - a) for a, b in pairwise(points)]
    extended = [points[0] - (TAIL - i) * ways[0] for i in range(TAIL)] + points
    extended += [points[-1] + (i + 1) * ways[-1] for i in range(TAIL)]
    headings = [heading(way) for way in (*[ways[0]] * TAIL, *ways, *[ways[-1]] * (TAIL + 1))]
    rows = [f"{pair(point)},{round(each, 5)}" for point, each in zip(extended, headings, strict=True)]
    return [*head("Cu", heading(sum(ways)), (points[0], points[-1]), 4, len(rows)), *rows]


def written(file: Path, rows: Sequence[str]) -> None:
    """Write a text file with the same bytes on every system."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("\n".join(rows) + "\n", "utf-8", newline="\n")


def write_lines(folder: Path, seed: int) -> None:
    """Drive all lines; write the folder of the field, and the last curve as a CSV file beside it."""
    chance = random.Random(seed)
    drives = [recorded(legs, chance) for legs in CURVES]
    tracks = [*map(curve, drives), head("AB", heading(AB_LINE[1] - AB_LINE[0]), AB_LINE, 2, 0)]
    written(folder / "field" / "TrackLines.txt", ["$TrackLines", *(row for track in tracks for row in track)])
    made = ["2025-March-01 10:00:00 AM", "$FieldDir", "Driven by hand, in simulation"]
    written(folder / "field" / "Field.txt", [*made, "$Offsets", "0,0", "Convergence", "0", "StartFix", ORIGIN])
    written(folder / "brook.csv", ["x,y", *map(pair, drives[-1])])


if __name__ == "__main__":
    given = sys.argv[1:]
    write_lines(Path(given[0]) if given else FOLDER, int(given[1]) if given[1:] else SEED)
