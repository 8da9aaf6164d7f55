"""Alignment: lever arms, attitude that fades, the ground's record, ages, deviations; against closed forms and truth."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from alignment import Alignment
from golden import rows
from ordinary import believed, measured

from drawbar.config import load_configuration
from drawbar.geometry import arm_offset
from drawbar.report.path_errors import true_path_errors
from drawbar.signals import Estimate, FixQuality, Measurement, Pose
from drawbar.simulation import Simulation
from drawbar.vehicle.parameters import Mast, Masts, VehicleParameters
from drawbar.vehicle.sensors import FixSettings, SensorNoise

SAMPLE = 0.2


def estimate(time: float, tractor: Pose, trailer: Pose, **values: float) -> Estimate:
    return believed(tractor, trailer, time=time, **{"speed": 1.0, **values})


def measurement(time: float, fixes: tuple[float, float, float, float], **values: Any) -> Measurement:
    return measured(*fixes, time=time, **values)


def straight(time: float, yaw: float = 0.0, speed: float = 1.0) -> Estimate:
    """Return the estimate of a vehicle that drives straight away from the origin."""
    ahead = math.cos(yaw), math.sin(yaw)
    at = [speed * time - back for back in (0.0, 2.15)]
    poses = [Pose(x=s * ahead[0], y=s * ahead[1], yaw=yaw) for s in at]
    return estimate(time, *poses)


def standing(yaw: float, trailer_yaw: float) -> Estimate:
    return estimate(0.0, Pose(x=0.0, y=0.0, yaw=yaw), Pose(x=-2.0, y=0.0, yaw=trailer_yaw))


def test_lever_arms_are_those_of_the_golden_file() -> None:
    for value in rows("lever_arm.csv"):
        mast = Mast(forward=value["arm_forward_m"], left=value["arm_left_m"], up=value["arm_up_m"])
        antenna = value["antenna_east_m"], value["antenna_north_m"]
        for body in ("tractor", "trailer"):
            vehicle = VehicleParameters(masts=Masts.model_validate({body: mast.model_dump()}))
            lean = {f"{body}_roll": value["roll_right_rad"], f"{body}_pitch": value["pitch_up_rad"]}
            pose = standing(value["yaw_rad"], value["yaw_rad"])
            aligned = Alignment(vehicle).apply(measurement(0.0, (*antenna, *antenna), **lean), pose, pose)
            ground = getattr(aligned, f"{body}_x"), getattr(aligned, f"{body}_y")
            assert ground == pytest.approx((value["ground_east_m"], value["ground_north_m"]), abs=1e-6)


def test_without_masts_and_ages_nothing_changes() -> None:
    first, last = straight(0.0, 0.3), straight(0.2, 0.3)
    given = measurement(0.2, (0.1, 0.2, -2.0, 0.3), tractor_roll=0.1, tractor_pitch=0.02, speed=1.02)
    assert repr(Alignment(VehicleParameters()).apply(given, first, last)) == repr(given)


def test_values_of_any_age_are_brought_to_now() -> None:
    yaw, rate, ages = 0.4, 0.1, (0.1, 0.2, 0.5)
    for age in ages:
        before, now = straight(1.0, yaw), straight(1.2, yaw)
        before = replace(before, tractor_steering=-rate * SAMPLE, hitch_angle=0.3 - rate * SAMPLE)
        now = replace(now, tractor_steering=0.0, hitch_angle=0.3)
        then = straight(1.2 - age, yaw)
        fixes = (then.tractor.x, then.tractor.y, then.trailer.x, then.trailer.y)
        names = ("tractor_fix", "trailer_fix", "tractor_steering", "hitch_angle")
        told = {f"{name}_age": age for name in names}
        late = measurement(1.2, fixes, tractor_steering=-rate * age, hitch_angle=0.3 - rate * age, **told)
        aligned = Alignment(VehicleParameters()).apply(late, before, now)
        assert (aligned.tractor_x, aligned.tractor_y) == pytest.approx((now.tractor.x, now.tractor.y), abs=1e-12)
        assert (aligned.trailer_x, aligned.trailer_y) == pytest.approx((now.trailer.x, now.trailer.y), abs=1e-12)
        assert (aligned.tractor_steering, aligned.hitch_angle) == pytest.approx((0.0, 0.3), abs=1e-12)


@pytest.mark.parametrize("early", [-0.08, 0.08])
def test_a_late_fix_moves_by_the_models_time_whatever_the_time_stamps(early: float) -> None:
    then, now = straight(0.8), straight(1.2)
    fixes = (then.tractor.x, then.tractor.y, then.trailer.x, then.trailer.y)
    late = measurement(1.2 - early, fixes, tractor_fix_age=0.4, trailer_fix_age=0.4)
    aligned = Alignment(VehicleParameters()).apply(late, straight(1.0), now)
    assert (aligned.tractor_x, aligned.trailer_x) == pytest.approx((now.tractor.x, now.trailer.x), abs=1e-12)


@pytest.mark.parametrize("age", [0.1, 0.2, 0.5, 0.95])
def test_a_late_fix_of_a_curve_is_brought_to_now(age: float) -> None:
    speed, rate = 2.5, 0.3

    def there(time: float) -> Estimate:
        tractor, trailer = (
            Pose(x=radius * math.sin(rate * time), y=-radius * math.cos(rate * time), yaw=rate * time)
            for radius in (speed / rate, 8.0)
        )
        return estimate(time, tractor, trailer)

    then, now = there(1.2 - age), there(1.2)
    fixes = (then.tractor.x, then.tractor.y, then.trailer.x, then.trailer.y)
    late = measurement(1.2, fixes, tractor_fix_age=age, trailer_fix_age=age)
    aligned = Alignment(VehicleParameters()).apply(late, there(1.0), now)
    assert (aligned.tractor_x, aligned.tractor_y) == pytest.approx((now.tractor.x, now.tractor.y), abs=0.01)
    assert (aligned.trailer_x, aligned.trailer_y) == pytest.approx((now.trailer.x, now.trailer.y), abs=0.01)


def weave(
    alignment: Alignment, samples: int, age: float = 0.0, *, tells: bool = True, corrected: float = 0.0, **values: Any
) -> list[float]:
    """Return by how much believed yaw rates are beyond a weaving tractor's, rad/s; it tells them exactly, `age` old.

    Unless it tells their age they count as new. Each estimate differs by up to `corrected` (rad/s, with a period of
    half a minute) from what was expected before its sample.

    From the 60th sample on the measurement has these values.
    """
    lengths, found = VehicleParameters(), []
    back = lengths.hitch_length + lengths.trailer_length - lengths.trailer_antenna

    def rate(time: float) -> float:
        return 0.15 * math.sin(0.8 * time)

    def yaw(time: float) -> float:
        return 0.15 / 0.8 * (1.0 - math.cos(0.8 * time))

    def there(time: float, correction: float = 0.0) -> Estimate:
        steering = math.atan(lengths.wheelbase * (rate(time) - correction * math.sin(0.2 * time)))
        pose = Pose(x=0.01 * time, y=0.0, yaw=yaw(time))
        east, north = back * math.cos(pose.yaw), back * math.sin(pose.yaw)
        behind = Pose(x=pose.x - east, y=-north, yaw=pose.yaw)
        return estimate(time, pose, behind, tractor_steering=steering)

    for k in range(1, samples):
        now = SAMPLE * k
        east, north = back * math.cos(yaw(now)), back * math.sin(yaw(now))
        told = {
            "tractor_yaw_rate": rate(now - age),
            "tractor_attitude_age": age if tells else 0.0,
        }
        given = measurement(now, (0.01 * now, 0.0, 0.01 * now - east, -north), **told)
        given = replace(given, **values) if k >= 60 else given
        last = there(now - SAMPLE, corrected)
        found.append(alignment.apply(given, last, there(now)).tractor_yaw_rate - rate(now))
    return found


@pytest.mark.parametrize("age", [0.0, 0.1, 0.2, 0.3, 0.5, 0.95])
def test_a_yaw_rate_of_any_age_is_brought_to_now(age: float) -> None:
    beyond = weave(Alignment(VehicleParameters()), 150, age)
    assert all(map(math.isnan, beyond[:10]))
    assert np.abs(beyond[60:]).max() < math.radians(0.5)


def test_what_a_sample_corrects_in_the_estimate_is_no_change_of_an_old_yaw_rate() -> None:
    beyond = weave(Alignment(VehicleParameters()), 300, 0.2, corrected=math.radians(1.5))
    assert np.abs(beyond[60:]).max() < math.radians(0.5)


def test_a_yaw_rate_that_is_late_and_does_not_tell_is_found_and_brought_to_now() -> None:
    beyond = weave(Alignment(VehicleParameters()), 600, 0.2, tells=False)
    assert np.abs(beyond[400:]).max() < math.radians(0.5)


@pytest.mark.parametrize(
    "values",
    [
        {"hitch_angle": math.nan},
        {"trailer_x": math.nan},
        {"tractor_fix_quality": FixQuality.FLOAT, "tractor_fix_deviation": 0.3, "hitch_angle": 0.3},
    ],
)
def test_what_shows_no_yaw_says_nothing_against_a_yaw_rate(values: dict[str, Any]) -> None:
    assert np.abs(weave(Alignment(VehicleParameters()), 150, **values)[60:]).max() < math.radians(0.5)


@pytest.mark.parametrize("age", [-0.1, 1.1, math.inf])
def test_values_too_old_or_of_the_future_are_missing(age: float) -> None:
    late = measurement(1.2, (1.0, 0.0, -1.0, 0.0), tractor_fix_age=age, hitch_angle_age=age)
    aligned = Alignment(VehicleParameters()).apply(late, straight(1.0), straight(1.2))
    assert math.isnan(aligned.tractor_x + aligned.tractor_y)
    assert math.isnan(aligned.hitch_angle)
    assert aligned.trailer_x == -1.0


def test_values_that_are_a_little_of_the_future_are_of_now() -> None:
    """The clock of a sensor may be some milliseconds ahead of the one that stamps the sample."""
    alignment = Alignment(VehicleParameters(), SensorNoise(fixes=FixSettings(age=0.1)))
    ages = {name: -0.05 for name in Measurement.__struct_fields__ if name.endswith("_age")}
    given = measurement(1.2, (1.2, 0.0, -0.95, 0.0), speed=1.0, **ages)
    aligned = alignment.apply(given, straight(1.0), straight(1.2))
    assert len(ages) == 8
    for name in ("tractor_x", "trailer_x", "hitch_angle", "speed", "tractor_steering", "trailer_steering"):
        assert getattr(aligned, name) == pytest.approx(getattr(given, name), abs=1e-5)


def test_a_receiver_that_does_not_tell_its_age_has_the_configured_one() -> None:
    sensors = SensorNoise(fixes=FixSettings(age=0.1))
    given = measurement(1.2, (1.1, 0.0, -1.05, 0.0), trailer_fix_age=0.2)
    aligned = Alignment(VehicleParameters(), sensors).apply(given, straight(1.0), straight(1.2))
    assert (aligned.tractor_x, aligned.trailer_x) == pytest.approx((1.2, -0.85))


LEANING = VehicleParameters(masts=Masts(tractor=Mast(up=2.5), trailer=Mast(up=2.0)))


def corrections(
    alignment: Alignment, rolls: list[float], yaw: float = 0.0, ages: dict[int, float] | None = None
) -> list[tuple[float, float]]:
    """Return what is added to both fixes' north while a vehicle drives east, one per sample; ages by sample, s."""
    added = []
    for k, roll in enumerate(rolls):
        last, now = straight(SAMPLE * max(k - 1, 0), yaw), straight(SAMPLE * k, yaw)
        north = 1e-6 * k  # no fix repeats the last one
        fixes = (now.tractor.x, now.tractor.y + north, now.trailer.x, now.trailer.y + north)
        lean = {"tractor_roll": roll, "tractor_pitch": 0.0, "tractor_attitude_age": (ages or {}).get(k, 0.0)}
        aligned = alignment.apply(measurement(SAMPLE * k, fixes, **lean), last, now)
        added.append((aligned.tractor_y - fixes[1], aligned.trailer_y - fixes[3]))
    return added


