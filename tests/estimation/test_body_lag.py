"""By how much the tractor turns later than its wheels stand: against tyres, by speed and ground, and as it is found."""

import math
from dataclasses import replace

import numpy as np
import pytest
from estimators import DeadTimePredictor
from scipy.integrate import solve_ivp

from drawbar.config import load_configuration
from drawbar.geometry import GRAVITY
from drawbar.signals import Actuation, Command, Estimate, Measurement, Pose, SolverStatus
from drawbar.simulation import simulate
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.parameters import VehicleParameters

VEHICLE = VehicleParameters()
ESTIMATE = Estimate(
    time=3.0,
    tractor=Pose(x=0.0, y=0.0, yaw=0.0),
    trailer=Pose(x=-2.0, y=0.0, yaw=0.0),
    hitch_angle=0.0,
    speed=1.0,
    tractor_steering=0.0,
    trailer_steering=0.0,
    longitudinal_slip=1.0,
    tractor_slip=1.0,
    trailer_slip=1.0,
    steering_offset=0.0,
    tractor_crab=0.0,
    trailer_crab=0.0,
    status=SolverStatus.SOLVED,
)
NOTHING = Measurement(
    time=0.0,
    tractor_x=math.nan,
    tractor_y=math.nan,
    trailer_x=math.nan,
    trailer_y=math.nan,
    hitch_angle=math.nan,
    speed=math.nan,
    tractor_steering=math.nan,
    trailer_steering=math.nan,
)
SAMPLE = 0.2
TIMES = SAMPLE * np.arange(300)
"""s"""
HARDLY = 1e-9
"""s^2/m; a firm ground on which the tractor turns nearly as its wheels stand"""


def lag(speed: float, creep: float, per_speed: float, slip: float = 1.0) -> float:
    """Return the time by which estimates are moved forward where commands have no dead time, s."""
    ahead = DeadTimePredictor(VEHICLE, articulated(VEHICLE), 0.2, per_speed)
    estimate = replace(ESTIMATE, speed=speed, longitudinal_slip=slip, creep=creep)
    return ahead.ahead(estimate).time - estimate.time


@pytest.mark.parametrize(
    ("speed", "creep", "per_speed", "slip", "expected"),
    [
        (2.0, 0.0, 0.03, 1.0, 0.06),
        (2.5, 0.0, 0.03, 0.8, 0.06),
        (2.0, 0.2, 0.03, 1.0, 0.06 + 0.4 / GRAVITY),
        (4.0, 1.0, 0.1, 1.0, 0.3),  # no estimate makes plans begin further ahead
        (2.0, -1.0, 0.03, 1.0, 0.0),
        (2.0, 0.3, 0.0, 1.0, 0.0),
        (0.0, 0.3, 0.03, 1.0, 0.0),
    ],
)
def test_the_lag_grows_with_speed_and_with_what_the_ground_gives_way(speed, creep, per_speed, slip, expected) -> None:
    assert lag(speed, creep, per_speed, slip) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize(("speed", "creep"), [(1.0, 0.3), (2.8, 0.36), (3.0, 0.05)])
def test_ground_that_creeps_delays_yaw_rate_and_path_as_masses_and_tyres_do(speed, creep) -> None:
    """The yaw rate by the body's lag, the rear axle's path by as much more, which is its side-slip.

    A single-track vehicle on tyres whose slip angle is `creep` times side force per load, wheels turned steadily."""
    wheelbase, front, turning = VEHICLE.wheelbase, 0.6 * VEHICLE.wheelbase, 0.01  # m, m, rad/s
    rear = wheelbase - front
    loads = GRAVITY * rear / wheelbase, GRAVITY * front / wheelbase  # per mass: of front and rear axle

    def forces(t: float, aside: float, turn: float) -> tuple[float, float]:
        slips = turning * t - (aside + front * turn) / speed, -(aside - rear * turn) / speed
        return loads[0] * slips[0] / creep, loads[1] * slips[1] / creep

    def rates(t: float, state: np.ndarray) -> list[float]:
        ahead, behind = forces(t, *state)
        inertia = front * rear  # per mass
        return [ahead + behind - speed * state[1], (front * ahead - rear * behind) / inertia]

    end = 3.0
    aside, turn = solve_ivp(rates, (0.0, end), [0.0, 0.0], method="Radau", rtol=1e-9, atol=1e-12).y[:, -1]
    pushed, turned = rates(end, np.array([aside, turn]))
    at_rear_axle = pushed + speed * turn - rear * turned  # its acceleration to the left, m/s^2
    late = end - turn * wheelbase / (speed * turning)
    path_late = end - at_rear_axle * wheelbase / (speed**2 * turning)
    assert lag(speed, creep, HARDLY) == pytest.approx(late, abs=1e-4)
    assert late + creep * speed / GRAVITY == pytest.approx(path_late, abs=1e-4)


