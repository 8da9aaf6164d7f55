"""The whole simulated machine: its interface, its sensors, its symmetries, its events and its refusals."""

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest

from drawbar.errors import ConfigurationError, HardwareError
from drawbar.machine.events import Bump, Event, GpsJump, GpsLoss, SideSlope, SlipStep
from drawbar.machine.sensor_settings import SensorSettings
from drawbar.machine.settings import CrabProcess, GroundSettings, LengthFactors, SimulatedMachineSettings
from drawbar.machine.simulated import SimulatedMachine
from drawbar.signals import Command, Measurement, Pose, Truth
from drawbar.vehicle.parameters import VehicleParameters

Build = Callable[..., SimulatedMachine]
Drive = Callable[..., list[Truth]]


def weave(machine: SimulatedMachine, samples: int, *, side: float = 1.0) -> list[tuple[Measurement, Truth]]:
    """Drive an open-loop weave; side = -1 steers its mirror image."""
    run = []
    for k in range(samples):
        run.append((machine.read(), machine.truth()))
        machine.write(
            Command(
                time=0.2 * k,
                tractor_steering=side * 0.3 * math.sin(0.1 * k),
                trailer_steering=side * 0.2 * math.cos(0.13 * k),
                speed=1.0,
            )
        )
    return run


def with_events(settings: SimulatedMachineSettings, *events: Event) -> SimulatedMachineSettings:
    return settings.model_copy(update={"events": events})


def test_starts_at_rest_and_straight(build: Build, ideal: SimulatedMachineSettings) -> None:
    yaw = 0.7
    truth = build(ideal, start=Pose(x=5.0, y=-3.0, yaw=yaw)).truth()
    behind = 1.1 + 1.3 - 0.25
    assert (truth.tractor, truth.speed, truth.time) == (Pose(x=5.0, y=-3.0, yaw=yaw), 0.0, 0.0)
    assert truth.trailer.x == pytest.approx(5.0 - behind * math.cos(yaw))
    assert truth.trailer.y == pytest.approx(-3.0 - behind * math.sin(yaw))
    assert (truth.trailer.yaw, truth.tractor_steering, truth.trailer_steering) == (yaw, 0.0, 0.0)


def test_each_reading_is_the_next_sample_and_a_command_acts_until_the_next(build: Build) -> None:
    machine, repeated = build(SimulatedMachineSettings()), build(SimulatedMachineSettings())
    command = Command(time=0.0, tractor_steering=0.2, trailer_steering=0.1, speed=1.0)
    machine.read()
    repeated.read()
    machine.write(command)
    for k in range(1, 20):
        repeated.write(command)
        assert machine.read() == repeated.read()
        assert machine.truth().time == pytest.approx(0.2 * k)


def test_a_stop_holds_the_steering_and_ends_the_motion(build: Build, ideal: SimulatedMachineSettings) -> None:
    machine = build(ideal)
    weave(machine, 30)
    for _ in range(2):  # again changes nothing
        machine.stop()
    for _ in range(40):
        machine.read()
    rest, steering = machine.truth(), 0.3 * math.sin(2.9)
    assert rest.speed == pytest.approx(0.0, abs=1e-3)
    assert rest.tractor_steering == pytest.approx(steering, abs=1e-6)


def test_a_context_ends_with_a_stop(build: Build, ideal: SimulatedMachineSettings) -> None:
    machine = build(ideal)
    with machine:
        weave(machine, 30)
    for _ in range(40):
        machine.read()
    assert machine.truth().speed == pytest.approx(0.0, abs=1e-3)


def test_ideal_sensors_report_the_truth(build: Build, ideal: SimulatedMachineSettings) -> None:
    for seen, true in weave(build(ideal), 100):
        beta = true.tractor.yaw - true.trailer.yaw - true.trailer_steering
        positions = (true.tractor.x, true.tractor.y, true.trailer.x, true.trailer.y)
        angles = (true.tractor_steering, true.trailer_steering)
        expected = (true.time, *positions, beta, true.speed, *angles)
        assert dataclasses.astuple(seen)[:9] == pytest.approx(expected, abs=1e-11)


def test_steering_readings_are_whole_degrees_nearest_the_truth(build: Build) -> None:
    degree = math.radians(1.0)
    for seen, true in weave(build(SimulatedMachineSettings()), 100):
        for reading, angle in (
            (seen.tractor_steering, true.tractor_steering),
            (seen.trailer_steering, true.trailer_steering),
        ):
            assert reading / degree == pytest.approx(round(reading / degree), abs=1e-12)
            assert abs(reading - angle) <= degree / 2.0 + 1e-12