def test_attitude_that_ends_fades_out_and_one_that_returns_fades_in() -> None:
    missing = math.nan
    rolls = [0.1] * 20 + [missing] * 30 + [-0.1] * 30
    vehicle = VehicleParameters(masts=Masts(tractor=Mast(up=2.5, roll_deviation=0.0)))
    added = [tractor for tractor, _ in corrections(Alignment(vehicle), rolls)]
    full = 2.5 * math.sin(0.1)
    assert added[:22] == pytest.approx([full] * 22)  # up to half a second
    assert abs(added[-1] + full) < 0.01 * full
    # what was recorded of the ground takes the sensor's place; the way from one side to the other takes two seconds
    assert max(abs(np.diff(added))) < 0.3 * full


@pytest.mark.parametrize("age", [-1e9, -100.0, 1e9, math.inf, math.nan])
def test_one_attitude_of_a_wrong_age_is_dropped_and_the_next_ones_count(age: float) -> None:
    vehicle = VehicleParameters(masts=Masts(tractor=Mast(up=2.5, roll_deviation=0.0)))
    rolls = [0.1] * 10 + [-0.3] + [0.1] * 10 + [-0.1] * 40
    added = [tractor for tractor, _ in corrections(Alignment(vehicle), rolls, ages={10: age})]
    full = 2.5 * math.sin(0.1)
    assert added[:21] == pytest.approx([full] * 21)
    assert added[-1] == pytest.approx(-full)


