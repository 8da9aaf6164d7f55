"""Actuation by a valve and by a hydrostat under the low level, in closed loop: `python -m drawbar.benchmark.actuation`.

The simulated valve has a dead band of ± 15 %, 25 °/s at full drive, a lag of 0.1 s and a dead time of 40 ms; its loop
runs at 50 Hz. The hydrostat's pedal needs 1.25 s for its stroke, the vehicle follows with 0.8 s to 3 m/s at full pedal,
the encoder resolves 2 cm/s, the loop runs at 20 Hz; after 8 s a hill takes 0.4 m/s. The loops are drawbar_actuate.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from drawbar.benchmark.simulated_actuators import SimulatedHydrostat, SimulatedValve
from drawbar.geometry import Floats
from drawbar.machine.low_level.low_level import ActuateInput, LowLevel, SpeedAxis, SteeringAxis, TableSensor
from drawbar.machine.low_level.settings import PositionLoopSettings, SpeedLoopSettings, ValveSettings
from drawbar.machine.settings import HydrostatSettings

_RATE = math.radians(25.0)
_STOP = math.radians(40.0)
_PERIOD, _SPEED_PERIOD = 0.02, 0.05
"""of both loops, s"""
_DURATION, _SPEED_DURATION = 3.0, 20.0
"""of a step, s"""
_DEAD_TIME = 0.04
_VALVE = ValveSettings()
_HYDROSTAT = HydrostatSettings(full_speed=3.0, speed_lag=0.8, pedal_rate=0.8, pedal_lag=0.05)
_FINE = 1e-4
"""resolution of a sensor that resolves everything"""
_HILL = 0.4
_HILL_FROM = 8.0
_WANTED = 1.5
_IMMEDIATE = 1e5
"""m/s², a ramp that is a step"""


@dataclass(frozen=True, slots=True, kw_only=True)
class AngleCase:
    """One row of the table of the angle loop."""

    name: str
    loop: dict[str, float]
    """what differs from P 3 without any dead-band compensation or stop zone"""
    resolution: float = math.radians(0.01)
    """of the sensor, rad"""
    amplitude: float = math.radians(10.0)
    """of the step, rad"""


@dataclass(frozen=True, slots=True, kw_only=True)
class AngleFigures:
    """How a loop fared after a step."""

    t90: float
    """until the angle first reached 90 % of the step, s"""
    overshoot: float
    """rad"""
    rest: float
    """error between 2 and 3 s after the step, its mean, rad"""
    swing: float
    """half of what the angle varies in that time, rad"""
    reversals: int
    """of the drive's sign, in the 3 s after the step"""
    angles: Floats = field(repr=False)


ANGLE_CASES = (
    AngleCase(name="P 3, no dead-band compensation", loop={}),
    AngleCase(name="P 3, 100 %", loop={"compensation": 1.0}),
    AngleCase(name="P 5, 100 %", loop={"compensation": 1.0, "proportional": 5.0}),
    AngleCase(name="P 8, 100 %", loop={"compensation": 1.0, "proportional": 8.0}),
    AngleCase(name="PI 3, 1, 100 %", loop={"compensation": 1.0, "integral": 1.0}),
    AngleCase(name="**P 3, 80 %, stop zone 0.15°**", loop={"compensation": 0.8, "stop_zone": math.radians(0.15)}),
    AngleCase(
        name="P 3, 100 % of a dead band believed to be 18 %",
        loop={"compensation": 1.0, "dead_band_left": 0.18, "dead_band_right": 0.18},
    ),
    AngleCase(name="P 3, 100 %, sensor 1° steps", loop={"compensation": 1.0}, resolution=math.radians(1.0)),
    AngleCase(
        name="PI 3, 0.5, 100 %, sensor 1° steps",
        loop={"compensation": 1.0, "integral": 0.5},
        resolution=math.radians(1.0),
    ),
    AngleCase(
        name="P 3, 80 %, stop zone 0.15°, sensor 1° steps",
        loop={"compensation": 0.8, "stop_zone": math.radians(0.15)},
        resolution=math.radians(1.0),
    ),
    AngleCase(
        name="P 3, 80 %, stop zone 0.15°, step of 1°",
        loop={"compensation": 0.8, "stop_zone": math.radians(0.15)},
        amplitude=math.radians(1.0),
    ),
)


def drive_angle(case: AngleCase) -> AngleFigures:
    """Return how a loop follows a step."""
    loop = PositionLoopSettings(**({"compensation": 0.0, "stop_zone": 0.0} | case.loop))
    low_level = LowLevel(front=SteeringAxis(sensor=_sensor(case.resolution), loop=loop, limit=_STOP))
    valve = SimulatedValve(_VALVE, full_rate=_RATE, stop=_STOP, dead_time=_DEAD_TIME)
    angles, drives = [valve.angle], []
    for i in range(round(_DURATION / _PERIOD)):
        given = ActuateInput(
            time=_PERIOD * i,
            measured_speed=1.0,
            counts=(round(valve.angle / case.resolution), 0.0, 0.0),
            steering=(case.amplitude, 0.0),
            steer=(True, False),
        )
        drives.append(low_level.step(given).drives[0])
        valve.advance(drives[-1], _PERIOD)
        angles.append(valve.angle)
    return _angle_figures(np.array(angles), drives, case.amplitude)


