"""The slide: found from side-slips in all headings; a model that knows it drives as one whose side-slips are told."""

import math
from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from alone import Alone
from c_signals import Real

from drawbar.codegen import Unit
from drawbar.estimation.articulated import ArticulatedEstimation
from drawbar.estimation.settings import ArticulatedEstimatorSettings, SlideSettings
from drawbar.geometry import Floats
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise

UNIT = """
#include "slide.h"
#include "unit.h"
struct component { struct slide slide; };
#define COMPONENT_FIELDS SLIDE_FIELDS(component, slide)
int UNIT(begin)(struct component *component) { slide_begin(&component->slide); return 0; }
int UNIT(take)(struct component *component, double yaw, double push, double crab)
{
    slide_walk(&component->slide);
    slide_take(&component->slide, (struct axle){yaw, push}, crab);
    return 0;
}
"""


def found(yaws: Floats, pushes: Floats, crabs: Floats, **settings: float) -> Floats:
    """Return east, north, creep and constant after these side-slips.

    Args:
        yaws: (n,) rad.
        pushes: (n,) side accelerations, g.
        crabs: (n,) side-slips, rad.
        settings: other than the defaults.
    """
    values = {f"slide.{name}": value for name, value in SlideSettings(**settings)}
    alone = Alone(Unit(name="slide", source=UNIT, configure=lambda workspace: workspace.write(values)))
    alone.call("begin")
    for yaw, push, crab in zip(yaws.tolist(), pushes.tolist(), crabs.tolist(), strict=True):
        alone.call("take", Real(yaw), Real(push), Real(crab))
    return alone.live.array("slide.value").copy()


def test_it_is_regularised_least_squares() -> None:
    rng = np.random.default_rng(0)
    yaws, crabs = rng.uniform(-9.0, 9.0, 80), rng.normal(0.0, 0.03, 80)
    pushes = rng.normal(0.0, 0.1, 80)
    rows = np.column_stack([-np.sin(yaws), np.cos(yaws), -pushes, np.ones(80)])
    settings = {"prior": 0.04, "walk": 0.0, "creep_prior": 0.3, "constant_prior": 0.01, "noise": 0.05}
    information = np.diag([0.04**-2, 0.04**-2, 0.3**-2, 0.01**-2]) + rows.T @ rows / 0.05**2
    expected = np.linalg.solve(information, rows.T @ crabs / 0.05**2)
    np.testing.assert_allclose(found(yaws, pushes, crabs, **settings), expected, rtol=1e-9)


def test_what_is_the_same_in_the_world_is_told_from_what_is_the_same_for_the_vehicle() -> None:
    yaws = np.linspace(0.0, 4.0 * math.pi, 2000)
    pushes = 0.05 * np.sign(np.sin(0.5 * yaws))
    crabs = 0.005 + 0.02 * np.sin(yaws) - 0.03 * np.cos(yaws) - 0.3 * pushes
    east, north, creep, constant = found(yaws, pushes, crabs)
    assert (east, north, constant) == pytest.approx((-0.02, -0.03, 0.005), abs=0.003)
    assert creep == pytest.approx(0.3, abs=0.03)


def test_side_slips_that_are_no_numbers_are_left_out() -> None:
    yaws, crabs = np.linspace(0.0, 6.0, 40), np.full(40, 0.01)
    crabs[10] = math.nan
    assert np.isfinite(found(yaws, np.zeros(40), crabs)).all()


def test_a_model_on_a_slide_moves_as_one_whose_side_slips_are_told() -> None:
    vehicle, settings = VehicleParameters(), ArticulatedEstimatorSettings(model="articulated")
    on_slide = ArticulatedEstimation(vehicle, SensorNoise(), settings, 0.2).problem.model
    plain, (east, north, creep) = articulated(vehicle).numeric(), (0.02, -0.03, 0.4)
    assert [each.name for each in on_slide.constants[-3:]] == ["slide_east", "slide_north", "creep"]
    lengths = [each.value for each in on_slide.constants[:-3]]
    symbols = [on_slide.x, on_slide.u, on_slide.p]
    one = ca.Function("one", [*symbols, on_slide.c], [on_slide.derivative])
    other = ca.Function("other", [plain.x, plain.u, plain.p], [plain.derivative])
    rng = np.random.default_rng(2)
    for _ in range(20):
        x = rng.normal(0.0, 1.0, 6) * [1, 1, 3, 1, 0.2, 0.2]
        u = rng.normal(0.0, 0.2, 2)
        x[3] = x[2] + 0.2 * x[3]
        p = np.array([0.9, 0.95, 0.01, 0.02, 1.3, 0.01])  # b = alpha_r: the tractor turns as if neither were
        still = np.array(other(x, [0.0, 0.0], p * [1, 1, 0, 0, 1, 0])).ravel()
        turned = math.tan(0.95 * x[4]) / vehicle.wheelbase * 0.9 * 1.3
        assert turned == pytest.approx(still[2])
        pushes = 0.9 * 1.3 * still[2:4] / 9.81
        drawn = [
            north * math.cos(yaw) - east * math.sin(yaw) - creep * push
            for yaw, push in zip(x[2:4], pushes, strict=True)
        ]
        whole = p + np.array([0.0, 0.0, drawn[0], drawn[1], 0.0, drawn[0]])
        np.testing.assert_allclose(one(x, u, p, [*lengths, east, north, creep]), other(x, u, whole), atol=1e-12)


@pytest.mark.parametrize("name", ["articulated", "articulated-ekf"])
def test_on_a_slope_the_next_curve_is_known(name: str, simulate: Callable) -> None:
    field = ("path.radii=[8.0]", "machine.terrain={slope=0.0873, creep=0.36}")
    known = simulate(name, *field)
    unknown = simulate(name, *field, "estimator.slide.prior=0.0")
    means = [np.abs(run.true_errors("trailer").error).mean() for run in (known, unknown)]
    assert means[0] < 0.9 * means[1]
    error = known.column("estimate", "trailer_crab") - known.column("truth", "trailer_crab")
    before = unknown.column("estimate", "trailer_crab") - unknown.column("truth", "trailer_crab")
    assert error[200:].std() < before[200:].std()