def test_the_trailer_leans_where_the_tractor_leaned() -> None:
    profile = [0.1 * math.sin(0.9 * SAMPLE * k) for k in range(100)]
    added = corrections(Alignment(LEANING), profile)
    behind = 1.1 + 1.3  # from the tractor's axle to the trailer's, both recorded straight
    for k in range(30, 100):
        then = 0.1 * math.sin(0.9 * (SAMPLE * k - behind))
        assert added[k][1] == pytest.approx(2.0 * math.sin(then), abs=0.003)


def test_the_recorded_slope_is_the_same_whichever_way_it_is_driven() -> None:
    """A plane is recorded to the east; a trailer that stands across it pitches as the tractor rolled."""
    alignment = Alignment(LEANING)
    corrections(alignment, [0.1] * 40)
    end = straight(SAMPLE * 39)
    turned = replace(end, trailer=Pose(x=end.trailer.x, y=end.trailer.y, yaw=0.5 * math.pi))
    fixes = (end.tractor.x, 0.01, end.trailer.x, 0.01)
    aligned = alignment.apply(measurement(SAMPLE * 40, fixes, tractor_roll=0.1), turned, turned)
    # rolled to the right facing east: the ground rises to the north, so facing north the nose is up
    assert aligned.trailer_y - 0.01 == pytest.approx(2.0 * math.sin(0.1), abs=0.005)
    assert aligned.trailer_x - fixes[2] == pytest.approx(0.0, abs=0.005)


