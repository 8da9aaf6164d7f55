"""Error models against finite differences of the declared models, and of their motion through a whole sample."""

import re

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import expm

from drawbar.control.settings import TubeOperatingRange
from drawbar.control.tube import bodies
from drawbar.control.tube.bodies import OperatingConditions, steady_articulation
from drawbar.errors import TubeError
from drawbar.vehicle.articulated import articulated_tractor, articulated_trailer
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle_tractor, tricycle_trailer

TIME = 0.2
VEHICLE = VehicleParameters()
LAG = VEHICLE.steering_lag


def moved(model, x, p, command, sign=None):
    """Return the state after a sample: many small steps of order 4; a lagging actuator where there is a sign."""
    f = ca.Function("f", [model.x, model.u, model.p], [model.numeric().derivative])
    names = [state.name for state in model.states]

    def rates(x):
        u = command if sign is None else (sign * command - x[names.index("steering")]) / LAG
        return np.array(f(x, u, p)).ravel()

    h = TIME / 50
    for _ in range(50):
        k1 = rates(x)
        k2 = rates(x + 0.5 * h * k1)
        k3 = rates(x + 0.5 * h * k2)
        x = x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + rates(x + h * k3))
    return x


CASES = {
    "articulated tractor": (articulated_tractor, bodies.articulated_tractor_body, (1, 2, 3), 1, VEHICLE),
    "articulated trailer": (articulated_trailer, bodies.articulated_trailer_body, (0, 1), 1, VEHICLE),
    "reversed trailer": (
        articulated_trailer,
        bodies.articulated_trailer_body,
        (0, 1),
        -1,
        VEHICLE.model_copy(update={"joint_sign": -1}),
    ),
    "tricycle tractor": (tricycle_tractor, bodies.tricycle_tractor_body, (1, 2), None, VEHICLE),
    "tricycle trailer": (tricycle_trailer, bodies.tricycle_trailer_body, (1, 2), None, VEHICLE),
}


@pytest.mark.parametrize("case", CASES)
def test_a_sample_on_a_straight_line_by_finite_differences(case):
    declare, of_body, kept, sign, vehicle = CASES[case]
    model, ranges = declare(vehicle), TubeOperatingRange(speed=(0.8, 1.0), tractor_slip=(0.8, 1.0))
    conditions = OperatingConditions(vehicle=vehicle, ranges=ranges, speed=1.2, sample_time=TIME)
    errors = (of_body(conditions) if sign is None else of_body(conditions, 0.0)).model
    values = {"longitudinal_slip": 0.9, "tractor_slip": 0.9, "trailer_slip": 0.9, "speed": 1.2}
    p = np.array([values.get(parameter.name, 0.0) for parameter in model.parameters])
    x, kept = np.zeros(len(model.states)), list(kept)

    def derivative(vary):
        return (vary(1e-4) - vary(-1e-4))[kept] / 2e-4

    for column, state in enumerate(kept):
        found = derivative(lambda h, i=state: moved(model, x + h * np.eye(len(x))[i], p, 0.0, sign))
        assert errors.A[0][:, column] == pytest.approx(found, abs=1e-6)
    assert errors.B[0] == pytest.approx(derivative(lambda h: moved(model, x, p, h, sign)), abs=1e-6)
    names = [parameter.name for parameter in model.parameters]
    for name in errors.disturbances[: -len(kept)]:
        one = np.eye(len(p))[names.index(name)]
        found = derivative(lambda h, one=one: moved(model, x, p + h * one, 0.0, sign))
        assert errors.G[0][:, errors.disturbances.index(name)] == pytest.approx(found, abs=1e-6)
    missing = set(names) - set(errors.disturbances)
    assert all(name.startswith(("reference", "tractor_x", "tractor_y", "tractor_yaw")) for name in missing)


