"""What sensors report on uneven ground and late: antennas as points in space, attitude, ages, float."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from drawbar.machine.events import GpsFloat
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.machine.simulated import SimulatedMachine
from drawbar.signals import Command, FixQuality, Measurement, Truth
from drawbar.vehicle.parameters import Mast, Masts, VehicleParameters

Build = Callable[..., SimulatedMachine]
SLOPE = 0.08


def changed(settings: SimulatedMachineSettings, **sections: Mapping[str, Any]) -> SimulatedMachineSettings:
    return SimulatedMachineSettings.model_validate(settings.model_dump() | sections)


def drive(machine: SimulatedMachine, samples: int) -> list[tuple[Measurement, Truth]]:
    run = []
    for k in range(samples):
        run.append((machine.read(), machine.truth()))
        steering = 0.3 * math.sin(0.1 * k)
        machine.write(Command(time=0.2 * k, tractor_steering=steering, trailer_steering=0.0, speed=1.0))
    return run


def test_mast_leans_downhill(build: Build, ideal: SimulatedMachineSettings) -> None:
    vehicle = VehicleParameters(masts=Masts(tractor=Mast(up=2.5), trailer=Mast(up=2.0)))
    settings = changed(ideal, terrain={"slope": SLOPE, "downhill": -0.5 * math.pi})
    for measurement, truth in drive(build(settings, vehicle=vehicle), 60):
        assert measurement.tractor_y - truth.tractor.y == pytest.approx(-2.5 * math.sin(SLOPE), abs=5e-3)
        assert measurement.tractor_x - truth.tractor.x == pytest.approx(0.0, abs=5e-3)
        assert measurement.trailer_y - truth.trailer.y == pytest.approx(-2.0 * math.sin(SLOPE), abs=2e-2)


def test_slope_creeps_downhill(build: Build, ideal: SimulatedMachineSettings) -> None:
    settings = changed(ideal, terrain={"slope": SLOPE, "downhill": -0.5 * math.pi, "creep": 0.5})
    machine = build(settings)
    machine.read()
    for k in range(30):
        machine.write(Command(time=0.2 * k, tractor_steering=0.0, trailer_steering=0.0, speed=1.0))
        machine.read()
    truth = machine.truth()
    assert truth.tractor_crab == pytest.approx(-0.5 * SLOPE)
    assert truth.tractor.y == pytest.approx(-math.tan(0.5 * SLOPE) * truth.tractor.x, rel=1e-3)
    assert truth.tractor.yaw == pytest.approx(0.0, abs=1e-9)  # all axles slide alike


def test_attitude_sensor_reports_what_is_true_but_for_its_errors(build: Build, ideal: SimulatedMachineSettings) -> None:
    sensors = {"tractor": {"present": True, "noise": 0.01, "roll_bias": 0.03, "yaw_rate_noise": 0.0}}
    settings = changed(ideal, terrain={"slope": SLOPE, "unevenness": 0.03}, attitude=sensors)
    run = drive(build(settings), 300)
    roll, pitch = (
        np.array([getattr(m, f"tractor_{name}") - getattr(t, f"tractor_{name}") for m, t in run])
        for name in ("roll", "pitch")
    )
    assert roll.mean() == pytest.approx(0.03, abs=0.003)
    assert pitch.mean() == pytest.approx(0.0, abs=0.003)
    assert (roll.std(), pitch.std()) == pytest.approx((0.01, 0.01), rel=0.15)
    measurement, truth = run[100]
    rate = (run[101][1].tractor.yaw - run[99][1].tractor.yaw) / 0.4
    assert measurement.tractor_yaw_rate == pytest.approx(rate, abs=0.01)
    assert math.isnan(measurement.trailer_roll)
    assert truth.tractor_roll != 0.0


@pytest.mark.parametrize("reported", [True, False])
def test_late_sensors_report_the_past(build: Build, ideal: SimulatedMachineSettings, reported: bool) -> None:
    latency, later = {"latency": 0.4}, {"latency": 0.2}
    late = {"fix": latency, "hitch_angle": later, "steering": later, "speed": latency, "reported": reported}
    machine = build(changed(ideal, delays=late))
    run = drive(machine, 60)
    for k in range(10, 60):
        now, (_, two_ago), (_, one_ago) = run[k][0], run[k - 2], run[k - 1]
        assert (now.tractor_x, now.tractor_y) == pytest.approx((two_ago.tractor.x, two_ago.tractor.y), abs=1e-9)
        assert now.trailer_x == pytest.approx(two_ago.trailer.x, abs=1e-9)
        assert now.speed == pytest.approx(two_ago.speed)
        assert now.tractor_steering == pytest.approx(one_ago.tractor_steering, abs=1e-9)
        beta = one_ago.tractor.yaw - one_ago.trailer.yaw - one_ago.trailer_steering
        assert now.hitch_angle == pytest.approx(beta, abs=1e-9)
        assert (now.trailer_fix_age, now.hitch_angle_age) == pytest.approx((0.4, 0.2) if reported else (0.0, 0.0))


def test_jitter_spreads_the_ages(build: Build, ideal: SimulatedMachineSettings) -> None:
    machine = build(changed(ideal, delays={"fix": {"latency": 0.2, "jitter": 0.05}}))
    ages = [measurement.tractor_fix_age for measurement, _ in drive(machine, 300)]
    assert (np.mean(ages), np.std(ages)) == pytest.approx((0.2, 0.05), rel=0.1)
    assert min(ages) >= 0.0


@pytest.mark.parametrize("honest", [True, False])
def test_float_is_noisy_and_says_so_where_it_is_honest(
    build: Build, ideal: SimulatedMachineSettings, honest: bool
) -> None:
    event = GpsFloat(start=10.0, duration=40.0, antenna="tractor", deviation=0.3, correlation=1.0, honest=honest)
    run = drive(build(ideal.model_copy(update={"events": (event,)})), 300)
    errors = np.array([m.tractor_x - t.tractor.x for m, t in run])
    inside = slice(50, 250)
    assert errors[inside].std() == pytest.approx(0.3, rel=0.4)
    assert np.corrcoef(errors[50:249], errors[51:250])[0, 1] == pytest.approx(math.exp(-0.2), abs=0.1)
    assert not errors[:50].any()
    assert not errors[250:].any()
    qualities = {m.tractor_fix_quality for m, _ in run[inside]}
    assert qualities == {FixQuality.FLOAT if honest else FixQuality.UNKNOWN}
    assert run[100][0].tractor_fix_deviation == pytest.approx(0.3 if honest else math.nan, nan_ok=True)
    assert all(m.trailer_x == t.trailer.x for m, t in run)


def test_what_is_new_leaves_the_noise_that_was_there(build: Build) -> None:
    plain, changed_ones = SimulatedMachineSettings(), {"attitude": {"tractor": {"present": True}}}
    alike = changed(plain, **changed_ones, bodies={"tractor_track": 2.0}, delays={"attitude": {"jitter": 0.1}})
    for (one, _), (other, _) in zip(drive(build(plain), 200), drive(build(alike), 200), strict=True):
        assert (one.tractor_x, one.trailer_y, one.speed) == (other.tractor_x, other.trailer_y, other.speed)