def _angle_figures(angles: Floats, drives: Sequence[float], amplitude: float) -> AngleFigures:
    last = angles[round(2.0 / _PERIOD) :]
    signs = [math.copysign(1.0, drive) for drive in drives if drive]
    return AngleFigures(
        t90=_PERIOD * int(np.argmax(angles >= 0.9 * amplitude)) if angles.max() >= 0.9 * amplitude else math.nan,
        overshoot=max(0.0, float(angles.max()) - amplitude),
        rest=amplitude - float(last.mean()),
        swing=float(np.ptp(last)) / 2.0,
        reversals=sum(before != after for before, after in pairwise(signs)),
        angles=angles,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedCase:
    """One row of the table of the speed cascade."""

    proportional: float
    integral: float
    acceleration: float = 0.5
    """of the ramp, m/s²"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedFigures:
    """How the cascade fared."""

    overshoot: float
    """as a share of the set point, before the hill"""
    dip: float
    """on the hill, m/s"""
    back: float
    """until the error stays within 5 % after the hill begins, s"""
    speeds: Floats = field(repr=False)


SPEED_CASES = (
    SpeedCase(proportional=0.3, integral=0.4, acceleration=_IMMEDIATE),
    SpeedCase(proportional=0.3, integral=0.4),
    SpeedCase(proportional=1.0, integral=0.5),
    SpeedCase(proportional=0.1, integral=0.1),
)


def drive_speed(case: SpeedCase) -> SpeedFigures:
    """Return how a cascade reaches 1.5 m/s from rest, and holds it on a hill."""
    low_level = LowLevel(pedal=_speed_axis(case))
    hydrostat = SimulatedHydrostat(_HYDROSTAT, dead_time=0.0)
    speeds = [hydrostat.speed]
    for i in range(round(_SPEED_DURATION / _SPEED_PERIOD)):
        given = ActuateInput(
            time=_SPEED_PERIOD * i,
            measured_speed=0.02 * round(hydrostat.speed / 0.02),
            counts=(0.0, 0.0, hydrostat.pedal / _FINE),
            speed=_WANTED,
            drive=True,
        )
        drive = low_level.step(given).drives[2]
        hydrostat.advance(drive, _HILL if _SPEED_PERIOD * i >= _HILL_FROM else 0.0, _SPEED_PERIOD)
        speeds.append(hydrostat.speed)
    return _speed_figures(np.array(speeds))


def _speed_axis(case: SpeedCase) -> SpeedAxis:
    pedal = PositionLoopSettings(
        proportional=6.0,
        stop_zone=0.0,
        dead_band_left=0.0,
        dead_band_right=0.0,
        full_rate_left=_HYDROSTAT.pedal_rate,
        full_rate_right=_HYDROSTAT.pedal_rate,
    )
    speed = SpeedLoopSettings(
        proportional=case.proportional, integral=case.integral, acceleration=case.acceleration, patience=3.0
    )
    return SpeedAxis(sensor=_sensor(_FINE), loop=pedal, speed=speed, full_speed=_HYDROSTAT.full_speed)


def _speed_figures(speeds: Floats) -> SpeedFigures:
    hill = round(_HILL_FROM / _SPEED_PERIOD)
    outside = np.flatnonzero(np.abs(speeds[hill:] - _WANTED) > 0.05 * _WANTED)
    return SpeedFigures(
        overshoot=max(0.0, float(speeds[:hill].max()) / _WANTED - 1.0),
        dip=_WANTED - float(speeds[hill : hill + round(5.0 / _SPEED_PERIOD)].min()),
        back=_SPEED_PERIOD * (int(outside[-1]) + 1) if len(outside) else 0.0,
        speeds=speeds,
    )


def _sensor(resolution: float) -> TableSensor:
    counts = (-1.2 / resolution, 1.2 / resolution)
    return TableSensor(counts=counts, values=(-1.2, 1.2), lowest=counts[0], highest=counts[1])


def angle_table() -> str:
    """Return the figures of the angle loop as a Markdown table."""
    rows = [["law", "t90, s", "overshoot, °", "rest error, °", "swing, °", "reversals in 3 s"]]
    for case in ANGLE_CASES:
        made = drive_angle(case)
        degrees = [f"{math.degrees(value):z.2f}" for value in (made.overshoot, made.rest, made.swing)]
        t90 = f"{made.t90:.2f}" if math.isfinite(made.t90) else "never"
        rows.append([case.name, t90, *degrees, str(made.reversals)])
    return _table(rows)


def speed_table() -> str:
    """Return the figures of the speed cascade as a Markdown table."""
    rows = [["kp, ki", "reference", "overshoot, %", "dip on the hill, m/s", "back within 5 %, s"]]
    for case in SPEED_CASES:
        made = drive_speed(case)
        reference = "step" if case.acceleration == _IMMEDIATE else f"ramp {case.acceleration} m/s²"
        gains = f"{case.proportional}, {case.integral}"
        rows.append([gains, reference, f"{100.0 * made.overshoot:.0f}", f"{made.dip:.2f}", f"{made.back:.1f}"])
    return _table(rows)


def _table(rows: Sequence[Sequence[Any]]) -> str:
    head, *body = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join((head, "|---" * len(rows[0]) + "|", *body, ""))


def main() -> None:
    """Print both tables."""
    print(angle_table())
    print(speed_table())


if __name__ == "__main__":
    main()
