"""What ends a run, or slows it, for what its sensors show: coarse positions, jumps, motion backwards."""

import math
from collections.abc import Callable, Container, Iterable
from dataclasses import replace

import numpy as np
import pytest
from ordinary import believed
from sanity import SAMPLE, Sanity, beside, estimate, measurement

from drawbar.config import load_configuration
from drawbar.experiment.alteration import InterceptedMachine
from drawbar.report.path_errors import true_path_errors
from drawbar.safety.sanity import SanitySettings
from drawbar.signals import FixStatus, Flag, Measurement, Pose, Status
from drawbar.simulation import Simulation


def test_motion_backwards_is_seen_within_a_second() -> None:
    sanity, statuses = Sanity(), []
    for k in range(12):
        seen = measurement(k, moved=-SAMPLE * k)
        statuses.append(sanity.look(seen, estimate(), beside(0.0), beside(0.0))[0])
    first = statuses.index(Status.BACKWARDS)
    assert SAMPLE * first <= 1.0


@pytest.mark.parametrize("speed", [0.3, 1.0, 2.0])
def test_a_single_false_speed_is_no_motion_backwards(speed: float) -> None:
    sanity = Sanity()
    for k in range(60):
        seen = measurement(k, speed=speed, moved=SAMPLE * k * speed)
        seen = replace(seen, speed=-20.0) if k % 10 == 9 else seen
        assert sanity.look(seen, estimate(), beside(0.0), beside(0.0)) == (0, 1.0)


@pytest.mark.parametrize("lost", ["tractor", "trailer"])
def test_motion_backwards_is_seen_by_one_antenna(lost: str) -> None:
    sanity, statuses = Sanity(), []
    for k in range(15):
        seen = replace(measurement(k, moved=-SAMPLE * k), **{f"{lost}_x": math.nan, f"{lost}_y": math.nan})
        statuses.append(sanity.look(seen, estimate(), beside(0.0), beside(0.0))[0])
    assert SAMPLE * statuses.index(Status.BACKWARDS) <= 1.6


@pytest.mark.parametrize("every", [2, 4])
def test_motion_backwards_is_seen_by_receivers_that_report_less_often(every: int) -> None:
    sanity, statuses = Sanity(), []
    nowhere = dict.fromkeys(("tractor_x", "tractor_y", "trailer_x", "trailer_y"), math.nan)
    for k in range(15):
        seen = replace(measurement(k, moved=-SAMPLE * k), **(nowhere if k % every else {}))
        statuses.append(sanity.look(seen, estimate(), beside(0.0), beside(0.0))[0])
    assert SAMPLE * statuses.index(Status.BACKWARDS) <= 1.6


def test_without_any_fix_nothing_moves_backwards() -> None:
    sanity, nowhere = Sanity(), dict.fromkeys(("tractor_x", "tractor_y", "trailer_x", "trailer_y"), math.nan)
    for k in range(60):
        seen = replace(measurement(k, moved=SAMPLE * k), **(nowhere if k > 20 else {}))
        assert sanity.look(seen, estimate(), beside(0.0), beside(0.0)) == (0, 1.0)


def test_wheels_that_report_a_reverse_speed_are_believed_within_a_second() -> None:
    sanity, statuses = Sanity(), []
    for k in range(12):
        seen = measurement(k, speed=-0.5)
        statuses.append(sanity.look(seen, estimate(), beside(0.0), beside(0.0))[0])
    assert SAMPLE * statuses.index(Status.BACKWARDS) <= 1.0


@pytest.mark.parametrize("jump", [-100.0, -2.0, 5.0])
def test_a_jump_of_both_antennas_is_no_motion(jump: float) -> None:
    sanity = Sanity()
    for k in range(40):
        seen = measurement(k, moved=SAMPLE * k + (jump if k > 20 else 0.0))
        assert sanity.look(seen, estimate(), beside(0.0), beside(0.0)) == (0, 1.0)


NEVER = range(0)


