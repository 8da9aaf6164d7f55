"""Latency and scale errors of hitch and joint that no sensor tells, found from the ways of both axles."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from alignment import Alignment
from alone import Alone
from c_signals import Real
from ordinary import believed, measured

from drawbar.codegen import Unit
from drawbar.geometry import Floats, wrap
from drawbar.signals import FixStatus, Pose
from drawbar.vehicle.articulated import trailer_antenna, trailer_yaw_rate
from drawbar.vehicle.lengths import length_values
from drawbar.vehicle.parameters import VehicleParameters

UNIT = """
#include "angle_errors.h"
#include "unit.h"
struct component { struct angle_errors errors; double points[4]; };
#define COMPONENT_FIELDS FIELD(component, errors.latency, 0, 1, 0, 0) FIELD(component, points, 0, 4, 0, 0) \\
    FIELD(component, errors.scales, 0, ANGLES, 0, 0) FIELD(component, errors.state, 0, ANGLE_STATES, 0, 0) \\
    FIELD(component, errors.covariance, 0, ANGLE_STATES, ANGLE_STATES, 0)
int UNIT(taken)(struct component *component, double yaw, double hitch, double joint, double bent, double swung,
                double creep, double sways, double ahead, double elapsed)
{
    struct angle_sample sample = {.yaw = yaw, .angles = {hitch, joint}, .bent = bent, .swung = swung, .creep = creep,
                                  .sways = sways > 0.0};

    memcpy(sample.points, component->points, sizeof sample.points);
    angle_errors_take(&component->errors, &sample, ahead, elapsed);
    return 0;
}
"""
SAMPLE, PARTS = 0.2, 20
DEGREE = math.pi / 180.0
VEHICLE = VehicleParameters()
LENGTHS = length_values(VEHICLE)


class Angles(Alone):
    """What finds the errors, by itself."""

    def __init__(self, *, sways: bool = False) -> None:
        """sways: the antennas stand on masts whose roll is not measured."""
        self._sways = float(sways)
        super().__init__(Unit(name="angle_errors", source=UNIT, configure=lambda workspace: None))

    def take(
        self,
        points: Floats,
        yaw: float,
        angles: tuple[float, float],
        bent: float,
        *,
        swung: float = 0.0,
        creep: float = 0.0,
    ) -> None:
        """Take in positions (4,) of both bodies, m, yaw, angles, and the expected changes of hitch and joint, rad."""
        self.live.array("points")[:] = points
        self.call("taken", *map(Real, (yaw, *angles, bent, swung, creep, self._sways, VEHICLE.trailer_antenna, SAMPLE)))

    @property
    def found(self) -> Floats:
        """Unexplained distance, m; constant error, rad; scale errors of hitch and joint; latency, s."""
        return self.live.array("errors.state").copy()

    @property
    def deviations(self) -> Floats:
        """Of the same."""
        deviations: Floats = np.sqrt(np.diag(self.live.array("errors.covariance")))
        return deviations

    @property
    def latency(self) -> float:
        """Corrected for, s."""
        return float(self.live.array("errors.latency").item())

    @property
    def scales(self) -> Floats:
        """Of hitch and joint: true per measured angle, less 1, as corrected for."""
        return self.live.array("errors.scales").copy()


@dataclass(frozen=True)
class Drive:
    """A drive of tractor and trailer, at parts of a sample each: what is true."""

    points: Floats
    """(n, 4): x, y of the rear axle and of the trailer's point, m"""
    yaw: Floats
    """(n,) rad"""
    hitch: Floats
    """(n,) rad"""
    joint: Floats
    """(n,) rad"""

    def hitch_at(self, k: int, age: float) -> float:
        """Return the hitch angle at a sample, so long ago (s), rad."""
        return float(np.interp((k - age / SAMPLE) * PARTS, np.arange(self.hitch.size), self.hitch))


def drive(samples: int, speed: float = 2.0, creep: float = 0.0, curve: float = 0.25, weave: float = 0.1) -> Drive:
    """Return a drive along an eight on which the tractor and the joint weave.

    Args:
        samples: their number.
        speed: m/s.
        creep: side-slip by lateral acceleration, rad/g.
        curve: yaw rate on the circles, rad/s.
        weave: yaw rate on top, rad/s; the joint's angle, rad.
    """
    x = y = yaw = psi = turn = 0.0
    points, yaws, hitches, joints = [], [], [], []
    step = SAMPLE / PARTS
    for k in range(samples * PARTS):
        time = k * step
        lap = (time + 30.0) % 40.0
        rate = weave * math.sin(0.9 * time) + (curve if lap < 15.0 else -curve if 20.0 <= lap < 35.0 else 0.0)
        joint, joint_rate = weave * math.sin(0.5 * time), 0.5 * weave * math.cos(0.5 * time)
        crab, trailer_crab = -creep * speed * rate / 9.81, -creep * speed * turn / 9.81
        points.append([x, y, *map(float, trailer_antenna(LENGTHS, x, y, yaw, psi, joint))])
        yaws.append(yaw)
        hitches.append(yaw - psi - joint)
        joints.append(joint)
        turn = float(trailer_yaw_rate(LENGTHS, speed, rate, yaw - psi, joint, joint_rate, crab, trailer_crab))
        x += step * speed * math.cos(yaw + 0.5 * step * rate + crab) / math.cos(crab)
        y += step * speed * math.sin(yaw + 0.5 * step * rate + crab) / math.cos(crab)
        yaw, psi = yaw + step * rate, psi + step * turn
    return Drive(np.array(points), np.array(yaws), np.array(hitches), np.array(joints))