def test_a_repeated_fix_stays_a_repetition() -> None:
    alignment, seen = Alignment(LEANING), set()
    for k, roll in enumerate((0.1, 0.05, -0.02)):
        now = straight(SAMPLE * k)
        aligned = alignment.apply(measurement(SAMPLE * k, (0.0, 0.0, -2.0, 0.0), tractor_roll=roll), now, now)
        seen.add((aligned.tractor_x, aligned.tractor_y))
    assert len(seen) == 1


@pytest.mark.parametrize(("aging", "counts"), [(SAMPLE, False), (0.0, True)])
def test_a_repeated_fix_counts_once_unless_it_is_as_new_as_before(aging: float, counts: bool) -> None:
    """Receivers of 1 Hz repeat a fix with its age; those of a vehicle at rest report the same place anew."""
    alignment = Alignment(LEANING)
    for k in range(4):
        now = straight(SAMPLE * k)
        ages = dict.fromkeys(("tractor_fix_age", "trailer_fix_age"), 0.1 + aging * k)
        aligned = alignment.apply(measurement(SAMPLE * k, (0.0, 0.0, -2.0, 0.0), **ages), now, now)
        known = [math.isfinite(value) for value in (aligned.tractor_x, aligned.trailer_x)]
        assert known == [counts or k == 0] * 2


