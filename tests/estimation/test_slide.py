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
from drawbar.estimation.description import EstimationModel
from drawbar.estimation.settings import ArticulatedEstimatorSettings, SlideSettings
from drawbar.geometry import Floats
from drawbar.optimal.transcription import transcribe
from drawbar.signals import Measurement
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.measured import MEASURED
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise

UNIT = """
#include "slide.h"
#include "unit.h"
struct component { struct slide slide; double told[3]; };
#define COMPONENT_FIELDS SLIDE_FIELDS(component, slide) FIELD(component, told, 0, 3, 0, 0)
int UNIT(begin)(struct component *component) { slide_begin(&component->slide); return 0; }
int UNIT(stand)(struct component *component, double yaw, double roll, double pitch)
{
    slide_attitude(&component->slide, yaw, roll, pitch, 0.2);
    return 0;
}
int UNIT(drive)(struct component *component, double speed)
{
    slide_at_speed(&component->slide, speed, 1.4);
    slide_coefficients(&component->slide, component->told);
    return 0;
}
int UNIT(take)(struct component *component, double yaw, double push, double crab)
{
    slide_forget(&component->slide);
    slide_update(&component->slide, (struct axle){yaw, push}, crab);
    slide_coefficients(&component->slide, component->told);
    return 0;
}
"""


LEVEL = (math.nan, math.nan)
"""a body whose attitude nobody knows"""


def after(yaws: Floats, pushes: Floats, crabs: Floats, slope: tuple[float, float] = LEVEL, **settings: float) -> Alone:
    """Return the slide after these side-slips.

    Args:
        yaws: (n,) rad.
        pushes: (n,) side accelerations, g.
        crabs: (n,) side-slips, rad.
        slope: rise per metre to the east and to the north, on which a body stands without its own lean.
        settings: other than the defaults.
    """
    values = {f"slide.{name}": value for name, value in SlideSettings(**settings)}
    alone = Alone(Unit(name="slide", source=UNIT, configure=lambda workspace: workspace.write(values)))
    alone.call("begin")
    east, north = slope
    for yaw, push, crab in zip(yaws.tolist(), pushes.tolist(), crabs.tolist(), strict=True):
        pitch = math.atan(east * math.cos(yaw) + north * math.sin(yaw))
        alone.call("stand", Real(yaw), Real(math.atan(north * math.cos(yaw) - east * math.sin(yaw))), Real(pitch))
        alone.call("take", Real(yaw), Real(push), Real(crab))
    return alone


def found(yaws: Floats, pushes: Floats, crabs: Floats, slope: tuple[float, float] = LEVEL, **settings: float) -> Floats:
    """Return east, north, creep, constant and the curve's creep beyond after these side-slips."""
    return after(yaws, pushes, crabs, slope, **settings).live.array("slide.value").copy()


def test_it_is_regularised_least_squares() -> None:
    rng = np.random.default_rng(0)
    yaws, crabs = rng.uniform(-9.0, 9.0, 80), rng.normal(0.0, 0.03, 80)
    pushes = rng.normal(0.0, 0.1, 80)
    rows = np.column_stack([-np.sin(yaws), np.cos(yaws), -pushes, np.ones(80)])
    settings = {"prior": 0.04, "walk": 0.0, "creep_prior": 0.3, "constant_prior": 0.01, "noise": 0.05}
    information = np.diag([0.04**-2, 0.04**-2, 0.3**-2, 0.01**-2]) + rows.T @ rows / 0.05**2
    expected = np.linalg.solve(information, rows.T @ crabs / 0.05**2)
    np.testing.assert_allclose(found(yaws, pushes, crabs, **settings), [*expected, 0.0], rtol=1e-9)