def steadily(
    angles, yaw_rates, speed: float, per_speed: float = 0.02, slower: float = 1.0, rate: float = 1.0
) -> tuple[list[float], list[Actuation]]:
    """Return the angles that turn the tractor, rad, and what is told, of measured angles and yaw rates at each sample.

    slower, rate: lag and rate of the wheels per stated ones.
    """
    predictor, lag = DeadTimePredictor(VEHICLE, articulated(VEHICLE), SAMPLE, per_speed), VEHICLE.steering_lag
    rates = {f"{body}_rate": rate * getattr(VEHICLE, f"{body}_steering_rate") for body in ("tractor", "trailer")}
    predictor.known(Actuation(tractor_lag=slower * lag, trailer_lag=slower * lag, **rates))
    estimate, turning, told = replace(ESTIMATE, speed=speed), [], []
    for k, (angle, rate) in enumerate(zip(angles, yaw_rates, strict=True)):
        predictor.ahead(estimate)
        measurement = replace(NOTHING, time=SAMPLE * k, tractor_steering=angle, tractor_yaw_rate=rate)
        turned, said = predictor.measured(estimate, measurement)
        predictor.sent(Command(time=SAMPLE * k, tractor_steering=0.0, trailer_steering=0.0, speed=speed))
        turning.append(turned)
        told.append(said)
    return turning, told


def swinging(t):
    """Return the angle of front wheels that swing at 0.15 and 0.4 Hz, rad."""
    return 0.1 * np.sin(2.0 * np.pi * 0.15 * t) + 0.05 * np.sin(2.0 * np.pi * 0.4 * t)


def shown(true: float, speed: float, bent: float = 1.0) -> list[Actuation]:
    """Return what is told while a body turns so much later than its wheels, s, and by a factor more."""
    noise = np.random.default_rng(0).normal(0.0, np.radians(0.3), (2, len(TIMES)))
    yaw_rates = bent * speed / VEHICLE.wheelbase * swinging(TIMES - true)
    return steadily(swinging(TIMES) + noise[0], yaw_rates + np.radians(1.0) + noise[1], speed)[1]


@pytest.mark.parametrize(
    ("slower", "rate", "late"),
    [(1.0, 1.0, 0.07), (0.5, 1.0, 0.07), (2.0, 1.0, 0.035), (2.0, 0.25, 0.0175), (1.0, 0.5, 0.035)],
)
def test_the_angle_that_counts_is_the_one_before_the_lag(slower, rate, late) -> None:
    """By less where the wheels are slower than stated."""
    angles = 0.05 * TIMES[:20]
    turning, told = steadily(angles, 20 * [math.nan], 3.5, slower=slower, rate=rate)
    assert told[-1].body_lag == pytest.approx(0.07)
    np.testing.assert_allclose(turning[2:], angles[2:] - 0.05 * late, atol=1e-12)


@pytest.mark.parametrize("per_speed", [0.0, 0.02])
def test_an_angle_that_is_missing_stays_missing(per_speed) -> None:
    turning, _ = steadily([0.1, math.nan, 0.1], 3 * [math.nan], 2.0, per_speed)
    assert math.isnan(turning[1])
    assert (turning[0], turning[2]) == (0.1, 0.1)


@pytest.mark.parametrize("false", [math.nan, 1.0, -1.0])
def test_one_false_angle_is_none(false) -> None:
    """Neither as it comes nor as one before the lag; two in a row are believed."""
    angles = 0.05 * TIMES[:20]
    sound, _ = steadily(angles, 20 * [math.nan], 3.5)
    angles[9] = false
    turning, _ = steadily(angles, 20 * [math.nan], 3.5)
    assert math.isnan(turning.pop(9))
    sound.pop(9)
    np.testing.assert_allclose(turning, sound, atol=1e-12)