@pytest.fixture(scope="module")
def eight() -> Drive:
    """Two minutes of it at 2 m/s."""
    return drive(600)


def follow(
    angles: Angles,
    driven: Drive,
    latency: float,
    *,
    offset: float = 0.0,
    scale: float = 1.0,
    joint_scale: float = 1.0,
    fix_latency: float = 0.0,
    creep: float = 0.0,
    every: int = 1,
    seen: Callable[[int, Floats, float], tuple[Floats, float]] = lambda k, points, angle: (points, angle),
    seed: int = 3,
) -> list[float]:
    """Drive with angles that are corrected by what is found; return the latency that is, at each sample, s.

    Args:
        angles: finds the errors.
        driven: the true drive.
        latency: of the hitch angle, s.
        offset: constant error of the hitch angle, rad.
        scale: measured hitch angle per true one.
        joint_scale: the same of the joint's.
        fix_latency: of the fixes, s.
        creep: that is known, rad/g.
        every: a new fix comes with each so manieth sample; the last one is repeated in between.
        seen: from index, positions and hitch angle to those that are measured.
        seed: of the noise.
    """
    rng, reckoned, shown = np.random.default_rng(seed), [], np.zeros(4)
    for k in range(2, len(driven.yaw) // PARTS):
        now, before = driven.hitch_at(k, 0.0), driven.hitch_at(k, SAMPLE)
        noisy = driven.points[round((k - fix_latency / SAMPLE) * PARTS)] + rng.normal(0.0, 0.02, 4)
        shown = noisy if k % every == 0 else shown
        angle = scale * driven.hitch_at(k, latency) + offset + rng.normal(0.0, 0.5 * DEGREE)
        points, angle = seen(k, shown, angle)
        hitch = angle * (1.0 + angles.scales[0]) + angles.latency / SAMPLE * (now - before)
        joint = joint_scale * driven.joint[k * PARTS] * (1.0 + angles.scales[1])
        yaw = wrap(driven.yaw[k * PARTS] + rng.normal(0.0, 0.5 * DEGREE))
        angles.take(points, yaw, (hitch, joint), now - before, creep=creep)
        reckoned.append(angles.latency)
    return reckoned


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


def late_by_alignment(driven: Drive, **values: Any) -> float:
    """Return the latency that alignment finds of a hitch angle 0.15 s late, s; of estimates with these values."""
    alignment, last = Alignment(VEHICLE), None
    for k in range(2, len(driven.yaw) // PARTS):
        points, yaw, joint = driven.points[k * PARTS], driven.yaw[k * PARTS], driven.joint[k * PARTS]
        hitch, late = driven.hitch_at(k, 0.0), driven.hitch_at(k, 0.15)
        tractor = Pose(x=points[0], y=points[1], yaw=yaw)
        trailer = Pose(x=points[2], y=points[3], yaw=yaw - hitch - joint)
        now = replace(believed(tractor, trailer, time=k * SAMPLE, speed=2.0, hitch_angle=hitch), **values)
        if last is not None:
            seen = measured(*points, time=now.time, speed=2.0, hitch_angle=late, trailer_steering=joint)
            alignment.apply(seen, last, now)
        last = now
    return alignment.found().hitch_latency


def test_the_creep_that_is_estimated_counts() -> None:
    soft = drive(300, creep=0.36)
    assert late_by_alignment(soft) < 0.07
    assert 0.1 < late_by_alignment(soft, creep=0.36) < 0.16


@pytest.mark.parametrize("antenna", ["tractor_fix", "trailer_fix"])
def test_while_positions_of_an_antenna_are_rejected_nothing_is_learned(antenna: str) -> None:
    driven = drive(300)
    assert late_by_alignment(driven) > 0.1
    assert late_by_alignment(driven, **{antenna: FixStatus.REJECTED}) == 0.0


@pytest.mark.parametrize("age", [math.nan, 0.0, 0.05])
def test_what_is_found_adds_to_the_age_that_is_told(age: float) -> None:
    alignment = Alignment(VEHICLE)
    alignment.live.array("angles.latency")[...] = 0.1
    before = believed(Pose(x=0.0, y=0.0, yaw=0.0), Pose(x=-2.15, y=0.0, yaw=0.0), time=1.0)
    now = replace(before, time=1.2, hitch_angle=0.06)
    aligned = alignment.apply(
        measured(0.0, 0.0, -2.15, 0.0, time=1.2, hitch_angle=0.02, hitch_angle_age=age), before, now
    )
    assert aligned.hitch_angle == pytest.approx(0.02 + 0.3 * (0.1 + (0.0 if math.isnan(age) else age)), abs=1e-12)
