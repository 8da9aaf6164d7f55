"""The least error of linear controllers: against noise that is drawn, and the simulated machine."""

import math
import sys
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import expm

from drawbar.config import load_configuration
from drawbar.machine.events import SideSlope
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.machine.simulated import SimulatedMachine
from drawbar.signals import Command, Pose
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.parameters import VehicleParameters

NAME = "steering-activity"
VEHICLE = VehicleParameters()
LIMITS = np.array([VEHICLE.tractor_steering_limit, VEHICLE.trailer_steering_limit])
SETTLED = 100
"""samples"""


@pytest.fixture
def limit(analysis):
    """Return the module that computes the limits."""
    return sys.modules[analysis.straight.__module__]


def designed(limit, design, price):
    """Return filter and regulator of a design for a price of steering, and what they come to in its own world."""
    point = limit.best(design, design, price)
    return limit.kalman_gain(design), limit.regulator(design, 1.0 / point.errors, price / point.rates), point


def drawn(world, design, K, G, runs, samples):
    """Return both distances and both angles (samples, 4, runs) of a loop with noise that is drawn."""
    rng = np.random.default_rng(7)
    roots = [np.linalg.cholesky(each + 1e-18 * np.eye(len(each))) for each in (world.Q, world.R)]
    state, estimate, found = np.zeros((8, runs)), np.zeros((8, runs)), []
    for _ in range(samples):
        command = G @ estimate
        state = world.A @ state + world.B @ command + roots[0] @ rng.standard_normal((8, runs))
        seen = world.C @ state + roots[1] @ rng.standard_normal((5, runs))
        expected = design.A @ estimate + design.B @ command
        estimate = expected + K @ (seen - design.C @ expected)
        found.append(np.vstack([world.C[:2] @ state, state[3:5]]))
    return np.array(found[SETTLED:])


def spreads(found):
    """Return standard deviations of distances and steering rates."""
    rates = np.diff(found[:, 2:], axis=0) / 0.2
    return found[:, :2].std(axis=(0, 2)), rates.std(axis=(0, 2))


@pytest.mark.parametrize("price", [0.01, 0.06])
def test_noise_that_is_drawn_comes_to_what_is_computed(limit, price) -> None:
    world = limit.straight(1.0)
    assumed = replace(world, Q=4.0 * world.Q)  # another design than the world's, as the product's is
    for design in (world, assumed):
        K, G, _ = designed(limit, design, price)
        point = limit.evaluated(world, design, K, G)
        errors, rates = spreads(drawn(world, design, K, G, runs=200, samples=600))
        assert errors == pytest.approx(point.errors, rel=0.02)
        assert rates == pytest.approx(point.rates, rel=0.02)


def test_another_noise_does_not_come_to_it(limit) -> None:
    world = limit.straight(1.0)
    K, G, point = designed(limit, world, 0.03)
    for other in (replace(world, Q=1.2 * world.Q), replace(world, R=1.2 * world.R)):
        errors, _ = spreads(drawn(other, world, K, G, runs=200, samples=600))
        assert not np.allclose(errors, point.errors, rtol=0.02, atol=0.0)


def test_no_weights_and_no_gains_are_better_than_the_front(limit) -> None:
    world, random = limit.straight(1.0), np.random.default_rng(3)
    front = limit.front(world, world)
    K, G, _ = designed(limit, world, 0.03)
    near = []
    for _ in range(40):
        lateral, steering = np.exp(random.uniform(-1.0, 1.0, 2)), 10.0 ** random.uniform(-2.5, -1.0, 2) / 20.0
        other = limit.evaluated(world, world, K, limit.regulator(world, lateral, steering))
        changed = [each * random.uniform(0.8, 1.25, each.shape) for each in (K, G)]
        for point in (other, limit.evaluated(world, world, *changed)):
            least = front.error_at(point.rate)
            assert math.isnan(least) or point.error > 0.9995 * least
            near.append(point.error / least)
    assert np.nanmin(near) < 1.01  # the front is not below them all: some come near


def test_the_filter_s_errors_and_the_regulator_are_independent(limit) -> None:
    """In its own world an estimate tells nothing of its error: errors are those of estimates and of the rest."""
    world = limit.straight(2.0)
    points = [limit.best(world, world, price) for price in (0.01, 0.1)]
    assert points[0].estimates == pytest.approx(points[1].estimates)
    assert (points[0].errors > points[0].estimates).all()