@pytest.mark.parametrize("forward", [-1.5, 0.3, 2.4])
def test_a_run_begins_on_the_ground(forward: float) -> None:
    masts = Masts(tractor=Mast(forward=forward, left=0.2, up=2.5), trailer=Mast(left=-0.3, up=2.0))
    yaw, joint, lean = 0.7, 0.2, (0.08, -0.03)
    hitch = 0.3
    trailer_yaw = yaw - hitch - joint
    point = (
        100.0 - 0.9 * math.cos(yaw) - 0.2 * math.cos(trailer_yaw + joint) - 1.05 * math.cos(trailer_yaw),
        50.0 - 0.9 * math.sin(yaw) - 0.2 * math.sin(trailer_yaw + joint) - 1.05 * math.sin(trailer_yaw),
    )
    tractor = np.add((100.0, 50.0), arm_offset(yaw, *lean, masts.tractor.arm))
    trailer = np.add(point, arm_offset(trailer_yaw, *lean, masts.trailer.arm))
    attitude = dict(
        zip(("tractor_roll", "tractor_pitch", "trailer_roll", "trailer_pitch"), (*lean, *lean), strict=True)
    )
    first = measurement(0.0, (*tractor, *trailer), hitch_angle=hitch, trailer_steering=joint, **attitude)
    aligned = Alignment(VehicleParameters(masts=masts)).begin(first)
    assert (aligned.tractor_x, aligned.tractor_y) == pytest.approx((100.0, 50.0), abs=1e-9)
    assert (aligned.trailer_x, aligned.trailer_y) == pytest.approx(point, abs=1e-9)


@pytest.mark.parametrize(
    ("quality", "told", "expected"),
    [
        (FixQuality.UNKNOWN, math.nan, math.nan),
        (FixQuality.FIXED, math.nan, math.nan),
        (FixQuality.FIXED, 0.02, 0.03),
        (FixQuality.FIXED, 0.001, 0.01),
        (FixQuality.UNKNOWN, 0.3, 0.45),
        (FixQuality.FLOAT, math.nan, 0.8),
        (FixQuality.FLOAT, 0.01, 0.8),
        (FixQuality.FLOAT, 0.6, 1.2),
        (FixQuality.DIFFERENTIAL, math.nan, 1.6),
        (FixQuality.SINGLE, 3.0, 6.0),
    ],
)
def test_fixes_count_by_what_they_are(quality: FixQuality, told: float, expected: float) -> None:
    sensors = SensorNoise(fixes=FixSettings(correlation_inflation=2.0))
    given = measurement(0.0, (1.0, 0.0, -1.0, 0.0), tractor_fix_quality=quality, tractor_fix_deviation=told)
    aligned = Alignment(VehicleParameters(), sensors).apply(given, straight(0.0), straight(0.0))
    assert aligned.tractor_fix_deviation == pytest.approx(expected, nan_ok=True)
    assert aligned.tractor_x == 1.0


@pytest.mark.parametrize(
    ("quality", "told"), [(FixQuality.NONE, 0.02), (FixQuality.FIXED, 0.0), (FixQuality.FLOAT, -1.0)]
)
def test_fixes_without_a_meaning_are_missing(quality: FixQuality, told: float) -> None:
    given = measurement(0.0, (1.0, 0.0, -1.0, 0.0), trailer_fix_quality=quality, trailer_fix_deviation=told)
    aligned = Alignment(VehicleParameters()).apply(given, straight(0.0), straight(0.0))
    assert math.isnan(aligned.trailer_x + aligned.trailer_y)
    assert aligned.tractor_x == 1.0


MASTS = "vehicle.masts={tractor={up=2.5},trailer={up=2.0}}"
FIELD = ("path.radii=[8.0]", MASTS, "machine.terrain={slope=0.0873,creep=0.36,unevenness=0.02}")


def mean_errors(*changes: str) -> tuple[float, float]:
    """Return the mean distance of both bodies' points on the ground from the path after the first 5 m, cm."""
    with Simulation(load_configuration("articulated", [*FIELD, *changes])) as simulation:
        errors = true_path_errors(simulation.log())
    return tuple(100.0 * np.abs(each.error[each.progress > 5.0]).mean() for each in (errors.tractor, errors.trailer))


def test_attitude_that_tells_that_it_is_late_costs_little() -> None:
    both = ("speed=2.0", "machine.attitude={tractor={present=true},trailer={present=true}}")
    fresh, late = mean_errors(*both), mean_errors(*both, "machine.delays.attitude.latency=0.3")
    assert np.max(np.subtract(late, fresh)) < 1.2  # the newest fix has an older roll


def test_attitude_holds_the_ground_point_in_the_field() -> None:
    none = mean_errors()
    both = mean_errors("machine.attitude={tractor={present=true},trailer={present=true}}")
    tractor = mean_errors("machine.attitude.tractor.present=true")
    assert none[0] > 10.0
    assert both[0] < 3.0
    assert both[1] < 4.0
    assert tractor == pytest.approx(both, abs=1.0)
