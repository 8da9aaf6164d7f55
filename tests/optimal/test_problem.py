"""Problems that contradict themselves are refused when they are declared."""

import math
import re
from typing import Any

import casadi as ca
import pytest

from drawbar.codegen.cache import runtime_sources
from drawbar.errors import SolverError
from drawbar.optimal import Bound, ControlProblem, EstimationProblem
from drawbar.optimal.problem import row
from drawbar.optimal.solver_source import solver_source
from drawbar.optimal.transcription import transcribe
from drawbar.vehicle.integrators import Integrator
from drawbar.vehicle.measured import MEASURED
from drawbar.vehicle.model import declare, variables
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle, tricycle_tractor

MODEL_HEADER = re.compile(r"(centralised_)?(articulated|tricycle)|at_rest|first_guess")
"""headers that belong to a model"""
MODEL = tricycle_tractor(VehicleParameters())
WEIGHTS = {"x": 1.0, "y": 1.0, "steering": 1.0}
TERMINAL = {"x": 1.0, "y": 1.0}
SENSORS = {variable.name: 1.0 for variable in MEASURED}
DEVIATIONS = dict.fromkeys(
    (
        *("tractor_x", "tractor_y", "tractor_yaw", "trailer_x", "trailer_y", "trailer_yaw"),
        *("longitudinal_slip", "tractor_slip", "trailer_slip", "hitch_angle", "speed"),
    ),
    1.0,
)


def without(values: dict[str, float], name: str) -> dict[str, float]:
    return {key: value for key, value in values.items() if key != name}


def control(**changes: Any) -> ControlProblem:
    whole = {
        "model": MODEL,
        "horizon": 5,
        "sample_time": 0.2,
        "weights": WEIGHTS,
        "terminal_weights": TERMINAL,
    }
    return ControlProblem(**{**whole, **changes})


def estimation(**changes: Any) -> EstimationProblem:
    whole = {
        "model": tricycle(VehicleParameters()),
        "horizon": 5,
        "sample_time": 0.2,
        "weights": SENSORS,
        "prior_deviation": DEVIATIONS,
        "process_deviation": dict.fromkeys(DEVIATIONS, 0.0),
    }
    return EstimationProblem(**{**whole, **changes})