def chain_rates(speed):
    """Return how the estimator's chain moves about driving straight on, by states, steering rates and side-slips."""
    model, ground = articulated(VEHICLE), SimulatedMachineSettings().ground
    lengths = [ca.vertcat(*(getattr(each, name) for each in model.constants)) for name in ("symbol", "value")]
    given = model.x, model.u, model.p
    derivatives = [ca.substitute(ca.jacobian(model.derivative, each), *lengths) for each in given]
    slips = ground.longitudinal_slip.mean, ground.tractor_slip.mean
    at = ca.Function("rates", given, derivatives)(np.zeros(6), np.zeros(2), [*slips, 0.0, 0.0, speed, 0.0])
    return (np.array(each)[1:] for each in at)


@pytest.mark.parametrize("speed", [1.0, 2.0])
def test_the_sampled_machine_is_the_product_s_model(limit, speed) -> None:
    """The simulated plant, differentiated, against the estimator's own chain, which shares no code with it."""
    moved, steered, driven = chain_rates(speed)
    lag, rates = VEHICLE.steering_lag, np.zeros((10, 10))
    rates[:5, :5] = moved[:, 1:] - steered @ np.eye(5)[3:] / lag
    offset, tractor_crab, trailer_crab = driven[:, (2, 5, 3)].T
    rates[:5, 5:8] = np.transpose([offset + tractor_crab + trailer_crab, tractor_crab, trailer_crab])
    rates[:5, 8:] = steered / lag
    rates[[6, 7], [6, 7]] = -0.2  # side-slips, 5 s
    sampled, world = expm(limit.SAMPLE_TIME * rates), limit.straight(speed)
    assert world.A[:5, :5] == pytest.approx(sampled[:5, :5], abs=1e-5)
    assert world.A[:5, 5:] == pytest.approx(sampled[:5, 5:8], rel=2e-3, abs=1e-6)  # held over each step
    assert world.B[:5] == pytest.approx(sampled[:5, 8:], abs=1e-5)


def driven(world, design, K, G, settings, *, speed, samples, seed):
    """Return both distances (samples, 2) and angles (samples, 2) of the simulated machine under a design."""
    start = Pose(x=0.0, y=0.0, yaw=0.0)
    machine = SimulatedMachine(vehicle=VEHICLE, settings=settings, sample_time=0.2, start=start, seed=seed)
    expected, found = np.zeros(8), []
    for _ in range(samples):
        seen, truth = machine.read(), machine.truth()
        measured = [seen.tractor_y, seen.trailer_y, seen.hitch_angle, seen.tractor_steering, seen.trailer_steering]
        estimate = expected + K @ (measured - design.C @ expected)
        command = np.clip(G @ estimate, -LIMITS, LIMITS)
        front, joint = command.tolist()
        machine.write(Command(time=seen.time, tractor_steering=front, trailer_steering=joint, speed=speed))
        expected = design.A @ estimate + design.B @ command
        found.append((truth.tractor.y, truth.trailer.y, truth.tractor_steering, truth.trailer_steering))
    return np.array(found)


@pytest.mark.parametrize("speed", [1.0, 2.0])
def test_the_simulated_machine_comes_to_it_as_well(limit, speed) -> None:
    """The limit is no mere bound: its controller drives the machine, whose slips vary too, to these errors."""
    world = limit.straight(speed)
    K, G, point = designed(limit, world, 0.06)
    runs = [
        driven(world, world, K, G, SimulatedMachineSettings(), speed=speed, samples=2000, seed=seed)[SETTLED:]
        for seed in range(8)
    ]
    errors, rates = spreads(np.stack(runs, axis=-1))
    assert errors == pytest.approx(point.errors, rel=0.06)
    assert rates == pytest.approx(point.rates, rel=0.04)