def jumped(
    begin: int, tractor: float, trailer: float, coarse: Container[int] = NEVER, held: Container[int] = NEVER
) -> list[int]:
    """Return the statuses of a drive whose estimate leaps so far (m) to the left at a sample.

    Some fixes are coarse, some are repeated.
    """
    sanity, statuses = Sanity(), []
    for k in range(60):
        seen = measurement(k, deviation=0.4 if k in coarse else 0.02)
        y = (tractor, trailer) if k >= begin else (0.0, 0.0)
        x = (seen.tractor_x, seen.trailer_x)
        bodies = [Pose(x=each, y=left, yaw=0.0) for each, left in zip(x, y, strict=True)]
        fix = FixStatus.STALE if k in held else FixStatus.REJECTED
        now = believed(*bodies, speed=1.0, tractor_fix=fix, trailer_fix=fix)
        statuses.append(sanity.look(seen, now, beside(0.0), beside(0.0))[0])
    return statuses


@pytest.mark.parametrize("left", [-0.33, 0.33, 100.0])
def test_positions_that_jump_together_end_the_run(left: float) -> None:
    assert [k for k, status in enumerate(jumped(30, left, left)) if status] == [30]
    assert jumped(30, left, left)[30] == Status.JUMPED


def test_receivers_that_report_at_every_fourth_sample_excuse_no_jump() -> None:
    waiting = [k for k in range(60) if k % 4]
    assert jumped(32, 0.5, 0.5, held=waiting)[32] == Status.JUMPED


@pytest.mark.parametrize(("measured", "jumps"), [(1.0, True), (1.3, False), (0.7, False), (math.nan, True)])
def test_what_an_estimated_speed_lags_behind_is_no_jump(measured: float, jumps: bool) -> None:
    sanity, statuses = Sanity(), []
    for k in range(60):
        seen = replace(measurement(k), speed=measured)
        ahead = 0.5 if k >= 30 else 0.0
        bodies = [Pose(x=each + ahead, y=0.0, yaw=0.0) for each in (seen.tractor_x, seen.trailer_x)]
        fix = FixStatus.ACCEPTED if k % 5 == 0 else FixStatus.STALE
        told = believed(*bodies, speed=1.0, tractor_fix=fix, trailer_fix=fix)
        statuses.append(sanity.look(seen, told, beside(0.0), beside(0.0))[0])
    assert (statuses[30] == Status.JUMPED) is jumps


def test_small_jumps_and_those_of_one_body_do_not() -> None:
    for tractor, trailer in ((0.29, 0.29), (0.5, 0.0), (0.0, 0.5)):
        assert not any(jumped(30, tractor, trailer))


def test_a_correction_after_coarse_positions_and_at_the_beginning_is_no_jump() -> None:
    assert not any(jumped(30, 0.5, 0.5, coarse=range(10, 30)))
    assert not any(jumped(30, 0.5, 0.5, held=range(10, 30)))
    assert not any(jumped(10, 0.5, 0.5))
    assert any(jumped(50, 0.5, 0.5, coarse=range(10, 30)))


def test_a_second_without_a_sample_in_a_fast_curve_is_no_jump() -> None:
    sanity, radius, speed = Sanity(), 8.0, 3.0
    times = [SAMPLE * k for k in range(30)] + [SAMPLE * k + 0.8 for k in range(30, 40)]
    for time in times:
        turned = speed * time / radius
        body = Pose(x=radius * math.sin(turned), y=radius * (1.0 - math.cos(turned)), yaw=turned)
        seen = replace(measurement(0, speed=speed), time=time)
        told = believed(body, body, speed=1.1 * speed)
        assert sanity.look(seen, told, beside(0.0, 1.0 / radius), beside(0.0))[0] == 0


def test_noise_at_standstill_and_at_a_creep_is_no_motion() -> None:
    rng = np.random.default_rng(1)
    for speed in (0.0, 0.3):
        sanity = Sanity()
        for k in range(500):
            seen = measurement(k, speed=speed, moved=SAMPLE * k * speed + float(rng.normal(0.0, 0.03)))
            assert sanity.look(seen, estimate(), beside(0.0), beside(0.0)) == (0, 1.0)


def test_coarse_positions_slow_and_then_end_the_run() -> None:
    settings = SanitySettings(coarse_after=0.5, coarse_budget=5.0, coarse_share=0.4)
    sanity, seen = Sanity(settings), []
    for k in range(60):
        deviation = math.nan if k <= 10 else 0.8
        seen.append(sanity.look(measurement(k, deviation=deviation), estimate(), beside(0.0), beside(0.0)))
    assert all(each == (0, 1.0) for each in seen[:13])
    assert all(share == 0.4 for _, share in seen[14:])
    assert [status for status, _ in seen].index(Status.COARSE) == 10 + 26
    one_is_fine = replace(measurement(60, deviation=0.8), tractor_fix_deviation=0.03)
    assert sanity.look(one_is_fine, estimate(), beside(0.0), beside(0.0)) == (0, 1.0)