def test_in_a_curve_the_tractor_turns_faster_per_steering_and_its_errors_stay_those_of_its_own_frame():
    conditions = OperatingConditions(
        vehicle=VEHICLE,
        ranges=TubeOperatingRange(speed=(1.0, 1.0), tractor_slip=(0.9, 0.9)),
        speed=1.0,
        sample_time=TIME,
    )
    errors, model = bodies.articulated_tractor_body(conditions, 0.0).model, articulated_tractor(VEHICLE)
    steering = VEHICLE.tractor_steering_limit
    p = np.array([1.0, 0.9, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    rest = np.array([0.0, 0.0, 0.0, steering])
    nominal = moved(model, rest, p, steering, 1)

    def error(start, command):
        x = moved(model, np.array([0.0, *start]) + rest, p, steering + command, 1) - nominal
        return [np.cos(nominal[2]) * x[1] - np.sin(nominal[2]) * x[0], *x[2:]]

    assert errors.A[-1, 1, 2] > 1.2 * errors.A[0, 1, 2]
    for i, column in enumerate(np.eye(3)):
        # what the errors along the path, that are not controlled, bend within a sample is of second order in its turn
        assert errors.A[-1][:, i] == pytest.approx(np.array(error(1e-4 * column, 0.0)) / 1e-4, abs=4e-3)
    assert errors.B[-1] == pytest.approx(np.array(error(np.zeros(3), 1e-4)) / 1e-4, abs=4e-3)


def test_operating_points_cover_the_declared_ranges_after_their_middle():
    conditions = OperatingConditions(
        vehicle=VEHICLE,
        ranges=TubeOperatingRange(speed=(0.8, 1.0), tractor_slip=(0.8, 1.0)),
        speed=1.0,
        sample_time=TIME,
    )
    model = bodies.articulated_tractor_body(conditions, 0.0).model
    assert len(model.A) == 1 + 2 * 2 * 2
    gains = model.A[:, 0, 1] / TIME
    assert gains[0] == pytest.approx(0.9)
    assert {round(gain, 9) for gain in gains[1:]} == {0.8, 1.0}
    assert len(bodies.articulated_trailer_body(conditions, 0.0).model.A) == 1 + 2 * 2 * 3


def test_the_discretisation_is_the_matrix_exponential_also_of_a_fast_actuator():
    for lag in (0.01, 0.3, 5.0):
        vehicle = VEHICLE.model_copy(update={"steering_lag": lag})
        conditions = OperatingConditions(
            vehicle=vehicle,
            ranges=TubeOperatingRange(speed=(1.0, 1.0), tractor_slip=(0.9, 0.9)),
            speed=1.0,
            sample_time=TIME,
        )
        errors = bodies.articulated_tractor_body(conditions, 0.0).model
        turn = 0.9 / vehicle.wheelbase
        continuous = np.zeros((4, 4))
        continuous[0, 1], continuous[1, 2], continuous[2, 2], continuous[2, 3] = 1.0, turn, -1.0 / lag, 1.0 / lag
        exact = expm(TIME * continuous)[:3]
        assert errors.A[0] == pytest.approx(exact[:, :3], abs=1e-12)
        assert errors.B[0] == pytest.approx(exact[:, 3], abs=1e-12)


def test_the_steady_articulation_does_not_change():
    model = articulated_trailer(VEHICLE).numeric()
    rate = ca.Function("rate", [model.x, model.u, model.p], [model.derivative[0]])
    names = [parameter.name for parameter in model.parameters]
    for curvature, joint in ((0.1, 0.0), (0.3, 0.3), (-0.2, 0.2)):
        p = np.zeros(len(names))
        p[names.index("longitudinal_slip")] = p[names.index("speed")] = 1.0
        p[names.index("tractor_yaw_rate")] = curvature
        gamma = steady_articulation(VEHICLE, curvature, joint)
        assert float(rate([gamma, joint], 0.0, p)) == pytest.approx(0.0, abs=1e-12)


def test_a_trailer_that_folds_up_is_told_the_tightest_curve_that_it_follows():
    long = VEHICLE.model_copy(update={"hitch_length": 1.5, "trailer_length": 6.0})
    with pytest.raises(TubeError, match=r"trailer_length = 6 m .*curvature_limit = 0\.3 1/m") as refused:
        steady_articulation(long, 0.3, 0.0)
    told = re.search(r"to (\S+) 1/m at most", str(refused.value))
    tightest = float(told[1])
    assert steady_articulation(long, tightest, 0.0) > 0.0
    with pytest.raises(TubeError):
        steady_articulation(long, tightest + 2e-4, 0.0)