WRONG = (
    ({"horizon": 1}, "horizon must be at least 2 and integration_steps at least 1, got 1 and 1"),
    ({"integration_steps": 0}, "integration_steps at least 1, got 5 and 0"),
    ({"horizon": "5"}, "horizon and integration_steps must be whole numbers, got '5' and 1"),
    ({"horizon": 2.5}, "must be whole numbers, got 2.5 and 1"),
    ({"integration_steps": 1.5}, "must be whole numbers, got 5 and 1.5"),
    ({"integrator": "rk4"}, "integrator = 'rk4' is none of Integrator.RUNGE_KUTTA, Integrator.ROSENBROCK"),
    ({"integrator": Integrator.ADAPTIVE}, "integration_steps, the most that it may try, of at least 2, got 1"),
    ({"integration_tolerance": 0.0}, "integration_tolerance must lie between 0 and 1, got 0.0"),
    ({"integration_tolerance": math.nan}, "integration_tolerance must lie between 0 and 1, got nan"),
    ({"integration_tolerance": "fine"}, "A problem: numbers are allowed, got integration_tolerance = 'fine'"),
    ({"sample_time": "0.2"}, "A problem: numbers are allowed, got sample_time = '0.2'"),
    ({"sample_time": 0.0}, "sample_time must be positive"),
    ({"sample_time": math.nan}, "sample_time must be positive"),
    ({"sample_time": math.inf}, "sample_time must be positive"),
    ({"bounds": {"wings": Bound(lower=0.0, upper=1.0)}}, "bounds: 'wings' is no state"),
    ({"bounds": {"speed": (-1, 1)}}, "got {'speed': (-1, 1)}; give a Bound for each"),
    ({"bounds": [Bound(lower=0.0, upper=1.0)]}, "bounds go by name, such as {"),
)


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        *WRONG,
        (
            {"weights": (1.0, 1.0, 1.0)},
            "weights go by name, such as {'x': 1.0}, got (1.0, 1.0, 1.0); the names are x, y",
        ),
        ({"weights": without(WEIGHTS, "y")}, "weights: 'y' is missing; give 0.0 to what shall not count"),
        ({"weights": WEIGHTS | {"yaw": 1.0}}, "weights: there is no 'yaw'; the names are x, y, steering"),
        ({"weights": WEIGHTS | {"y": -1.0}}, "weights must be finite and not negative"),
        ({"weights": WEIGHTS | {"y": "a"}}, "weights: numbers are allowed, got y = 'a'"),
        ({"change_bounds": {"steering": 1.0}}, "change_bounds go by name, such as {"),
        ({"terminal_weights": {"x": 1.0}}, "terminal_weights: 'y' is missing"),
        ({"terminal_weights": TERMINAL | {"y": math.nan}}, "terminal_weights must be finite"),
        ({"terminal_weights": WEIGHTS}, "terminal_weights: 'steering' of 'tricycle_tractor' depends on an input"),
        ({"initial_weights": {"x": 1.0, "y": 1.0}}, "initial_weights: 'yaw' is missing"),
        (
            {"bounds": {"speed": Bound(lower=0.0, upper=1.0)}},
            "bounds: 'speed' is no state, input, output of 'tricycle_tractor'; there are x, y, yaw, steering",
        ),
    ],
)
def test_a_wrong_control_problem_is_refused(changes: dict[str, Any], complaint: str) -> None:
    with pytest.raises(SolverError, match=re.escape(complaint)):
        control(**changes)


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        *WRONG,
        ({"weights": without(SENSORS, "speed")}, "weights: 'speed' is missing"),
        (
            {"prior_deviation": without(DEVIATIONS, "hitch_angle")},
            "prior_deviation: 'hitch_angle' is missing; give how far off",
        ),
        ({"prior_deviation": DEVIATIONS | {"speed": 0.0}}, "prior_deviation must be positive"),
        ({"process_deviation": DEVIATIONS | {"speed": math.inf}}, "process_deviation must be finite"),
        ({"process_deviation": TERMINAL}, "process_deviation: there is no 'x', 'y'; the names are tractor_x"),
        ({"common_deviation": {"slip": 1.0}}, "common_deviation: there is no 'slip'"),
        ({"common_deviation": {"tractor_slip": -1.0}}, "common_deviation must be finite and not negative"),
        (
            {"acting": {"tractor_yaw": ca.SX(0.0)}},
            "acting: 'tractor_yaw' is no parameter of 'tricycle'; there are",
        ),
        (
            {"acting": {"speed": ca.SX(1.0)}, "integrator": Integrator.ADAPTIVE, "integration_steps": 9},
            "acting goes with integrators of equal steps only",
        ),
        ({"acting": {"speed": 1.0}}, "acting: 'speed' must be a scalar SX of the model's symbols"),
        ({"acting": {"speed": ca.SX.sym("wind")}}, "neither state, parameter nor constant of 'tricycle': ['wind']"),
    ],
)
def test_a_wrong_estimation_problem_is_refused(changes: dict[str, Any], complaint: str) -> None:
    with pytest.raises(SolverError, match=re.escape(complaint)):
        estimation(**changes)


@pytest.mark.parametrize(
    "values",
    [
        {"lower": 1.0, "upper": 0.0},
        {"lower": math.nan, "upper": 0.0},
        {"lower": 0.0, "upper": math.nan},
        {"lower": math.inf, "upper": math.inf},
        {"lower": -math.inf, "upper": -math.inf},
        {"lower": "0", "upper": 1.0},
        {"lower": 0.0, "upper": 1.0, "linear_penalty": 0.0},
        {"lower": 0.0, "upper": 1.0, "linear_penalty": -1.0, "quadratic_penalty": 2.0},
        {"lower": 0.0, "upper": 1.0, "linear_penalty": math.nan},
        {"lower": 0.0, "upper": 1.0, "linear_penalty": 1.0, "quadratic_penalty": -1.0},
        {"lower": 0.0, "upper": 1.0, "linear_penalty": 1.0, "quadratic_penalty": math.inf},
    ],
)
def test_a_wrong_bound_is_refused(values: dict[str, Any]) -> None:
    with pytest.raises(SolverError):
        Bound(**values)