def test_same_seed_is_the_identical_run_and_another_differs(build: Build) -> None:
    """200 samples span several blocks of random numbers."""
    settings = SimulatedMachineSettings()
    run = weave(build(settings, seed=7), 200)
    assert run == weave(build(settings, seed=7), 200)
    other = weave(build(settings, seed=8), 200)
    assert all(a[0] != b[0] for a, b in zip(run, other, strict=True))
    assert run[-1][1].tractor != other[-1][1].tractor


def test_reversed_joint_takes_the_command_the_other_way_and_reports_as_before(build: Build) -> None:
    settings = SimulatedMachineSettings()
    plain, reverse = build(settings), build(settings, vehicle=VehicleParameters(joint_sign=-1))
    for k in range(100):
        angle = 0.3 * math.sin(0.2 * k)
        for machine, sign in ((plain, 1.0), (reverse, -1.0)):
            machine.write(Command(time=0.2 * k, tractor_steering=0.1, trailer_steering=sign * angle, speed=1.0))
        assert reverse.read() == plain.read()
        assert reverse.truth() == plain.truth()


WRONG = [
    LengthFactors(wheelbase=1.1),
    LengthFactors(hitch_length=0.9),
    LengthFactors(drawbar_length=1.1),
    LengthFactors(trailer_length=0.9),
    LengthFactors(wheelbase=0.9, hitch_length=1.1, drawbar_length=0.9, trailer_length=1.1),
]


@pytest.mark.parametrize("factors", WRONG, ids=str)
def test_a_machine_of_other_lengths_than_stated_is_the_machine_that_has_them(
    build: Build, factors: LengthFactors
) -> None:
    stated, settings = VehicleParameters(), SimulatedMachineSettings()
    true = VehicleParameters(
        wheelbase=stated.wheelbase * factors.wheelbase,
        hitch_length=stated.hitch_length * factors.hitch_length,
        drawbar_length=stated.drawbar_length * factors.drawbar_length,
        trailer_length=stated.trailer_length * factors.trailer_length,
    )
    wrong = weave(build(settings.model_copy(update={"lengths": factors})), 50)
    assert wrong == weave(build(settings, vehicle=true), 50)
    assert wrong[-1][1].trailer != weave(build(settings), 50)[-1][1].trailer


@pytest.mark.parametrize(
    ("factors", "reason"),
    [
        (LengthFactors(trailer_length=0.1), "trailer_antenna = 0.25 m .* ahead of the actuated joint"),
        (LengthFactors(drawbar_length=20.0), "drawbar_length = 4.0 m puts the free joint ahead"),
    ],
)
def test_lengths_that_no_vehicle_has_are_refused(build: Build, factors: LengthFactors, reason: str) -> None:
    settings = SimulatedMachineSettings(lengths=factors)
    with pytest.raises(ConfigurationError, match=rf"machine\.lengths makes .*{reason}"):
        build(settings)


def mirrored(settings: SimulatedMachineSettings, side: float) -> SimulatedMachineSettings:
    ground = GroundSettings(
        longitudinal_slip=settings.ground.longitudinal_slip,
        tractor_slip=settings.ground.tractor_slip,
        steering_offset=side * 0.01,
        tractor_crab=CrabProcess(mean=side * 0.02, deviation=0.0),
        trailer_crab=CrabProcess(mean=side * -0.03, deviation=0.0),
    )
    events = (
        Bump(start=3.0, lateral=side * 0.05, tractor_yaw=side * 0.04, trailer_yaw=side * -0.03),
        SideSlope(start=6.0, crab=side * 0.05),
    )
    return settings.model_copy(update={"ground": ground, "events": events})


def test_mirrored_world_runs_mirrored(build: Build, ideal: SimulatedMachineSettings) -> None:
    left = weave(build(mirrored(ideal, 1.0), start=Pose(x=1.0, y=2.0, yaw=0.4)), 150)
    right = weave(build(mirrored(ideal, -1.0), start=Pose(x=1.0, y=-2.0, yaw=-0.4)), 150, side=-1.0)
    for (_, a), (_, b) in zip(left, right, strict=True):
        for one, two in ((a.tractor, b.tractor), (a.trailer, b.trailer)):
            assert (two.x, -two.y, -two.yaw) == pytest.approx((one.x, one.y, one.yaw), abs=1e-12)


