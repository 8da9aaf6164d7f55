"""Calibrations by moving, on a simulated valve whose truth is known; and every runaway ends with off."""

import math
import re
from collections.abc import Callable

import numpy as np
import pytest

from drawbar.benchmark.simulated_actuators import SimulatedValve
from drawbar.machine.calibration.calibrated import Calibrated
from drawbar.machine.calibration.plans import DeadBandPlan, RatePlan
from drawbar.machine.calibration.pushing import (
    CalibratedMachine,
    Calibration,
    CalibrationLimits,
    Sensed,
    State,
    carry_out,
)
from drawbar.machine.calibration.valve import actuator_dynamics, dead_band
from drawbar.machine.low_level.settings import ValveSettings

PERIOD = 0.02
STEP = math.radians(0.02)
"""of the simulated sensor"""


class Bench(CalibratedMachine):
    """A simulated valve on a rolling vehicle, with a noisy sensor and, from some time on, a fault."""

    def __init__(
        self,
        valve: ValveSettings,
        *,
        full_rate: float = math.radians(25.0),
        direction: int = 1,
        seed: int = 0,
        noise: float = math.radians(0.02),
    ) -> None:
        self.valve = SimulatedValve(valve, full_rate=full_rate, stop=math.radians(35.0), dead_time=0.04)
        self.direction, self.noise, self.rng = direction, noise, np.random.default_rng(seed)
        self.time, self.driven, self.offs, self.speed, self.permitted = 0.0, 0.0, 0, 0.6, True
        self.from_time, self.drive_fault, self.angle_fault = math.inf, lambda drive: drive, lambda angle: angle
        self.knows_yaw = True
        self.drives: list[float] = []

    def sense(self) -> Sensed:
        faulty = self.time >= self.from_time
        self.drives.append(self.driven)
        self.valve.advance(self.drive_fault(self.driven) if faulty else self.driven, PERIOD)
        self.time += PERIOD
        angle = self.direction * self.valve.angle + self.noise * self.rng.standard_normal()
        angle = STEP * round(angle / STEP)
        by_yaw = self.direction * self.valve.angle + math.radians(0.5) * self.rng.standard_normal()
        return Sensed(
            time=self.time,
            angle=self.angle_fault(angle) if faulty else angle,
            speed=self.speed,
            permitted=self.permitted,
            by_yaw=by_yaw if self.knows_yaw else math.nan,
        )

    def drive(self, drive: float) -> None:
        self.driven = drive

    def off(self) -> None:
        self.driven, self.offs = 0.0, self.offs + 1


TRUTHS = [
    (ValveSettings(dead_band_left=0.15, dead_band_right=0.15), math.radians(25.0), 1),
    (ValveSettings(dead_band_left=0.08, dead_band_right=0.22, slope_right=0.8), math.radians(20.0), -1),
    (ValveSettings(dead_band_left=0.25, dead_band_right=0.2, slope_right=1.2, lag=0.2), math.radians(15.0), 1),
    (ValveSettings(dead_band_left=0.02, dead_band_right=0.05, lag=0.05), math.radians(30.0), -1),
]


@pytest.mark.parametrize("truth", TRUTHS)
@pytest.mark.parametrize("seed", [0, 1])
def test_dead_bands_and_direction_are_found_within_the_stated_deviation(
    truth: tuple[ValveSettings, float, int], seed: int
) -> None:
    valve, rate, direction = truth
    plan, bench = DeadBandPlan(), Bench(valve, full_rate=rate, direction=direction, seed=seed)
    done = carry_out(Calibration(plan), bench)
    assert (done.state, done.reason) == (State.DONE, "")
    assert done.direction == direction
    assert bench.driven == 0.0
    for sign, true in ((1, valve.dead_band_left), (-1, valve.dead_band_right)):
        found = dead_band(plan.runs[sign])
        assert found.accepted, found.refusals
        assert found.deviation < 0.02
        assert abs(found.value - true) <= 3.0 * found.deviation + 0.002


@pytest.mark.parametrize("truth", TRUTHS[:3])
def test_full_rate_lag_and_dead_time_are_found_within_the_stated_deviation(
    truth: tuple[ValveSettings, float, int],
) -> None:
    valve, rate, direction = truth
    plan, bench = RatePlan(), Bench(valve, full_rate=rate, direction=direction)
    done = carry_out(Calibration(plan, CalibrationLimits(time=60.0)), bench)
    assert (done.state, done.reason) == (State.DONE, "")
    for sign, band, true in (
        (1, valve.dead_band_left, rate),
        (-1, valve.dead_band_right, rate * valve.slope_right),
    ):
        pushes = [
            type(push)(drive=push.drive, duration=push.duration, times=push.times, angles=direction * push.angles)
            for push in plan.records[sign]
        ]
        found = actuator_dynamics(pushes, dead_band=band)
        for value, truth_ in ((found.size, true), (found.lag, valve.lag), (found.dead_time, 0.04)):
            assert value.accepted, value.refusals
            # a report stands for the 20 ms before it: the dead time is known to one of them
            assert abs(value.value - truth_) <= 3.0 * value.deviation + (0.02 if value.unit == "s" else 0.03 * truth_)


def jump(bench: Bench) -> None:
    bench.drive_fault = lambda drive: 1.0


def creep(bench: Bench) -> None:
    bench.drive_fault = lambda drive: drive if drive else 0.3


def reverse(bench: Bench) -> None:
    bench.drive_fault = lambda drive: -2.0 * drive


def stick(bench: Bench) -> None:
    kept: list[float] = []

    def stuck(angle: float) -> float:
        kept.append(angle)
        return kept[0]

    bench.angle_fault = stuck