def test_of_two_false_angles_in_a_row_the_second_is_believed() -> None:
    angles = 0.05 * TIMES[:20]
    angles[9:11] = 1.0
    turning, _ = steadily(angles, 20 * [math.nan], 3.5)
    assert math.isnan(turning[9])
    assert turning[10] > 0.5


def test_on_no_ground_means_on_none() -> None:
    turning, told = steadily(swinging(TIMES), 2.0 * swinging(TIMES - 0.2), 2.0, 0.0)
    np.testing.assert_array_equal(turning, swinging(TIMES))
    assert {each.body_lag for each in told} == {0.0}


@pytest.mark.parametrize("true", [0.0, 0.1, 0.2])
@pytest.mark.parametrize("bent", [0.8, 1.1])
def test_a_yaw_rate_shows_the_lag(true, bent) -> None:
    """Also where sensor or slip make more or less of the yaw rate, and with a bias; nearer to what is stated by a
    deviation."""
    first, last = shown(true, 2.8, bent)[:: len(TIMES) - 1]
    found = last.body_lag + math.copysign(last.body_lag_deviation, true - 0.02 * 2.8)
    assert found == pytest.approx(true, abs=0.04)
    assert last.body_lag_deviation < 0.6 * first.body_lag_deviation


def test_wheels_that_alternate_from_sample_to_sample_show_the_lag() -> None:
    """A wrong lag makes commands alternate: exactly then it must be found."""
    angles = 0.05 * (-1.0) ** np.arange(len(TIMES))
    _, told = steadily(angles, 2.8 / VEHICLE.wheelbase * angles, 2.8, per_speed=0.05)
    assert told[0].body_lag == pytest.approx(0.14)
    assert told[50].body_lag < 0.05


@pytest.mark.parametrize("true", [0.0, 0.2])
def test_an_old_yaw_rate_shows_the_lag(true) -> None:
    """It is brought up to now by what the wheels turned the tractor since, with the lag that is reckoned with."""
    speed, age = 2.8, 0.8
    predictor = DeadTimePredictor(VEHICLE, articulated(VEHICLE), SAMPLE, 0.02)
    estimate, lag = replace(ESTIMATE, speed=speed), 0.0
    for time in TIMES:
        predictor.ahead(estimate)
        then, since = swinging(time - age - true), swinging(time - lag) - swinging(time - age - lag)
        rate = speed / VEHICLE.wheelbase * (then + since)
        given = replace(
            NOTHING, time=time, tractor_steering=swinging(time), tractor_yaw_rate=rate, tractor_attitude_age=age
        )
        told = predictor.measured(estimate, given)[1]
        predictor.sent(Command(time=time, tractor_steering=0.0, trailer_steering=0.0, speed=speed))
        lag = told.body_lag
    assert lag + math.copysign(told.body_lag_deviation, true - 0.02 * speed) == pytest.approx(true, abs=0.04)


def test_what_is_not_sure_is_not_reckoned_with() -> None:
    """At 0.3 m/s a yaw rate shows next to nothing, and wheels that rest show nothing."""
    assert max(each.body_lag for each in shown(0.2, 0.3)) == pytest.approx(0.006)
    _, told = steadily(np.full(len(TIMES), 0.2), np.random.default_rng(0).normal(0.5, 0.1, len(TIMES)), 2.8)
    assert told[-1].body_lag == pytest.approx(0.056)


@pytest.mark.parametrize(
    ("kind", "true", "least", "most"), [("simulated", 0.0, 0.0, 0.06), ("physics", 0.18, 0.08, 0.25)]
)
def test_the_lag_is_identified_while_driving(kind: str, true: float, least: float, most: float) -> None:
    """The simulated chain turns as its wheels stand; on soft ground the yaw rate of the physics lags by 0.18 s."""
    if kind == "physics":
        pytest.importorskip("mujoco", reason="the extra `physics` is not installed")
    changes = ["path.radii=[8.0]", "speed=2.0", f"machine.kind={kind}", "machine.attitude.tractor.present=true"]
    soft = ["machine.terrain={creep=0.36}"] if kind == "physics" else []
    log = simulate(load_configuration("articulated", changes + soft), seed=0)
    assert log.outcome is not None
    assert log.outcome.finished
    told = log.records[-1].actuation
    assert least <= told.body_lag <= most
    assert abs(told.body_lag - true) < 3.0 * told.body_lag_deviation