def test_on_a_slope_that_is_seen_it_is_regularised_least_squares_with_creep_in_both() -> None:
    rng = np.random.default_rng(0)
    yaws, crabs = rng.uniform(-9.0, 9.0, 80), rng.normal(0.0, 0.03, 80)
    pushes, slope = rng.normal(0.0, 0.1, 80), (0.05, -0.08)
    falls = slope[0] * np.sin(yaws) - slope[1] * np.cos(yaws)  # to the left
    rows = np.column_stack([-np.sin(yaws), np.cos(yaws), falls - pushes, np.ones(80), -pushes])
    settings = {"walk": 0.0, "beyond_slope": 0.02, "creep_prior": 0.3, "constant_prior": 0.01, "noise": 0.05}
    information = np.diag(np.array([0.02, 0.02, 0.3, 0.01, 0.3]) ** -2) + rows.T @ rows / 0.025**2
    expected = np.linalg.solve(information, rows.T @ crabs / 0.025**2)
    np.testing.assert_allclose(found(yaws, pushes, crabs, slope, **settings), expected, rtol=1e-9)


def test_a_straight_line_on_a_slope_that_is_seen_shows_the_next_curve() -> None:
    """Five seconds to the east on a slope of 5 degrees to the south, on ground that creeps by 0.36 of it."""
    straight = np.zeros(25), np.zeros(25), np.full(25, -0.36 * 0.0873)
    assert found(*straight, (0.0, 0.0873))[2] > 0.2
    assert found(*straight)[2] == 0.0


def test_what_is_the_same_in_the_world_is_distinguished_from_what_is_the_same_for_the_vehicle() -> None:
    yaws = np.linspace(0.0, 4.0 * math.pi, 2000)
    pushes = 0.05 * np.sign(np.sin(0.5 * yaws))
    crabs = 0.005 + 0.02 * np.sin(yaws) - 0.03 * np.cos(yaws) - 0.3 * pushes
    east, north, creep, constant, _ = found(yaws, pushes, crabs)
    assert (east, north, constant) == pytest.approx((-0.02, -0.03, 0.005), abs=0.003)
    assert creep == pytest.approx(0.3, abs=0.03)


def test_an_antenna_aside_is_not_taken_for_soft_ground_before_a_curve_to_the_other_side() -> None:
    """Ten times around in one curve at 3 m/s, both axles 0.02 rad beside their way: 10 cm in 5 m."""
    yaws = np.linspace(0.0, 20.0 * math.pi, 5000)
    creep, constant = found(yaws, np.full(5000, 3.0**2 / 25.0 / 9.81), np.full(5000, -0.02))[2:4]
    assert creep < 0.25
    assert constant < -0.01


@pytest.mark.parametrize("slope", [LEVEL, (0.0, 0.0)])
@pytest.mark.parametrize(("side", "told"), [(-0.2, 0.2), (0.2, 0.0)])
def test_side_slips_out_of_a_curve_are_creep_and_into_it_are_none(
    slope: tuple[float, float], side: float, told: float
) -> None:
    """An estimate that lags in a swing shows the latter; a model that believed them would let the swing grow."""
    pushes = 0.15 * np.sin(0.7 * np.arange(2000))
    alone = after(np.zeros(2000), pushes, side * pushes, slope, walk=0.0)
    assert alone.live.array("told")[2] == pytest.approx(told, abs=0.01)


def test_creep_is_in_effect_as_far_as_it_moves_an_axle_ahead_by_a_fifth_of_the_wheelbase() -> None:
    pushes = 0.15 * np.sin(0.7 * np.arange(2000))
    alone = after(np.zeros(2000), pushes, -0.6 * pushes, walk=0.0)
    creep = []
    for speed in (0.0, 1.0, 2.5, -2.5, 3.0, 1.0):
        alone.call("drive", Real(speed))
        creep.append(alone.live.array("told")[2])
    limits = [0.2 * 1.4 * 9.80665 / speed**2 for speed in (2.5, 3.0)]
    assert creep == pytest.approx([0.6, 0.6, limits[0], limits[0], limits[1], 0.6], abs=0.01)


def test_antennas_that_stand_aside_to_opposite_sides_let_nothing_oscillate_at_speed(simulate: Callable) -> None:
    """By 20 cm at a distance of 2.2 m, where attitude is measured: a side-slip of 0.09 rad that no curve causes."""
    aside = "machine.masts={tractor={left=0.1},trailer={left=-0.1}}"
    attitude = "machine.attitude={tractor={present=true},trailer={present=true}}"
    run = simulate("articulated", "path.radii=[8.0]", "speed=3.0", aside, attitude)
    for body in ("tractor", "trailer"):
        assert np.abs(run.true_errors(body).error[50:]).max() < 0.3


