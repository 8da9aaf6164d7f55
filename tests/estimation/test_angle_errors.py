"""Latency and scale errors of hitch and joint that no sensor tells, found from the ways of both axles."""

import math

import numpy as np
import pytest
from angle_drive import DEGREE, PARTS, SAMPLE, VEHICLE, Angles, Drive, drive, follow

from drawbar.geometry import Floats


@pytest.fixture(scope="module")
def eight() -> Drive:
    """Two minutes of it at 2 m/s."""
    return drive(600)


@pytest.mark.parametrize(("offset", "scale"), [(0.0, 1.0), (1.5, 1.05), (-2.0, 0.9)])
@pytest.mark.parametrize("latency", [0.0, 0.1, 0.2])
def test_it_is_found_and_reckoned_with_as_far_as_it_is_sure(
    eight: Drive, latency: float, offset: float, scale: float
) -> None:
    reckoned = follow(angles := Angles(), eight, latency, offset=offset * DEGREE, scale=scale)
    assert angles.found[4] == pytest.approx(latency, abs=0.03)
    assert max(latency - 0.06, 0.0) <= angles.latency <= latency + 0.02
    assert reckoned[149] >= latency - 0.08  # within half a minute


@pytest.mark.parametrize("latency", [0.0, 0.15])
@pytest.mark.parametrize(("hitch", "joint"), [(0.7, 1.0), (1.3, 1.0), (1.0, 0.75), (1.0, 1.25), (1.2, 0.85)])
def test_scales_of_hitch_and_joint_are_found(eight: Drive, hitch: float, joint: float, latency: float) -> None:
    follow(angles := Angles(), eight, latency, scale=hitch, joint_scale=joint, offset=1.0 * DEGREE)
    expected = np.array([1.0 / hitch, 1.0 / joint]) - 1.0
    np.testing.assert_allclose(angles.found[2:4], expected, atol=0.06)
    np.testing.assert_allclose(angles.scales, expected, atol=0.12)


def test_a_scale_that_is_right_is_not_corrected(eight: Drive) -> None:
    for seed in range(10):
        follow(angles := Angles(), eight, 0.0, offset=1.0 * DEGREE, seed=seed)
        assert not angles.scales.any()


def test_a_scale_is_corrected_slowly_and_never_beyond_its_limit(eight: Drive) -> None:
    angles, scales = Angles(), []

    def noted(k: int, points: Floats, angle: float) -> tuple[Floats, float]:
        scales.append(angles.scales[0])
        return points, angle

    follow(angles, eight, 0.0, scale=0.5, seen=noted)
    assert max(scales) == pytest.approx(0.4)
    assert 0.0 < np.abs(np.diff(scales)).max() <= 0.05 * SAMPLE + 1e-12


def test_positions_that_jump_do_not_touch_the_scales(eight: Drive) -> None:
    angles, scales = Angles(), []

    def jumped(k: int, points: Floats, angle: float) -> tuple[Floats, float]:
        scales.append(angles.scales[0])
        return points + (np.array([2.0, 2.0, 0.0, 0.0]) if k >= 400 else 0.0), angle

    follow(angles, eight, 0.0, scale=0.8, seen=jumped)
    assert min(scales[380:]) > 0.15


@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_it_is_found_at_other_speeds(speed: float) -> None:
    follow(angles := Angles(), drive(600, speed, curve=0.125 * speed), 0.2)
    assert angles.found[4] == pytest.approx(0.2, abs=0.05)


def test_where_nothing_is_late_next_to_nothing_is_ever_corrected(eight: Drive) -> None:
    assert max(max(follow(Angles(), eight, 0.0, seed=seed)) for seed in range(10)) < 0.02


def test_what_is_reckoned_with_changes_slowly_and_never_beyond_its_limit(eight: Drive) -> None:
    reckoned = follow(Angles(), eight, 0.4)
    assert max(reckoned) == 0.25
    assert 0.0 < np.abs(np.diff(reckoned)).max() <= 0.1 * SAMPLE + 1e-12