def test_terminal_weight_of_an_output_of_the_input_may_be_zero_or_absent() -> None:
    assert row(control(terminal_weights=TERMINAL | {"steering": 0.0}).terminal_weights, MODEL.outputs) == [1, 1, 0]
    assert row(control().terminal_weights, MODEL.outputs) == [1, 1, 0]


def test_common_noise_moves_only_what_is_named() -> None:
    problem = estimation(common_deviation={"tractor_slip": 0.5})
    assert row(problem.common_deviation, problem.estimated) == [0.5 * (name == "tractor_slip") for name in DEVIATIONS]


def test_bounded_variables_are_those_that_can_move() -> None:
    box = Bound(lower=-1.0, upper=1.0)
    found = transcribe(control(bounds={"yaw": box, "steering": box})).bounds
    yaws, steerings = [3 * k + 2 for k in range(1, 6)], [18 + k for k in range(5)]
    assert [index for index, _ in found] == yaws + steerings, "the given first state is not bounded"
    bounds = {"tractor_yaw": box, "longitudinal_slip": box, "trailer_steering": box}
    found = transcribe(estimation(bounds=bounds)).bounds
    yaws, steerings = [11 * k + 2 for k in range(6)], [66 + 2 * k + 1 for k in range(5)]
    assert [index for index, _ in found] == [*yaws, 6, *steerings], "a constant is bounded once"


def test_another_length_and_sample_time_are_the_same_source() -> None:
    long = VehicleParameters(wheelbase=2.5, trailer_length=4.0)
    for problem, other in ((control, tricycle_tractor), (estimation, tricycle)):
        changed = transcribe(problem(model=other(long), sample_time=0.1))
        assert solver_source(changed) == solver_source(transcribe(problem()))
        assert [each.value for each in changed.constants if each.name in ("wheelbase", "sample_time")] == [2.5, 0.1]


def test_plain_numbers_of_a_model_are_in_its_source() -> None:
    def cart(gain: float) -> str:
        model = declare(
            "cart",
            states=variables(position="m"),
            inputs=variables(speed="m/s"),
            parameters=(),
            outputs=variables(position="m"),
            equations=lambda x, u, p: (gain * u, x),
        )
        weights = {"position": 1.0}
        return solver_source(transcribe(control(model=model, weights=weights, terminal_weights=weights)))

    assert cart(1.5) == cart(1.5)
    assert cart(1.5) != cart(2.5)


def test_indices_are_those_of_the_declaration() -> None:
    assert transcribe(control()).indices() == (
        "enum { X_X, X_Y, X_YAW };\nenum { U_STEERING };\n"
        "enum { P_LONGITUDINAL_SLIP, P_TRACTOR_SLIP, P_SPEED };\nenum { Y_X, Y_Y, Y_STEERING };\n"
    )
    states, *_ = transcribe(estimation()).indices().splitlines()
    assert states.endswith(
        "X_TRAILER_YAW, X_LONGITUDINAL_SLIP, X_TRACTOR_SLIP, X_TRAILER_SLIP, X_HITCH_ANGLE, X_SPEED };"
    )


@pytest.mark.parametrize("name", [name for name in runtime_sources() if MODEL_HEADER.match(name)])
def test_no_header_counts_the_elements_of_a_models_vector(name: str) -> None:
    assert not re.search(
        r"\b(state|x|u|p|y|p\[k\]|y\[k\]|(STATE|INPUT)\([^)]*\))\[\d+\](?!\[)", runtime_sources()[name]
    )