def test_side_slips_that_are_no_numbers_are_left_out() -> None:
    yaws, crabs = np.linspace(0.0, 6.0, 40), np.full(40, 0.01)
    crabs[10] = math.nan
    assert np.isfinite(found(yaws, np.zeros(40), crabs)).all()


def on_slide(**settings: float) -> EstimationModel:
    chosen = ArticulatedEstimatorSettings(model="articulated", **settings)
    return ArticulatedEstimation(VehicleParameters(), SensorNoise(), chosen, 0.2)


def random_states(count: int) -> Floats:
    """Return (count, 12) states of the chain, its parameters behind them."""
    rng = np.random.default_rng(2)
    x = rng.normal(0.0, 1.0, (count, 12)) * [1, 1, 3, 1, 0.2, 0.2, 0, 0.1, 0.02, 0.02, 0.5, 0.02]
    x[:, 3] = x[:, 2] + 0.2 * x[:, 3]
    return x + np.array([0, 0, 0, 0, 0, 0, 0.9, 0.95, 0, 0, 1.3, 0])


def side_slips(x: Floats, slide: tuple[float, float, float], vehicle: VehicleParameters) -> tuple[float, float]:
    """Return at which angles slope and curve draw tractor and trailer, rad: docs/theory/lever-arm.md, by the chain."""
    (east, north, creep), plain = slide, articulated(vehicle).numeric()
    rates = ca.Function("rates", [plain.x, plain.u, plain.p], [plain.derivative])
    held = x[6:] * [1, 1, 0, 0, 1, 0]
    steered = np.array([*x[:4], (x[7] * x[4] + x[8] - x[11]) / x[7], x[5]])  # kappa delta + b - alpha_r
    turns = np.array(rates(steered, [0.0, 0.0], held)).ravel()[2:4]
    across = [
        north * math.cos(yaw) - east * math.sin(yaw) - creep * x[6] * x[10] * turn / 9.81
        for yaw, turn in zip(x[2:4], turns, strict=True)
    ]
    return across[0], across[1]


def test_a_model_on_a_slide_moves_as_one_whose_side_slips_are_reported() -> None:
    vehicle, slide = VehicleParameters(), (0.02, -0.03, 0.4)
    problem = on_slide().problem
    discrete, plain = transcribe(problem), articulated(vehicle).numeric()
    assert [each.name for each in discrete.constants[-4:]] == ["slide_east", "slide_north", "creep", "sample_time"]
    lengths = [each.value for each in discrete.constants[:-4]]
    constants = ca.vertcat(*(each.symbol for each in discrete.constants))
    one = ca.Function("one", [discrete.x, discrete.u, constants], [discrete.next_state])
    other = ca.Function("other", [plain.x, plain.u, plain.p], [integrate(plain, 0.2)])
    for x in random_states(20):
        u, (tractor, trailer) = x[:2] / 5.0, side_slips(x, slide, vehicle)
        whole = x[6:] + np.array([0.0, 0.0, tractor, trailer, 0.0, tractor])
        expected = np.concatenate([np.array(other(x[:6], u, whole)).ravel(), x[6:]])
        np.testing.assert_allclose(np.array(one(x, u, [*lengths, *slide, 0.2])).ravel(), expected, atol=1e-12)


def test_the_estimate_tells_the_side_slips_with_which_the_model_moves(compiled: Callable) -> None:
    slide, model = (0.02, -0.03, 0.4), compiled(on_slide())
    nothing = Measurement(time=0.0, **dict.fromkeys((each.name for each in MEASURED), math.nan))
    model.live.array("model.slide.value")[:3] = slide
    for x in random_states(20):
        model.state[:] = x
        told, (tractor, trailer) = model.estimate(nothing), side_slips(x, slide, VehicleParameters())
        found = [told.steering_offset, told.tractor_crab, told.trailer_crab]
        np.testing.assert_allclose(found, x[[8, 11, 9]] + np.array([tractor, tractor, trailer]), atol=1e-12)


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
