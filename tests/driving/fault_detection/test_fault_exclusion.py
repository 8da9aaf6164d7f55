"""Fault exclusion: sensors that contradict the motion are left out until the steering has been released."""

import math
from dataclasses import replace
from itertools import count
from types import SimpleNamespace

import pytest
from ordinary import measured

from drawbar.driving.fault_detection.confirmation import CONFIRMED
from drawbar.driving.fault_detection.fault_exclusion import FaultExclusion
from drawbar.safety.sanity import SanitySettings
from drawbar.signals import Actuation, FixStatus, SolverStatus
from drawbar.vehicle.parameters import VehicleParameters

DEGREE = math.pi / 180.0
SEEN = measured(1.0, 2.0, 3.0, 4.0, hitch_angle=0.1, speed=1.0)
NOT_CORRECTED = Actuation()
FINE = count()
"""a sensor that hardly ever repeats itself to the last bit"""


def step(
    hitch=0.1,
    joint=0.0,
    fixes=(FixStatus.ACCEPTED, FixStatus.ACCEPTED),
    status=SolverStatus.SOLVED,
    speed=1.0,
    tractor=(1.0, 2.0),
    trailer=(3.0, 4.0),
    measured_hitch=None,
    known=NOT_CORRECTED,
):
    estimate = SimpleNamespace(
        hitch_angle=hitch, trailer_steering=joint, tractor_fix=fixes[0], trailer_fix=fixes[1], status=status,
        tractor=SimpleNamespace(x=tractor[0], y=tractor[1], yaw=0.0),
        trailer=SimpleNamespace(x=trailer[0], y=trailer[1]),
        longitudinal_slip=1.0, tractor_slip=1.0, steering_offset=0.0, tractor_crab=0.0, trailer_crab=0.0,
    )  # fmt: skip
    angle = 0.1 + 1e-9 * (next(FINE) % 7) if measured_hitch is None else measured_hitch
    seen = replace(SEEN, speed=speed, hitch_angle=angle)
    return SimpleNamespace(measurement=seen, estimate=estimate, actuation=known)


def exclusion(record, times=CONFIRMED, *, engaged=True):
    found = FaultExclusion(SanitySettings(), VehicleParameters(), 0.2)
    for _ in range(times):
        found.update(record, engaged=engaged)
    return found


REJECTED = (FixStatus.REJECTED, FixStatus.REJECTED)


def test_positions_that_both_antennas_contradict_are_left_out_while_engaged():
    assert not exclusion(step(fixes=REJECTED), CONFIRMED - 1).is_active
    assert not exclusion(step(fixes=(FixStatus.REJECTED, FixStatus.ACCEPTED))).is_active
    found = exclusion(step(fixes=REJECTED))
    without = found.without_excluded(SEEN)
    assert all(map(math.isnan, (without.tractor_x, without.tractor_y, without.trailer_x, without.trailer_y)))
    assert without.hitch_angle == 0.1
    found.update(step(), engaged=True)
    assert found.is_active
    found.update(step(), engaged=False)
    assert not found.is_active
    assert found.without_excluded(SEEN) == SEEN


def test_an_estimate_that_goes_astray_has_followed_the_trailers_sensors_and_if_it_does_again_the_front_wheels():
    found = FaultExclusion(SanitySettings(), VehicleParameters(), 0.2)
    found.update(step(), engaged=True, astray=True)
    assert found.excludes_trailer
    assert not found.steering_contradicts
    found.update(step(), engaged=True)
    assert found.excludes_trailer
    assert not found.steering_contradicts
    found.update(step(), engaged=True, astray=True)
    assert found.steering_contradicts


def test_positions_that_drift_are_left_out_while_engaged():
    found = FaultExclusion(SanitySettings(), VehicleParameters(), 0.2)
    found.update(step(), engaged=True, moved=True)
    assert math.isnan(found.without_excluded(SEEN).tractor_x)
    found.update(step(), engaged=True)
    assert found.is_active
    found.update(step(), engaged=False)
    assert not found.is_active