@pytest.mark.parametrize("deviation", [0.02, 0.8])
def test_fixes_that_are_not_believed_slow_as_coarse_ones_do(deviation: float) -> None:
    sanity, shares = Sanity(SanitySettings(coarse_after=0.5, coarse_share=0.4)), []
    blind = replace(estimate(), tractor_fix=FixStatus.REJECTED, trailer_fix=FixStatus.MISSING)
    for k in range(20):
        seen = measurement(k, deviation=deviation if k > 10 else math.nan)
        shares.append(sanity.look(seen, blind if k > 10 else estimate(), beside(0.0), beside(0.0))[1])
    assert shares == [1.0] * 13 + [0.4] * 7
    assert sanity.look(measurement(20), estimate(), beside(0.0), beside(0.0)) == (0, 1.0)


@pytest.mark.parametrize(("deviation", "steady"), [(0.02, 1.0), (0.8, 0.4)])
@pytest.mark.parametrize("between", [FixStatus.MISSING, FixStatus.STALE])
def test_receivers_at_1_hz_give_a_steady_speed(deviation: float, steady: float, between: FixStatus) -> None:
    sanity, shares = Sanity(SanitySettings(coarse_after=0.5, coarse_share=0.4)), []
    for k in range(60):
        fix = FixStatus.ACCEPTED if k % 5 == 0 and k < 45 else between
        seen = measurement(k, deviation=deviation)
        told = replace(estimate(), tractor_fix=fix, trailer_fix=fix)
        shares.append(sanity.look(seen, told, beside(0.0), beside(0.0))[1])
    assert shares[10:47] == [steady] * 37
    assert shares[47:] == [0.4] * 13


def test_a_hitch_angle_that_contradicts_is_named() -> None:
    sanity, statuses = Sanity(), []
    for k in range(30):
        seen = replace(measurement(k), hitch_angle=0.3 if k > 10 else 0.0)
        statuses.append(sanity.look(seen, estimate(), beside(0.0), beside(0.0))[0])
    assert SAMPLE * (statuses.index(Status.HITCH) - 10) <= 1.0
    for k in range(100):  # for a while, or missing for good, it is no contradiction
        angle = 0.3 if k % 6 else 0.0
        assert not Sanity().look(replace(measurement(k), hitch_angle=angle), estimate(), beside(0.0), beside(0.0))[0]
        missing = replace(measurement(k), hitch_angle=math.nan)
        assert not sanity.look(replace(missing, time=100.0 + SAMPLE * k), estimate(), beside(0.0), beside(0.0))[0]


@pytest.mark.parametrize("false", [1.48, -1.48, 0.2])
@pytest.mark.parametrize("name", ["hitch_angle", "trailer_steering"])
def test_a_single_false_angle_is_no_contradiction(name: str, false: float) -> None:
    sanity, rng = Sanity(), np.random.default_rng(6)
    for k in range(200):
        seen = replace(measurement(k), hitch_angle=float(rng.normal(0.0, 0.0175)), trailer_steering=0.0)
        seen = replace(seen, **{name: false}) if k % 8 == 7 else seen
        assert sanity.look(seen, estimate(), beside(0.0), beside(0.0))[0] == 0


@pytest.mark.parametrize("period", [0.5, 1.0])
def test_samples_that_come_slowly_contradict_no_sooner_than_three_in_a_row(period: float) -> None:
    for wrong, ends in ((2, False), (6, True)):
        sanity, statuses = Sanity(), []
        for k in range(30):
            angle = 0.3 if 20 <= k < 20 + wrong else 0.0
            seen = replace(measurement(k), time=period * k, hitch_angle=angle)
            statuses.append(sanity.look(seen, estimate(), beside(0.0), beside(0.0))[0])
        assert (Status.HITCH in statuses) is ends


@pytest.mark.parametrize(("told", "position"), [(0.6, 0.03), (math.nan, 0.6)])
def test_a_coarse_fix_that_scatters_is_no_motion(told: float, position: float) -> None:
    rng, sanity = np.random.default_rng(2), Sanity(position=position)
    for k in range(2000):
        seen = measurement(k, moved=SAMPLE * k + float(rng.normal(0.0, 0.6)), deviation=told)
        assert sanity.look(seen, estimate(), beside(0.0), beside(0.0))[0] in (0, Status.COARSE)


