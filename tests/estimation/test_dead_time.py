"""The prediction through commands under way: against a fine independent integration, and in closed loop."""

import math

import casadi as ca
import numpy as np
import pytest
from estimators import DeadTimePredictor
from scipy.integrate import solve_ivp

from drawbar.estimation.dead_time import dead_time_unit
from drawbar.signals import Command, Estimate, Pose, SolverStatus
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle

SAMPLE = 0.2
WAY = 0.9 * 1.2
"""m/s; how fast the estimate below moves"""
COMMANDS = [(0.3, -0.2), (-0.1, 0.25), (0.25, 0.1), (0.05, -0.3)]


def vehicle(dead_time: float, sign: int = 1) -> VehicleParameters:
    return VehicleParameters(dead_time=dead_time, joint_sign=sign)


def estimate() -> Estimate:
    return Estimate(
        time=7.0,
        tractor=Pose(x=3.0, y=-2.0, yaw=0.7),
        trailer=Pose(x=1.3, y=-3.3, yaw=0.6),
        hitch_angle=0.06,
        speed=1.2,
        tractor_steering=0.1,
        trailer_steering=0.04,
        longitudinal_slip=0.9,
        tractor_slip=0.95,
        trailer_slip=0.85,
        steering_offset=0.01,
        tractor_crab=0.02,
        trailer_crab=-0.01,
        status=SolverStatus.SOLVED,
    )


def command(tractor: float, trailer: float) -> Command:
    return Command(time=0.0, tractor_steering=tractor, trailer_steering=trailer, speed=1.0)


def predictor(model, dead_time: float, sign: int = 1, body_lag: float = 0.0) -> DeadTimePredictor:
    return DeadTimePredictor(vehicle(dead_time, sign), model(vehicle(dead_time, sign)), SAMPLE, body_lag / WAY)


def yaws(model, e: Estimate, dead_time: float, sign: int, body_lag: float) -> tuple[float, float, float, float]:
    """Return both yaws and both steering angles after both times, by an adaptive integrator on the model."""
    declared = model(vehicle(dead_time, sign)).numeric()
    f = ca.Function("f", [declared.x, declared.u, declared.p], [declared.derivative])
    slips = e.longitudinal_slip, e.tractor_slip
    if model is articulated:
        x = [e.tractor.x, e.tractor.y, e.tractor.yaw, e.trailer.yaw, e.tractor_steering, e.trailer_steering]
        p, at = [*slips, e.steering_offset, e.trailer_crab, e.speed, e.tractor_crab], (2, 3, 4, 5)
    else:
        poses = [e.tractor.x, e.tractor.y, e.tractor.yaw, e.trailer.x, e.trailer.y, e.trailer.yaw]
        x, p, at = (
            [*poses, e.tractor_steering, e.trailer_steering],
            [*slips, e.trailer_slip, 0.06, e.speed],
            (2, 5, 6, 7),
        )

    def rates(t, z):
        # a command sent k samples ago turns the tractor from (both times - k samples) on; the joint waits for it
        index = len(COMMANDS) - math.ceil((dead_time + body_lag - t) / SAMPLE - 1e-9)
        tractor, trailer = COMMANDS[min(index, len(COMMANDS) - 1)]
        error = (np.array([tractor, sign * trailer if t >= body_lag else z[-1]]) - z[-2:]) / 0.3
        limit = np.radians([25.0, 20.0])
        steer = np.clip(error, -limit, limit)
        if model is articulated:
            return f(z, steer, p).full().ravel()
        return np.concatenate([f(z[:6], z[6:], p).full().ravel(), steer])

    end = solve_ivp(rates, (0.0, dead_time + body_lag), x, rtol=1e-8, atol=1e-10, max_step=0.005).y[:, -1]
    return tuple(end[list(at)])


@pytest.mark.parametrize("model", [articulated, tricycle])
@pytest.mark.parametrize(
    ("dead_time", "sign", "body_lag"), [(0.1, 1, 0.0), (0.2, -1, 0.0), (0.5, 1, 0.1), (0.6, -1, 0.0), (0.0, 1, 0.15)]
)
def test_the_prediction_is_the_model_driven_by_the_commands_under_way(model, dead_time, sign, body_lag) -> None:
    ahead = predictor(model, dead_time, sign, body_lag)
    for values in COMMANDS:
        ahead.sent(command(*values))
    then = ahead.ahead(estimate())
    seen = (then.tractor.yaw, then.trailer.yaw, then.tractor_steering, then.trailer_steering)
    assert seen == pytest.approx(yaws(model, estimate(), dead_time, sign, body_lag), abs=2e-4)
    assert then.time == pytest.approx(7.0 + dead_time + body_lag)
    way = math.hypot(then.tractor.x - 3.0, then.tractor.y + 2.0)
    assert way == pytest.approx(WAY * (dead_time + body_lag), rel=2e-3)
    assert (then.speed, then.longitudinal_slip, then.status) == (1.2, 0.9, SolverStatus.SOLVED)