def test_a_slope_moves_the_simulated_machine_as_it_moves_the_linear_one(limit) -> None:
    design = limit.straight(1.0, 0.001)
    K, G, _ = designed(limit, design, 0.06)
    quiet = {"position": 0.0, "hitch_angle": 0.0, "speed": 0.0, "steering_resolution": 1e-9}
    machine = SimulatedMachineSettings()
    still = {
        name: process.model_copy(update={"deviation": 0.0})
        for name, process in machine.ground
        if name != "steering_offset"
    }
    begins = SETTLED * limit.SAMPLE_TIME
    settings = machine.model_copy(
        update={
            "sensors": machine.sensors.model_copy(update=quiet),
            "ground": machine.ground.model_copy(update=still),
            "events": (SideSlope(start=begins, crab=limit.SLOPE, ramp=limit.RAMP),),
        }
    )
    answer = limit.slope_answer(limit.straight(1.0), design, K, G)
    samples = SETTLED + len(answer) + 1
    found = driven(design, design, K, G, settings, speed=1.0, samples=samples, seed=0)[SETTLED + 1 :, :2]
    assert found == pytest.approx(answer, abs=0.03 * abs(answer).max())
    assert abs(answer).max(axis=0) == pytest.approx(0.03, abs=0.01)


def test_the_product_s_filter_is_worse_than_that_of_the_truth_and_steers_more(limit, experiment) -> None:
    configuration = load_configuration("articulated")
    world = limit.straight(1.0)
    design = limit.assumed_straight(1.0, configuration.estimator, configuration.sensors)
    own, least = limit.best(world, design, 0.05), limit.front(world, world)
    assert 100.0 * own.estimates == pytest.approx([1.16, 0.89], abs=0.01)
    assert own.rate > 2.0 * least.rate_at(own.error)


def test_figures_are_of_a_run_once_it_has_settled(analysis, make_result) -> None:
    time = 0.2 * np.arange(300)
    late = time > 30.0
    columns = {"measurement.time": time, "truth.tractor.x": np.where(late, 21.0, 19.0)}
    for body, error, rate in (("tractor", 0.01, 0.1), ("trailer", -0.03, 0.3)):
        columns |= {
            f"error.{body}": np.where(late, error, 1.0),
            f"truth.{body}.y": np.zeros(300),
            f"estimate.{body}.y": np.where(late, error * (-1.0) ** np.arange(300), 5.0),
            f"truth.{body}_steering": np.radians(rate) * time,
        }
    found = analysis.figures(make_result(columns))
    assert (found["tractor error"], found["trailer error"], found["error"]) == pytest.approx((1.0, 3.0, 2.0))
    assert (found["tractor rate"], found["trailer rate"], found["rate"]) == pytest.approx((0.1, 0.3, 0.2))
    assert found["trailer estimate"] == pytest.approx(3.0, rel=0.01)


def test_the_report_has_both_limits_beside_each_case(
    analysis, experiment, make_result, assemble, write_parts, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(analysis, "EXPECTED_SLOPES", (0.0, 0.001, 0.002))
    time = 0.2 * np.arange(600)
    flat = {"measurement.time": time, "truth.tractor.x": time}
    for body in ("tractor", "trailer"):
        wave = 0.01 * np.sin(time)
        flat |= {f"error.{body}": wave, f"truth.{body}.y": wave, f"estimate.{body}.y": 2.0 * wave}
        flat[f"truth.{body}_steering"] = np.radians(6.0) * np.sin(time)
    sloping = flat | {"error.trailer": flat["error.trailer"] + np.where(time > 60.0, 0.02, 0.0)}
    results = {case: [make_result(sloping if "slope" in case else flat)] * 2 for case in experiment.configurations}
    text, tables = write_parts(assemble(results))
    assert [row[0] for row in tables["activity"].rows[:2]] == ["articulated: 1 m/s", "before: 1 m/s"]
    assert {row[-1] for row in tables["activity"].rows} == {"0.00 / 2.00"}
    shown, flat_least, least = map(float, (row.split(" ")[0] for row in tables["activity"].rows[0][2:5]))
    assert shown == pytest.approx(0.64, abs=0.01)
    assert 0.85 < flat_least < least < 1.05
    known = [(float(row[2]), float(row[4])) for row in tables["limits"].rows if row[4] != "–"]
    assert len(known) > 5
    assert all(flat_least < least for flat_least, least in known)
    assert "(activity.svg)" in text


def test_the_path_is_one_straight(experiment, build) -> None:
    (alteration,) = experiment.alterations["articulated: 1 m/s"]
    simulation = build("articulated")
    alteration.apply(simulation)
    nodes = simulation.path.nodes
    assert simulation.path.length == 300.0
    assert not nodes[:, 2:].any()
    record = next(simulation.steps())
    assert record.truth.tractor.y == pytest.approx(record.reference.tractor.closest[1])