def test_rotated_and_shifted_world_runs_alike(build: Build, ideal: SimulatedMachineSettings) -> None:
    """Also across yaw = ±pi, which must not be noticed."""
    turn = 3.0
    plain, turned = weave(build(ideal), 150), weave(build(ideal, start=Pose(x=9.0, y=4.0, yaw=turn)), 150)
    c, s = math.cos(turn), math.sin(turn)
    for (_, a), (_, b) in zip(plain, turned, strict=True):
        for one, two in ((a.tractor, b.tractor), (a.trailer, b.trailer)):
            expected = (9.0 + c * one.x - s * one.y, 4.0 + s * one.x + c * one.y, one.yaw + turn)
            assert (two.x, two.y, two.yaw) == pytest.approx(expected, abs=1e-9)


def test_the_world_does_not_depend_on_the_step(build: Build, ideal: SimulatedMachineSettings) -> None:
    """100 Hz against 1 kHz over 40 m: the kinks of the limits leave 0.02 mm."""
    fine = ideal.model_copy(update={"step": 0.001})
    (_, coarse_end), (_, fine_end) = weave(build(ideal), 200)[-1], weave(build(fine), 200)[-1]
    assert coarse_end.trailer.x == pytest.approx(fine_end.trailer.x, abs=5e-5)
    assert coarse_end.trailer.y == pytest.approx(fine_end.trailer.y, abs=5e-5)


def test_slips_act_as_they_are_reported(build: Build, drive: Drive, ideal: SimulatedMachineSettings) -> None:
    """Ground speed is mu times wheel speed; yaw rate follows kappa delta_t + b."""
    ground = ideal.ground.model_copy(update={"steering_offset": 0.02})
    events = (
        SlipStep(start=0.0, factor="longitudinal_slip", value=0.8),
        SlipStep(start=0.0, factor="tractor_slip", value=0.7),
    )
    machine = build(ideal.model_copy(update={"ground": ground, "events": events}))
    before, after = drive(machine, 301, tractor=0.2)[-2:]
    yaw_rate = 0.8 * after.speed * math.tan(0.7 * 0.2 + 0.02) / 1.4
    assert (after.tractor.yaw - before.tractor.yaw) / 0.2 == pytest.approx(yaw_rate, abs=1e-7)
    assert (after.longitudinal_slip, after.tractor_slip, after.steering_offset) == (0.8, 0.7, 0.02)


def test_side_slope_carries_the_machine_sideways_without_turning_it(
    build: Build, drive: Drive, ideal: SimulatedMachineSettings
) -> None:
    machine = build(with_events(ideal, SideSlope(start=0.2, crab=0.05)))
    before, after = drive(machine, 301)[-2:]
    forward = after.tractor.x - before.tractor.x
    assert after.tractor.y - before.tractor.y == pytest.approx(forward * math.tan(0.05), abs=1e-9)
    assert after.tractor.yaw == pytest.approx(0.0, abs=1e-12)
    assert after.trailer.yaw == pytest.approx(0.0, abs=1e-12)


def test_the_slide_tells_the_side_slips_in_all_headings(build: Build, ideal: SimulatedMachineSettings) -> None:
    terrain = ideal.terrain.model_copy(update={"slope": 0.09, "downhill": 2.0, "creep": 0.4})
    machine = build(ideal.model_copy(update={"terrain": terrain}))
    for _, truth in weave(machine, 100):
        tractor = machine.slide(truth.speed).across(truth.tractor.yaw, truth.speed, 0.3)  # no curve draws an axle
        trailer = machine.slide(truth.speed).across(truth.trailer.yaw, truth.speed, 0.3)
        assert (truth.tractor_crab, truth.trailer_crab) == pytest.approx((tractor, trailer), abs=5e-5)


def test_bump_displaces_at_rest_as_it_says(build: Build, drive: Drive, ideal: SimulatedMachineSettings) -> None:
    """At rest nothing else moves: left is +90° from yaw, the trailer swings about the free joint.

    14 s lie in the second block of random numbers, which must know its time.
    """
    yaw, kick, swing = 0.5, 0.04, -0.03
    bump = Bump(start=14.0, lateral=0.056, tractor_yaw=kick, trailer_yaw=swing)
    machine = build(with_events(ideal, bump), start=Pose(x=0.0, y=0.0, yaw=yaw))
    run = drive(machine, 71, speed=0.0)
    assert run[69] == dataclasses.replace(run[0], time=run[69].time)
    end = run[70]
    x, y = -0.056 * math.sin(yaw), 0.056 * math.cos(yaw)
    assert dataclasses.astuple(end.tractor) == pytest.approx((x, y, yaw + kick), abs=1e-15)
    back = 0.2 + 1.3 - 0.25
    x -= 0.9 * math.cos(yaw + kick) + back * math.cos(yaw + swing)
    y -= 0.9 * math.sin(yaw + kick) + back * math.sin(yaw + swing)
    assert dataclasses.astuple(end.trailer) == pytest.approx((x, y, yaw + swing), abs=1e-15)