def swap(bench: Bench) -> None:
    bench.angle_fault = lambda angle: -angle


def lose(bench: Bench) -> None:
    bench.angle_fault = lambda angle: math.nan


def stand(bench: Bench) -> None:
    bench.speed = 0.1


def race(bench: Bench) -> None:
    bench.speed = 1.6


def release(bench: Bench) -> None:
    bench.permitted = False


FAULTS = {
    "valve sticks open": (jump, "runaway"),
    "valve leaks": (creep, "runaway"),
    "valve turns round": (reverse, "runaway"),
    "sensor sticks": (stick, "runaway|no feedback"),
    "sensor turns round": (swap, "runaway"),
    "sensor lost": (lose, "sensor reports nothing"),
}
WITHIN = math.radians(9.0)
"""of where it began, a runaway has ended: travel, and what a fully open valve turns before it is shut"""


@pytest.mark.parametrize("name", FAULTS)
@pytest.mark.parametrize("after", [0.1, 5.0, 16.0, 17.3, 30.5, 34.0])
def test_a_runaway_is_off_within_nine_degrees(name: str, after: float) -> None:
    fault, reason = FAULTS[name]
    plan, bench = DeadBandPlan(), Bench(ValveSettings())
    bench.from_time = after
    fault(bench)
    done = carry_out(Calibration(plan, direction=1), bench)
    assert done.state is State.ABORTED
    assert re.search(reason, done.reason), done.reason
    assert bench.driven == 0.0
    assert bench.offs > 0
    assert abs(bench.valve.angle) <= WITHIN


@pytest.mark.parametrize(("fault", "words"), [(stand, "standing tyres"), (race, "m/s"), (release, "operator")])
def test_the_vehicle_or_the_operator_end_it_at_once(fault: Callable[[Bench], None], words: str) -> None:
    bench = Bench(ValveSettings())
    calibration = Calibration(DeadBandPlan())
    for _ in range(900):
        bench.drive(calibration.tick(bench.sense()))
    fault(bench)
    assert calibration.tick(bench.sense()) == 0.0
    assert calibration.state is State.ABORTED
    assert words in calibration.reason
    # and nothing brings it back
    bench.speed, bench.permitted = 0.6, True
    assert {calibration.tick(bench.sense()) for _ in range(100)} == {0.0}


@pytest.mark.parametrize("time", [0.3, 0.0, -1.0, math.nan])
def test_a_silent_or_a_wrong_clock_ends_it(time: float) -> None:
    calibration = Calibration(DeadBandPlan())
    sensed = Sensed(time=0.0, angle=0.0, speed=0.6, permitted=True)
    calibration.tick(sensed)
    assert calibration.tick(Sensed(time=time, angle=0.0, speed=0.6, permitted=True)) == 0.0
    assert calibration.state is State.ABORTED


def test_a_valve_without_power_is_no_feedback_and_the_drive_stays_bounded() -> None:
    bench = Bench(ValveSettings())
    bench.from_time, bench.drive_fault = 0.0, lambda drive: 0.0
    done = carry_out(Calibration(DeadBandPlan(largest=0.3)), bench)
    assert done.state is State.ABORTED
    assert "no feedback" in done.reason
    assert max(map(abs, bench.drives)) == pytest.approx(0.3)


def test_without_a_yaw_rate_nothing_is_pushed() -> None:
    bench = Bench(ValveSettings())
    bench.knows_yaw = False
    done = carry_out(Calibration(DeadBandPlan()), bench)
    assert done.state is State.ABORTED
    assert "yaw rate is unknown" in done.reason
    assert set(bench.drives) == {0.0}


def test_a_plan_beyond_the_limits_is_not_driven() -> None:
    bench = Bench(ValveSettings())
    done = carry_out(Calibration(RatePlan(drives=(0.7, 0.7))), bench)
    assert done.state is State.ABORTED
    assert "70%" in done.reason
    assert set(bench.drives) == {0.0}


def test_a_device_that_raises_is_switched_off() -> None:
    class Broken(Bench):
        def sense(self) -> Sensed:
            if self.time > 18.0:
                raise OSError("gone")
            return super().sense()

    bench = Broken(ValveSettings())
    with pytest.raises(OSError, match="gone"):
        carry_out(Calibration(DeadBandPlan()), bench)
    assert bench.driven == 0.0


def test_dead_bands_that_disagree_or_are_too_few_are_refused() -> None:
    plan, bench = DeadBandPlan(runs=2), Bench(ValveSettings())
    carry_out(Calibration(plan), bench)
    assert "runs that moved: 2, needed: 3" in dead_band(plan.runs[1]).refusals[0]
    assert not dead_band([]).accepted
    other, wide = DeadBandPlan(runs=1), Bench(ValveSettings(dead_band_left=0.3))
    carry_out(Calibration(other), wide)
    assert "differ" in dead_band([*plan.runs[1], *other.runs[1]]).refusals[0]


@pytest.mark.parametrize(
    ("value", "deviation", "told"),
    [
        (0.148361, 0.00221, "0.1484 ± 0.0022"),
        (1.3e-10, 0.0073, "0.0000 ± 0.0073"),
        (104.37, 12.6, "104 ± 13"),
        (1.0, 0.0, "1 ± 0"),
        (2.5, math.inf, "2.5 ± inf"),
    ],
)
def test_a_number_is_reported_as_far_as_it_is_known(value: float, deviation: float, told: str) -> None:
    found = Calibrated(value=value, deviation=deviation, unit="")
    assert found.text == told