def test_fixes_that_are_late_are_no_hitch_angle_that_is_early(eight: Drive) -> None:
    reckoned = follow(angles := Angles(), eight, 0.0, fix_latency=0.2)
    assert angles.found[4] == pytest.approx(-0.2, abs=0.05)
    assert max(reckoned) == 0.0


def test_along_a_straight_nothing_is_learned() -> None:
    follow(angles := Angles(), drive(200, curve=0.0, weave=0.0), 0.2)
    assert angles.latency == 0.0
    assert angles.deviations[4] > 0.09


def test_axles_that_drift_out_of_curves_do_not_hide_it() -> None:
    soft = drive(600, creep=0.36)
    follow(known := Angles(), soft, 0.15, creep=0.36)
    follow(unknown := Angles(), soft, 0.15)
    assert known.found[4] == pytest.approx(0.15, abs=0.03)
    assert unknown.found[4] == pytest.approx(0.15 - 0.36 * 2.0 / 9.81, abs=0.03)  # less than there is


@pytest.mark.parametrize("every", [2, 3])
@pytest.mark.parametrize("latency", [0.0, 0.2])
def test_fixes_may_come_less_often_than_samples(eight: Drive, latency: float, every: int) -> None:
    reckoned = follow(angles := Angles(), eight, latency, every=every)
    assert angles.found[4] == pytest.approx(latency, abs=0.03)
    assert max(reckoned) < latency + 0.02


def test_gaps_of_fixes_and_angle_cost_no_more_than_they_last(eight: Drive) -> None:
    def gappy(k: int, points: Floats, angle: float) -> tuple[Floats, float]:
        return (np.full(4, math.nan) if k % 50 < 10 else points), (math.nan if k % 70 == 40 else angle)

    follow(angles := Angles(), eight, 0.2, seen=gappy)
    assert angles.found[4] == pytest.approx(0.2, abs=0.03)


def test_over_a_gap_that_is_long_no_ways_are_compared(eight: Drive) -> None:
    begins: list[bool] = []
    angles = Angles()

    def gappy(k: int, points: Floats, angle: float) -> tuple[Floats, float]:
        begins.append(k in {104, 205} and angles.found[0] == 0.0)  # just after the first pair of fixes
        return (np.full(4, math.nan) if k in {100, 101, 102, *range(200, 204)} else points), angle

    follow(angles, eight, 0.2, seen=gappy)
    assert [k + 2 for k, begun in enumerate(begins) if begun] == [205]


def test_a_single_false_position_teaches_nothing(eight: Drive) -> None:
    def false(k: int, points: Floats, angle: float) -> tuple[Floats, float]:
        return points + (np.array([2.0, 2.0, 0.0, 0.0]) if k == 300 else 0.0), angle

    follow(with_it := Angles(), eight, 0.2, seen=false)
    follow(without := Angles(), eight, 0.2)
    assert with_it.found[4] == pytest.approx(without.found[4], abs=0.01)


def test_where_the_antennas_have_moved_apart_it_begins_anew_and_what_is_corrected_fades(eight: Drive) -> None:
    def jumped(k: int, points: Floats, angle: float) -> tuple[Floats, float]:
        return points + (np.array([2.0, 2.0, 0.0, 0.0]) if k >= 300 else 0.0), angle

    reckoned = follow(angles := Angles(), eight, 0.2, seen=jumped)
    assert reckoned[290] > 0.15
    assert 0.0 <= min(reckoned[300:330]) < 0.1
    assert np.diff(reckoned).min() >= -0.1 * SAMPLE - 1e-12
    assert angles.found[4] == pytest.approx(0.2, abs=0.03)