def test_the_trailers_antenna_and_hitch_follow_the_chain() -> None:
    shape = vehicle(0.3)
    then = predictor(articulated, 0.3).ahead(estimate())
    phi = then.trailer.yaw + then.trailer_steering
    back = shape.trailer_length - shape.trailer_antenna
    arms = [(shape.free_joint_offset, then.tractor.yaw), (shape.drawbar_length, phi), (back, then.trailer.yaw)]
    antenna = complex(then.tractor.x, then.tractor.y) - sum(length * np.exp(1j * yaw) for length, yaw in arms)
    assert complex(then.trailer.x, then.trailer.y) == pytest.approx(antenna)
    assert then.hitch_angle == pytest.approx(then.tractor.yaw - phi)


def test_before_any_command_the_wheels_stay_as_they_are() -> None:
    then = predictor(articulated, 0.4).ahead(estimate())
    assert (then.tractor_steering, then.trailer_steering) == pytest.approx((0.1, 0.04))


def test_without_dead_time_there_is_nothing_to_predict() -> None:
    assert dead_time_unit(vehicle(0.0), articulated(vehicle(0.0)), SAMPLE) is None


@pytest.mark.parametrize(
    ("dead_time", "late", "share"), [(0.0, 0, 0.0), (0.05, 0, 0.25), (0.2, 1, 0.0), (0.55, 2, 0.75)]
)
def test_the_command_that_acts_is_the_mean_of_those_that_do(dead_time, late, share) -> None:
    """A share of the sample still belongs to the command before."""
    seen = steered(predictor(articulated, dead_time))
    np.testing.assert_allclose(seen, [acting(late, share, steering) for steering in (0, 1)], atol=1e-12)


def test_what_acts_on_the_tractor_acts_later_by_the_bodies_lag() -> None:
    ahead = predictor(articulated, 0.25, body_lag=0.1)
    ahead.ahead(estimate())
    seen = steered(ahead)
    np.testing.assert_allclose(seen, [acting(1, 0.75, 0), acting(1, 0.25, 1)], atol=1e-12)


def steered(ahead: DeadTimePredictor) -> list[list[float]]:
    """Return the angles that act on front wheels and joint after each of the commands, rad."""
    said = [ahead.sent(command(*values)) for values in COMMANDS]
    return [[each.tractor_steering for each in said], [each.trailer_steering for each in said]]


def acting(late: int, share: float, steering: int) -> list[float]:
    """Return what acts of one steering after each of the commands: so many samples late, and a share one more, rad."""
    sent = [values[steering] for values in COMMANDS[: len(COMMANDS) - late]]
    before = [sent[0], *sent[:-1]]  # before the first nothing is known
    mixed = [(1.0 - share) * now + share * then for now, then in zip(sent, before, strict=True)]
    return [math.nan] * late + mixed


def test_a_known_dead_time_costs_next_to_nothing(simulate) -> None:
    path = ("path.radii=[8.0]", "path.straight_length=5.0", "machine.actuators.dead_time=0.4")
    path = (*path, "actuation.identify=false", "sanity.swing=10.0", "sanity.steering_swing=3.0", "sanity.leaving=6.0")
    known, unknown = simulate("articulated", *path, "vehicle.dead_time=0.4"), simulate("articulated", *path)
    for body in ("tractor", "trailer"):
        assert np.abs(known.true_errors(body).error).max() <= 0.12
    worst = [np.abs(run.true_errors("tractor").error).max() for run in (known, unknown)]
    assert worst[0] < 0.7 * worst[1]


def test_ages_that_sensors_tell_cost_nothing(simulate) -> None:
    """Every angle is 0.15 s old and says so: both bodies stay as near to the path as with angles that are not late."""
    path = ("path.radii=[8.0]", "path.straight_length=5.0", "speed=3.0")
    late = [f"machine.delays.{sensor}.latency=0.15" for sensor in ("steering", "hitch_angle")]
    at_once, told = simulate("articulated", *path), simulate("articulated", *path, *late)
    for body in ("tractor", "trailer"):
        means = [np.abs(run.true_errors(body).error).mean() for run in (at_once, told)]
        assert means[1] < 1.5 * means[0]
