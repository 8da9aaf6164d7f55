"""Tightened bounds against linear programmes, advice against itself, and what a limited cylinder follows."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.sparse import lil_matrix

from drawbar.config import load_configuration
from drawbar.control.settings import (
    ArticulatedControllerSettings,
    BodyTubeSettings,
    Nominal,
    TricycleControllerSettings,
    TubeOperatingRange,
    TubeSettings,
)
from drawbar.control.tube.bodies import followed_rate
from drawbar.control.tube.tube import tube_of, tubes_of
from drawbar.errors import ConfigurationError, TubeError
from drawbar.step.build import build_tubes
from drawbar.vehicle.parameters import VehicleParameters

POINT = TubeOperatingRange(speed=(0.9, 0.9), tractor_slip=(0.9, 0.9), trailer_slip=(0.9, 0.9))
STEPS = 300


def worst_quantity(tube, limit, settings):
    """Return how far a limited quantity can be from its nominal value after STEPS samples, by a linear programme.

    Unknowns are the true errors e_k, the errors eps_k of the estimate, one for each sample, and the disturbances w_k;
    the dynamics are equations, and nothing but the declared bounds is known of eps and w.
    """
    A, B, K = tube.model.A[0], tube.model.B[0], tube.gain
    n, names = len(K), list(settings.disturbances)
    G = tube.model.G[0][:, [tube.model.disturbances.index(name) for name in names]]
    d = len(names)
    eps = [settings.estimation.get(state, 0.0) for state in tube.model.states]
    bounds = [(None, None)] * (n * (STEPS + 1))
    bounds += [(-bound, bound) for _ in range(STEPS + 1) for bound in eps]
    bounds += [(-settings.disturbances[name], settings.disturbances[name]) for _ in range(STEPS) for name in names]
    equations = lil_matrix((n * (STEPS + 1), len(bounds)))
    error, estimate, push = 0, n * (STEPS + 1), 2 * n * (STEPS + 1)
    equations[:n, :n] = np.eye(n)
    for k in range(STEPS):
        rows = slice(n * (k + 1), n * (k + 2))
        now, then = slice(n * k, n * (k + 1)), slice(n * (k + 1), n * (k + 2))
        equations[rows, then] = np.eye(n)
        equations[rows, now] = -(A + np.outer(B, K))
        equations[rows, slice(estimate + now.start, estimate + now.stop)] = -np.outer(B, K)
        equations[rows, slice(push + d * k, push + d * (k + 1))] = -G
    objective = np.zeros(len(bounds))
    last = slice(n * STEPS, n * (STEPS + 1))
    objective[error + last.start : error + last.stop] = limit.state + limit.command * K
    objective[estimate + last.start : estimate + last.stop] = limit.command * K
    found = linprog(-objective, A_eq=equations.tocsr(), b_eq=np.zeros(equations.shape[0]), bounds=bounds)
    assert found.success
    return -found.fun


@pytest.mark.parametrize(
    ("model", "name"), [("articulated", "tractor"), ("articulated", "trailer"), ("tricycle", "tractor")]
)
@pytest.mark.parametrize("nominal", [Nominal.PROPAGATED, Nominal.OPTIMISED])
def test_tightening_is_the_worst_that_a_linear_programme_finds(model, name, nominal, body, declared):
    settings, vehicle = declared[model, name], body(model, name, POINT)
    bent = vehicle.model  # steering and curvature still spread the operating points: leave the nominal one
    vehicle = type(vehicle)(
        model=type(bent)(
            states=bent.states,
            units=bent.units,
            A=bent.A[:1],
            B=bent.B[:1],
            disturbances=bent.disturbances,
            disturbance_units=bent.disturbance_units,
            G=bent.G[:1],
        ),
        limits=vehicle.limits,
        explaining=vehicle.explaining,
    )
    tube = tube_of(name, vehicle, settings, nominal)
    for limit in vehicle.limits:
        bound = tube.bounds[limit.name]
        assert bound.tightening == pytest.approx(worst_quantity(tube, limit, settings), rel=1e-5)
        assert bound.tightened == pytest.approx(min(limit.value, limit.reach - bound.tightening))
        assert bound.original == limit.value


def test_in_the_predicted_mode_the_law_answers_one_step_errors_only(body, declared):
    # from x^ = x + eps: e^+ = B K e^ + G w + eps+ - A eps, summed by hand over a few samples
    settings, vehicle = declared["tricycle", "tractor"], body("tricycle", "tractor", POINT)
    tube = tube_of("tractor", vehicle, settings, Nominal.PREDICTED)
    A, G = vehicle.model.A[0], vehicle.model.G[0]
    pole = vehicle.model.B @ tube.gain
    yaw = vehicle.model.disturbances.index("yaw_rate")
    once = np.abs(tube.gain @ G[:, yaw]) * 0.02 + np.abs(tube.gain @ G[:, yaw - 1]) * 0.01
    once += 0.01 * (np.abs(tube.gain[1]) + np.abs(tube.gain @ A[:, 1]))
    taken = tube.bounds["command"].tightening
    assert once / (1.0 - np.abs(pole).min()) <= taken <= 1.02 * once / (1.0 - np.abs(pole).max())


def tubes(controller, tractor, **vehicle):
    tube = TubeSettings(nominal=Nominal.PROPAGATED, tractor=tractor, operating_range=POINT)
    return tubes_of(VehicleParameters(**vehicle), controller, tube, speed=1.0, sample_time=0.2)


def test_an_empty_bound_is_refused_with_what_would_leave_something():
    paper = TricycleControllerSettings(model="tricycle")
    large = BodyTubeSettings(yaw=-3.0, disturbances={"yaw_rate": 0.4}, estimation={"yaw": 0.02})
    with pytest.raises(
        TubeError, match=r"tractor leaves nothing of the command bound.*disturbances\.yaw_rate"
    ) as failed:
        tubes(paper, large)
    words = str(failed.value).split()
    enough = float(words[words.index("below") + 1].rstrip(";"))
    share = 0.01 * float(words[-1].rstrip("%."))
    for factor, leaves in ((0.99, True), (1.02, False)):
        alone = large.model_copy(update={"disturbances": {"yaw_rate": factor * enough}})
        together = large.model_copy(
            update={
                "disturbances": {"yaw_rate": factor * share * 0.4},
                "estimation": {"yaw": factor * share * 0.02},
            }
        )
        for settings in (alone, together):
            if leaves:
                left = tubes(paper, settings).tractor.bounds["command"].tightened
                assert 0.0 < left < 0.05 * VehicleParameters().tractor_steering_limit
            else:
                with pytest.raises(TubeError, match="leaves nothing"):
                    tubes(paper, settings)


def test_where_no_single_bound_suffices_it_is_said():
    large = BodyTubeSettings(yaw=-3.0, disturbances={"yaw_rate": 0.4, "speed": 1.5}, estimation={"yaw": 0.3})
    with pytest.raises(TubeError, match="would still be wanting; or reduce all declared bounds to below"):
        tubes(TricycleControllerSettings(model="tricycle"), large)


@pytest.mark.parametrize(
    ("settings", "problem"),
    [
        ({"articulation": -0.3}, "has no articulation with this controller's model; it has: lateral, yaw, steering"),
        ({"disturbances": {"hitch_angle": 0.1}}, "disturbances has no hitch_angle"),
        ({"estimation": {"speed": 0.1}}, "estimation has no speed"),
        ({"increments": {"speed": 0.1}}, "increments has no speed"),
        ({"lqr": {"sway": 1.0, "command": 1.0}}, "lqr has no sway"),
        ({"lqr": {"lateral": 1.0, "command": 1.0}, "yaw": -1.0}, "leave one out"),
    ],
)
def test_what_the_model_does_not_know_is_refused(settings, problem):
    with pytest.raises(ConfigurationError, match=problem):
        tubes(ArticulatedControllerSettings(model="articulated"), BodyTubeSettings(**settings))


@pytest.mark.parametrize("falling_short", [0.0, 0.02, 0.1, 0.5])
def test_a_limited_cylinder_falls_short_by_what_is_declared(falling_short):
    rate, lag, time, steps = 0.4, 0.3, 0.2, 200_000
    mean = followed_rate(rate, falling_short, lag, time)
    command, angle, step = mean * time / (1.0 - np.exp(-time / lag)), 0.0, time / steps
    for _ in range(steps):
        angle += step * min((command - angle) / lag, rate)
    # a disturbance of the rate, held over the sample, moves the end of it by rate lag (1 - exp(-T / lag))
    assert mean * time - angle == pytest.approx(falling_short * lag * (1.0 - np.exp(-time / lag)), abs=2e-6)
    assert mean >= rate * lag / time * (1.0 - np.exp(-time / lag)) - 1e-12


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("tube.tractor.yaw=29.0", "errors of the tractor have no bounds.*lower sample_time or speed"),
        ("vehicle.trailer_length=29.0", "vehicle.trailer_length = 29 m follows curves"),
        ("vehicle.curvature_limit=3.1", "vehicle.curvature_limit = 3.1 1/m steadily"),
    ],
)
def test_numbers_without_a_tube_are_refused(change, message):
    with pytest.raises(TubeError, match=message):
        build_tubes(load_configuration("articulated", [change]))