def test_a_hitch_angle_that_contradicts_leaves_out_the_trailer_and_what_it_did_to_the_positions_is_forgiven():
    found = exclusion(step(hitch=0.3, fixes=REJECTED))
    assert found.excludes_trailer
    without = found.without_excluded(SEEN)
    assert all(map(math.isnan, (without.hitch_angle, without.trailer_steering, without.trailer_x, without.trailer_y)))
    assert (without.tractor_x, without.tractor_y) == (1.0, 2.0)
    found.update(step(fixes=REJECTED), engaged=True)
    assert found.without_excluded(SEEN).tractor_x == 1.0
    for _ in range(5):
        found.update(step(), engaged=False)
    assert not found.is_active


def test_positions_that_the_receivers_themselves_contradict_are_not_forgiven():
    found = FaultExclusion(SanitySettings(), VehicleParameters(), 0.2)
    found.update(step(), engaged=True, moved=True)
    for _ in range(5):
        found.update(step(hitch=0.3), engaged=True)
    assert found.excludes_trailer
    assert math.isnan(found.without_excluded(SEEN).tractor_x)
    found = exclusion(step(hitch=0.3))
    assert found.without_excluded(SEEN).tractor_x == 1.0
    found.update(step(), engaged=True, moved=True)
    assert math.isnan(found.without_excluded(SEEN).tractor_x)
    assert found.without_trailer(SEEN).tractor_x == 1.0
    assert math.isnan(found.without_trailer(SEEN).trailer_x)
    for _ in range(5):
        found.update(step(), engaged=False)
    assert not found.is_active
    assert found.without_trailer(SEEN) == SEEN


def on_calm_ground(sample_time=0.2, time=30.0):
    """Return what is left of a drive in which nothing differed."""
    found = FaultExclusion(SanitySettings(), VehicleParameters(), sample_time)
    for _ in range(round(time / sample_time)):
        found.update(step(), engaged=True)
    return found


@pytest.mark.parametrize(
    ("hitch", "joint", "excluded"), [(2.9, 0.0, True), (2.0, -2.0, True), (0.0, 2.9, True), (1.9, 1.9, False)]
)
def test_angles_of_hitch_and_joint_that_differ_a_little_for_long_are_doubted(hitch, joint, excluded):
    found = on_calm_ground()
    for i in range(5):
        assert not found.is_active
        found.update(step(hitch=SEEN.hitch_angle + (hitch * DEGREE), joint=joint * DEGREE), engaged=True)
        assert found.is_active is (excluded and i == 4)
    assert not exclusion(step(joint=math.nan, hitch=math.nan), 10).is_active


def test_angles_of_a_sensor_whose_scale_is_known_do_not_contradict():
    for scale, excluded in ((0.0, True), (0.25, False)):
        found = on_calm_ground()
        for _ in range(20):
            found.update(
                step(hitch=25.0 * DEGREE, measured_hitch=20.0 * DEGREE, known=Actuation(hitch_scale=scale)),
                engaged=True,
            )
        assert found.excludes_trailer is excluded


@pytest.mark.parametrize("false", [85.0, -85.0])
@pytest.mark.parametrize("name", ["hitch", "joint"])
def test_a_single_false_angle_is_not_doubted_and_two_in_a_row_are(name, false):
    single, found = step(**{name: false * DEGREE}), on_calm_ground()
    for i in range(30):
        found.update(single if i % 6 == 0 else step(), engaged=True)
        assert not found.is_active
    found.update(single, engaged=True)
    found.update(single, engaged=True)
    assert found.excludes_trailer


@pytest.mark.parametrize("aside", [{"tractor": (1.3, 2.0)}, {"trailer": (3.0, 3.7)}])
def test_angles_that_differ_less_are_doubted_where_an_antenna_is_contradicted_as_well(aside):
    both, angle, antenna = step(joint=2.0 * DEGREE, **aside), step(joint=2.0 * DEGREE), step(**aside)
    for record, excluded in ((both, True), (angle, False), (antenna, False)):
        found = on_calm_ground()
        for _ in range(10):
            found.update(record, engaged=True)
        assert found.excludes_trailer is excluded


def test_an_antenna_that_is_usually_aside_is_not_contradicted():
    found = on_calm_ground()
    for i in range(300):
        found.update(step(tractor=(1.3, 2.0), joint=2.0 * DEGREE * (i >= 290)), engaged=True)
    assert not found.is_active