def test_masked_loss_reports_nan_and_held_loss_the_last_fix(build: Build) -> None:
    settings = SimulatedMachineSettings()
    masked = with_events(settings, GpsLoss(start=2.0, duration=1.0))
    held = with_events(settings, GpsLoss(start=2.0, duration=1.0, antenna="trailer", report="held"))
    runs = [weave(build(s), 30) for s in (settings, masked, held)]
    last = runs[0][9][0]
    for k, ((calm, truth), (lost, truth_m), (stale, truth_h)) in enumerate(zip(*runs, strict=True)):
        assert truth == truth_m == truth_h, "a GPS event must not change the world or the draws"
        if 10 <= k < 15:
            missing = (lost.tractor_x, lost.tractor_y, lost.trailer_x, lost.trailer_y)
            assert np.isnan(missing).all()
            assert stale == dataclasses.replace(calm, trailer_x=last.trailer_x, trailer_y=last.trailer_y)
        else:
            assert calm == lost == stale


def test_jump_shifts_the_reported_position_only(build: Build) -> None:
    settings = SimulatedMachineSettings()
    jump = GpsJump(start=2.0, duration=1.0, antenna="tractor", east=0.4, north=-0.3)
    calm, jumped = weave(build(settings), 20), weave(build(with_events(settings, jump)), 20)
    for k, ((seen, truth), (false, same)) in enumerate(zip(calm, jumped, strict=True)):
        shift = (0.4, -0.3) if 10 <= k < 15 else (0.0, 0.0)
        assert truth == same
        assert false.tractor_x - seen.tractor_x == pytest.approx(shift[0], abs=1e-14)
        assert false.tractor_y - seen.tractor_y == pytest.approx(shift[1], abs=1e-14)
        assert (false.trailer_x, false.trailer_y) == (seen.trailer_x, seen.trailer_y)


def test_world_events_leave_the_draws_alone(build: Build) -> None:
    """Noise is what is reported minus what is true; a bump changes the truth but not the noise."""
    settings = SimulatedMachineSettings(sensors=SensorSettings(steering_resolution=1e-12))
    calm = weave(build(settings), 100)
    bumped = weave(build(with_events(settings, Bump(start=1.0, lateral=0.3, tractor_yaw=0.2))), 100)
    for (seen_a, true_a), (seen_b, true_b) in zip(calm, bumped, strict=True):
        assert seen_b.tractor_x - true_b.tractor.x == pytest.approx(seen_a.tractor_x - true_a.tractor.x)
        assert true_b.trailer_crab == true_a.trailer_crab


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e3, -60.0])
@pytest.mark.parametrize("field", ["tractor_steering", "trailer_steering", "speed"])
def test_bad_command_is_refused_by_name_and_moves_nothing(
    build: Build, ideal: SimulatedMachineSettings, field: str, bad: float
) -> None:
    machine = build(ideal)
    weave(machine, 5)
    before = machine.truth()
    good = Command(time=1.0, tractor_steering=0.0, trailer_steering=0.0, speed=1.0)
    with pytest.raises(HardwareError, match=rf"{field} = {bad} .*within ±"):
        machine.write(dataclasses.replace(good, **{field: bad}))
    assert machine.truth() == before


def test_command_at_the_limit_is_accepted_and_beyond_it_refused(build: Build, ideal: SimulatedMachineSettings) -> None:
    limit = VehicleParameters().trailer_steering_limit
    machine = build(ideal)
    at_limit = Command(time=0.0, tractor_steering=0.0, trailer_steering=-limit, speed=0.0)
    machine.write(at_limit)
    with pytest.raises(HardwareError):
        machine.write(dataclasses.replace(at_limit, trailer_steering=-math.nextafter(limit, 1.0)))


@pytest.mark.parametrize("sample_time", [0.205, 0.0, 0.004])
def test_sample_time_off_the_integration_grid_is_refused(ideal: SimulatedMachineSettings, sample_time: float) -> None:
    with pytest.raises(ConfigurationError, match=f"sample time {sample_time} s is not a positive multiple"):
        SimulatedMachine(
            vehicle=VehicleParameters(),
            settings=ideal,
            sample_time=sample_time,
            start=Pose(x=0.0, y=0.0, yaw=0.0),
            seed=0,
        )


def test_start_nowhere_is_refused(build: Build, ideal: SimulatedMachineSettings) -> None:
    with pytest.raises(ConfigurationError, match=r"cannot start at .*yaw=nan"):
        build(ideal, start=Pose(x=0.0, y=0.0, yaw=math.nan))
