"""Slips, slopes and bumps act when and how they say. Seeds are fixed."""

import math

import numpy as np
import pytest

from drawbar.geometry import Floats
from drawbar.machine.events import Bump, Event, SideSlope, SlipStep
from drawbar.machine.ground import Ground, reflected
from drawbar.machine.settings import CrabProcess, GroundSettings, SlipProcess

STEP = 0.01
TIMES = STEP * np.arange(2000.0)


def effects(*events: Event, settings: GroundSettings | None = None, seed: int = 5) -> Floats:
    ground = Ground(settings or GroundSettings(), events, STEP, np.random.default_rng(seed))
    return ground.block(TIMES)


def test_slips_have_the_statistics_of_their_settings() -> None:
    """1,000 seeds of the first step: means to 4 standard errors, deviations to 4 times 2.2 %."""
    first = np.array(
        [Ground(GroundSettings(), (), STEP, np.random.default_rng(s)).block(TIMES[:1])[0] for s in range(1000)]
    )
    deviations = np.array([0.02, 0.03, math.radians(0.4), math.radians(0.4)])
    means = np.array([0.95, 0.92, 0.0, 0.0])
    slips = first[:, [0, 1, 3, 4]]
    assert np.all(np.abs(slips.mean(axis=0) - means) < 4.0 * deviations / math.sqrt(1000))
    assert slips.std(axis=0) == pytest.approx(deviations, rel=0.09)


def test_slip_factors_never_leave_0_to_1() -> None:
    wild = SlipProcess(mean=0.95, deviation=0.2, time_constant=0.1)
    slips = effects(settings=GroundSettings(longitudinal_slip=wild, tractor_slip=wild))[:, :2]
    assert slips.min() >= 0.0
    assert slips.max() <= 1.0
    assert slips.max() > 0.99, "the reflection was never reached, so this shows nothing"


def test_reflection_folds_at_both_ends() -> None:
    assert reflected(np.array([-0.1, 0.0, 0.4, 1.0, 1.3])) == pytest.approx([0.1, 0.0, 0.4, 1.0, 0.7])


def test_offset_is_constant() -> None:
    assert np.all(effects(settings=GroundSettings(steering_offset=-0.01))[:, 2] == -0.01)


def test_slip_step_moves_one_mean_from_its_start_on() -> None:
    """A mean far from 1 is not reflected, so the wandering around it stays what it was."""
    calm, stepped = effects(), effects(SlipStep(start=8.6, factor="tractor_slip", value=0.7))
    assert np.array_equal(calm[:860], stepped[:860])
    steady = GroundSettings(tractor_slip=SlipProcess(mean=0.7, deviation=0.03))
    assert np.array_equal(stepped[860:, 1], effects(settings=steady)[860:, 1])
    assert np.array_equal(np.delete(calm, 1, axis=1), np.delete(stepped, 1, axis=1))


def test_later_slip_step_overrules_whatever_the_order() -> None:
    early = SlipStep(start=2.0, factor="longitudinal_slip", value=0.6)
    late = SlipStep(start=4.0, factor="longitudinal_slip", value=0.8)
    firm = GroundSettings(longitudinal_slip=SlipProcess(mean=1.0, deviation=0.0))
    for events in ((early, late), (late, early)):
        mu = effects(*events, settings=firm)[:, 0]
        assert [mu[199], mu[200], mu[399], mu[400]] == pytest.approx([1.0, 0.6, 0.6, 0.8])


def test_side_slope_adds_one_crab_to_all_axles() -> None:
    change = effects(SideSlope(start=5.0, crab=-0.05, ramp=2.0)) - effects()
    expected = -0.05 * np.clip((TIMES - 5.0) / 2.0, 0.0, 1.0)
    for column in (2, 3, 4):
        assert change[:, column] == pytest.approx(expected, abs=1e-15)
    assert not change[:, [0, 1, 5, 6, 7]].any()


@pytest.mark.parametrize("start", [0.0, 8.6, 8.604, 19.99])
def test_bump_strikes_exactly_once(start: float) -> None:
    change = effects(Bump(start=start, lateral=0.05, tractor_yaw=0.04, trailer_yaw=-0.03)) - effects()
    (struck,) = np.nonzero(change.any(axis=1))
    assert struck.tolist() == [math.ceil(round(start / STEP, 6))]
    assert change[struck[0]] == pytest.approx([0.0, 0.0, 0.0, 0.0, 0.0, 0.05, 0.04, -0.03], abs=1e-15)


def test_calm_ground_is_exactly_its_mean() -> None:
    crab = CrabProcess(mean=0.02, deviation=0.0)
    calm = SlipProcess(mean=0.9, deviation=0.0)
    settings = GroundSettings(longitudinal_slip=calm, tractor_slip=calm, tractor_crab=crab, trailer_crab=crab)
    assert effects(settings=settings)[:, :5] == pytest.approx(np.tile([0.9, 0.9, 0.0, 0.02, 0.02], (2000, 1)))