def hitch_statuses(angles: Iterable[tuple[float, float]], departure: float = math.nan) -> list[int]:
    """Return the status after each sample with these hitch angles, measured and estimated.

    departure: of the yaw by fixes and angles from the yaw rate, rad.
    """
    sanity = Sanity()
    return [
        sanity.look(
            replace(measurement(k), hitch_angle=told),
            replace(estimate(), hitch_angle=true),
            beside(0.0),
            beside(0.0),
            departure,
        )[0]
        for k, (told, true) in enumerate(angles)
    ]


def test_a_hitch_sensor_that_stands_still_while_the_estimate_turns_is_stuck() -> None:
    turning = [min(max(0.1 * SAMPLE * (k - 20), 0.0), 0.08) - 0.035 for k in range(60)]
    statuses = hitch_statuses((0.0, each) for each in turning)  # it is never off by what counts as lasting
    assert 0.8 < SAMPLE * (statuses.index(Status.HITCH) - 20) <= 2.0
    rounded = [(round(each / 0.035) * 0.035, each) for each in turning]
    assert set(hitch_statuses(rounded)) == {0}


def test_a_lasting_difference_of_hitch_and_joint_is_held_against_what_is_usual_on_this_ground() -> None:
    rng = np.random.default_rng(3)
    smooth = [(float(rng.normal(0.0, 0.0175)), 0.0) for _ in range(400)]
    assert set(hitch_statuses(smooth)) == {0}
    statuses = hitch_statuses([*smooth, *[(0.08, 0.0)] * 20])
    assert SAMPLE * (statuses.index(Status.HITCH) - 400) <= 1.6
    rough = [(float(each), 0.0) for each in np.repeat(rng.normal(0.0, 0.025, 400), 5)]  # lasts for a second each
    assert set(hitch_statuses([*rough, *[(0.06, 0.0)] * 20])) == {0}


@pytest.mark.parametrize(
    ("apart", "after", "ends"), [(5.0, 60, True), (-5.0, 60, True), (4.0, 60, False), (5.0, 40, False)]
)
def test_side_slips_that_no_ground_makes_are_of_a_sensor_that_drifts(apart: float, after: int, ends: bool) -> None:
    """After ten seconds on the way, in which the estimate has settled."""
    sanity, statuses = Sanity(), []
    for k in range(after + 8):
        crab = math.radians(apart) if k >= after else 0.0
        believed_now = replace(estimate(), tractor_crab=1.0 + crab, trailer_crab=1.0)
        statuses.append(sanity.look(measurement(k), believed_now, beside(0.0), beside(0.0), math.nan)[0])
    assert (Status.HITCH in statuses) is ends
    assert Status.HITCH not in statuses[: after + 3]


def test_a_contradiction_that_the_yaw_rate_does_not_share_may_last_three_times_as_long() -> None:
    wet = [(0.0, 0.0)] * 50 + [(0.07, 0.0)] * 7 + [(0.0, 0.0)] * 50
    assert set(hitch_statuses(wet, departure=0.035)) == {0}  # wheels that slip on a wet patch
    assert Status.HITCH in hitch_statuses(wet, departure=0.05)
    assert Status.HITCH in hitch_statuses(wet)
    lasting = hitch_statuses([(0.0, 0.0)] * 50 + [(0.07, 0.0)] * 20, departure=0.035)
    assert 2.1 < SAMPLE * (lasting.index(Status.HITCH) - 50) < 3.0


@pytest.mark.parametrize("speed", [1.0, 2.0])
@pytest.mark.parametrize("reversed_sign", [True, False])
def test_a_hitch_sensor_that_fails_in_a_curve_stops_the_run_near_the_line(speed: float, reversed_sign: bool) -> None:
    begins, still = 20.0, []

    def fail(m: Measurement) -> Measurement:
        if m.time < begins:
            return m
        still.append(m.hitch_angle)
        return replace(m, hitch_angle=-m.hitch_angle if reversed_sign else still[0])

    with Simulation(load_configuration("articulated", ["path.radii=[8.0]", f"speed={speed}"])) as simulation:
        simulation.machine = InterceptedMachine(simulation.machine, fail)
        log = simulation.log()
    assert "the sensor of the hitch angle" in log.outcome.reason
    errors = true_path_errors(log)
    assert max(float(np.nanmax(np.abs(each.error))) for each in (errors.tractor, errors.trailer)) < 0.2