def largest_scale_while_antennas_sway(driven: Drive, seed: int, *, sways: bool) -> float:
    """Return the largest correction while both go 10 cm (rms) aside, correlated over a second."""
    rng, aside, angles, largest = np.random.default_rng(seed), np.zeros(2), Angles(sways=sways), [0.0]

    def seen(k: int, points: Floats, angle: float) -> tuple[Floats, float]:
        largest.append(float(np.abs(angles.scales).max()))
        aside[:] = 0.8 * aside + 0.6 * rng.normal(0.0, 0.1, 2)
        across = np.array([-math.sin(driven.yaw[k * PARTS]), math.cos(driven.yaw[k * PARTS])])
        return points + np.outer(aside, across).ravel(), angle

    follow(angles, driven, 0.0, seen=seen)
    return max(largest)


@pytest.mark.parametrize("seed", range(4))
def test_masts_that_sway_look_less_like_a_scale_where_that_is_known(eight: Drive, seed: int) -> None:
    without, known = (largest_scale_while_antennas_sway(eight, seed, sways=sways) for sways in (False, True))
    assert known < 0.5 * without


def test_what_is_found_is_that_of_a_kalman_filter_in_textbook_form(eight: Drive) -> None:
    rng, tried, ahead = np.random.default_rng(1), Angles(), VEHICLE.trailer_antenna
    state, covariance = np.zeros(5), np.diag([0.05, 0.035, 0.1, 0.1, 0.1]) ** 2
    last: tuple[Floats, float, Floats] | None = None
    steady = 0
    for k in range(2, 300):
        points = eight.points[k * PARTS] + rng.normal(0.0, 0.02, 4)
        yaw, bent = float(eight.yaw[k * PARTS]), eight.hitch_at(k, 0.0) - eight.hitch_at(k, SAMPLE)
        swung = float(eight.joint[k * PARTS] - eight.joint[(k - 1) * PARTS])
        reckoned = np.array([0.0, 0.0, *tried.scales, tried.latency])
        angles = np.array([0.8 * eight.hitch_at(k, 0.15), 1.1 * float(eight.joint[k * PARTS])])
        tried.take(points, yaw, (float(angles[0]), float(angles[1])), bent, swung=swung, creep=0.1)
        if last is not None:
            moved, turned, closed = points - last[0], yaw - last[1], float(np.sum(angles - last[2]))
            middle, between = 0.5 * (yaw + last[1]), 0.5 * (angles + last[2])
            psi = middle - between.sum()
            way = moved[2:] @ [math.cos(psi), math.sin(psi)]
            across = moved[:2] @ [-math.sin(middle), math.cos(middle)] - moved[2:] @ [-math.sin(psi), math.cos(psi)]
            across += ahead * (turned - closed)
            F = np.eye(5)
            F[0] = [1.0, way, *(way * between), way / SAMPLE * bent]
            state = F @ state
            state[0] -= F[0] @ reckoned + 0.1 * (way / SAMPLE) ** 2 / 9.81 * closed + across
            covariance = F @ covariance @ F.T
            covariance += np.diag([(0.02 * way) ** 2, *(SAMPLE * np.square([0.005, 0.001, 0.001, 0.002]))])
            if abs(bent + swung) < 0.03 * SAMPLE:  # both scales are measured as zero, one after the other
                for i in (2, 3):
                    gain = covariance[i] / (covariance[i, i] + SAMPLE / way**2)
                    state = state - gain * state[i]
                    covariance = covariance - np.outer(gain, covariance[i])
                    steady += 1
            gain = covariance[0] / (covariance[0, 0] + 0.05**2)
            state = state - gain * state[0]
            covariance = covariance - np.outer(gain, covariance[0])
        last = points, yaw, angles
        np.testing.assert_allclose(tried.found, state, rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(tried.deviations, np.sqrt(np.diag(covariance)), rtol=1e-9)
    assert tried.scales.any()  # corrections were part of it
    assert 20 < steady < 2 * 250  # and so were steady angles, and those that change