def test_before_anything_is_known_of_the_ground_more_may_differ():
    differing = step(joint=4.0 * DEGREE)
    assert not exclusion(differing, 10).is_active
    assert exclusion(step(joint=4.5 * DEGREE), 5).excludes_trailer
    found = on_calm_ground(time=10.0)
    for _ in range(5):
        found.update(differing, engaged=True)
    assert found.excludes_trailer


def test_differences_that_change_sides_are_noise():
    found = FaultExclusion(SanitySettings(), VehicleParameters(), 0.2)
    for _ in range(20):
        found.update(step(hitch=SEEN.hitch_angle + 8.0 * DEGREE), engaged=True)
        found.update(step(hitch=SEEN.hitch_angle - 8.0 * DEGREE), engaged=True)
        assert not found.is_active


def driven(usual, samples=300, speed=1.0):
    """Return what is left of a drive in which the joint differs by so much to both sides in turn, a second each."""
    found = FaultExclusion(SanitySettings(), VehicleParameters(), 0.2)
    for i in range(samples):
        found.update(step(joint=math.copysign(usual * DEGREE, i % 10 - 4.5), speed=speed), engaged=True)
        assert not found.is_active
    return found


def is_doubted(found, difference=4.0):
    for _ in range(5):
        found.update(step(joint=difference * DEGREE), engaged=True)
    return found.is_active


def test_on_rough_ground_more_is_usual():
    assert is_doubted(driven(0.5))
    assert not is_doubted(driven(2.0))


def test_what_is_usual_is_learned_within_seconds_while_it_moves_only():
    assert not is_doubted(driven(2.0, samples=25))
    assert is_doubted(driven(2.0, speed=0.0), 4.5)
    assert not is_doubted(driven(2.0, samples=25), 4.5)


def test_a_difference_that_grows_is_not_usual():
    found = driven(0.2)
    for i in range(20):
        found.update(step(joint=0.2 * i * DEGREE), engaged=True)
    assert found.is_active


@pytest.mark.parametrize("sample_time", [0.05, 0.1])
def test_at_any_rate_they_are_averaged_over_a_second(sample_time):
    found = on_calm_ground(sample_time)
    differing = step(joint=2.9 * DEGREE)
    for _ in range(round(1.0 / sample_time) - 1):
        found.update(differing, engaged=True)
        assert not found.is_active
    found.update(differing, engaged=True)
    assert found.excludes_trailer


@pytest.mark.parametrize(
    "record", [step(hitch=0.2), step(hitch=math.nan), step(hitch=0.5, status=SolverStatus.NOT_FINITE)]
)
def test_what_is_near_missing_or_not_estimated_is_no_contradiction(record):
    assert not exclusion(record).is_active


def test_a_hitch_sensor_that_stands_still_while_the_estimate_turns_is_stuck():
    found = FaultExclusion(SanitySettings(), VehicleParameters(), 0.2)
    for angle in (0.1, 0.12, 0.14, 0.16, 0.18, 0.18):
        found.update(step(hitch=angle, measured_hitch=0.1), engaged=True)
        assert not found.excludes_trailer
    found.update(step(hitch=0.18, measured_hitch=0.1), engaged=True)
    assert found.excludes_trailer


@pytest.mark.parametrize(("usual", "turn", "after"), [(1, 1.6, 4), (1, 1.3, math.inf), (3, 1.6, 6), (8, 1.6, math.inf)])
def test_one_that_hardly_ever_repeats_itself_is_stuck_after_a_small_turn(usual, turn, after):
    """`usual`: samples for which it usually shows the same angle, in steps of 1 degree."""
    found = on_calm_ground(time=0.0)
    for i in range(96):
        found.update(step(measured_hitch=0.1 + DEGREE * (i // usual % 2)), engaged=True)
        assert not found.is_active
    last = 0.1 + DEGREE * (95 // usual % 2)
    for i in range(1, 13):
        found.update(step(hitch=last - turn * DEGREE * (i > 1), measured_hitch=last), engaged=True)
        assert found.is_active is (i >= after)