@pytest.mark.parametrize("speed", [1.0, 2.0])
@pytest.mark.parametrize("rate", [-2.0, 1.0])
def test_a_hitch_sensor_that_drifts_stops_the_run(speed: float, rate: float) -> None:
    def drift(m: Measurement) -> Measurement:
        return replace(m, hitch_angle=m.hitch_angle + math.radians(rate) * max(m.time - 20.0, 0.0))

    with Simulation(load_configuration("articulated", ["path.radii=[8.0]", f"speed={speed}"])) as simulation:
        simulation.machine = InterceptedMachine(simulation.machine, drift)
        log = simulation.log()
    assert "one of both sensors drifts or is off" in log.outcome.reason
    errors = true_path_errors(log)
    assert max(float(np.nanmax(np.abs(each.error))) for each in (errors.tractor, errors.trailer)) < 0.7


def swapped(m: Measurement) -> Measurement:
    return replace(m, tractor_x=m.trailer_x, tractor_y=m.trailer_y, trailer_x=m.tractor_x, trailer_y=m.tractor_y)


def test_a_run_with_positions_of_30_cm_is_not_taken_for_one_backwards(simulate: Callable) -> None:
    noise = ("sensors.position=0.3", "machine.sensors.position=0.3", "speed=0.5", "path.radii=[10.0]")
    for seed in range(2):
        run = simulate("articulated", *noise, seed=seed)
        assert run.records[-1].reference.tractor.progress > run.path.length - 1.0


def test_swapped_antennas_are_named_within_a_second() -> None:
    with Simulation(load_configuration("articulated", ["path.radii=[8.0]"])) as simulation:
        simulation.machine = InterceptedMachine(simulation.machine, swapped)
        log = simulation.log()
    assert "swapped" in log.outcome.reason
    assert log.records[-1].measurement.time <= 1.0


@pytest.mark.parametrize(
    ("sensor", "name"), [("tractor_steering", "front wheels"), ("trailer_steering", "trailer's joint")]
)
def test_a_steering_sensor_of_the_wrong_sign_is_named(sensor: str, name: str) -> None:
    def reverse(m: Measurement) -> Measurement:
        return replace(m, **{sensor: -getattr(m, sensor)}) if m.time > 20.0 else m

    with Simulation(load_configuration("articulated", ["path.radii=[8.0]"])) as simulation:
        simulation.machine = InterceptedMachine(simulation.machine, reverse)
        log = simulation.log()
    assert f"the sensor of the {name} shows" in log.outcome.reason
    assert "wrong sign" in log.outcome.reason
    assert log.records[-1].measurement.time <= 21.3


def test_antennas_that_swap_while_driving_are_thought_of() -> None:
    with Simulation(load_configuration("articulated", ["path.radii=[8.0]"])) as simulation:
        simulation.machine = InterceptedMachine(simulation.machine, lambda m: swapped(m) if m.time > 20.0 else m)
        log = simulation.log()
    assert "swapped" in log.outcome.reason


def test_a_limit_cycle_slows_the_vehicle_before_it_stops_it() -> None:
    late = ["machine.actuators.dead_time=0.2", "actuation.identify=false"]
    with Simulation(load_configuration("articulated", ["path.radii=[8.0]", "speed=2.0", *late])) as simulation:
        log = simulation.log()
    slowed = (log.column("flags").astype(int) & Flag.SLOWED) > 0
    assert slowed.sum() > 25
    assert log.column("command.speed")[slowed].min() == pytest.approx(1.0)
    assert log.outcome.finished or "swing from side to side" in log.outcome.reason


def test_float_is_driven_through_slowly_and_near_the_line(simulate: Callable) -> None:
    event = "machine.events=[{kind='gps_float', start=25.0, duration=20.0}]"
    run = simulate("articulated", "path.radii=[8.0]", event)
    for body in ("tractor", "trailer"):
        assert np.abs(run.true_errors(body).error).max() < 0.15
    time, speed = run.column("measurement", "time"), run.column("command", "speed")
    assert speed[(time > 28.0) & (time < 44.0)].max() == pytest.approx(0.5)
    assert speed[-1] == pytest.approx(1.0)
