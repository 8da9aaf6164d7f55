"""Problems that contradict themselves are refused when they are declared."""

import math
import re
from typing import Any

import pytest

from drawbar.codegen.cache import runtime_sources
from drawbar.errors import SolverError
from drawbar.optimal import Bound, ControlProblem, EstimationProblem
from drawbar.optimal.transcription import transcribe
from drawbar.vehicle.model import declare, variables
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle, tricycle_tractor

MODEL_HEADER = re.compile(r"(centralised_)?(articulated|tricycle)|at_rest|first_guess")
"""headers that belong to a model"""


def control(**changes: Any) -> ControlProblem:
    whole = {
        "model": tricycle_tractor(VehicleParameters()),
        "horizon": 5,
        "sample_time": 0.2,
        "weights": (1.0, 1.0, 1.0),
        "terminal_weights": (1.0, 1.0, 0.0),
    }
    return ControlProblem(**{**whole, **changes})


def estimation(**changes: Any) -> EstimationProblem:
    whole = {
        "model": tricycle(VehicleParameters()),
        "horizon": 5,
        "sample_time": 0.2,
        "weights": (1.0,) * 8,
        "prior_deviation": (1.0,) * 11,
        "process_deviation": (0.0,) * 11,
    }
    return EstimationProblem(**{**whole, **changes})


WRONG = (
    ({"horizon": 1}, "horizon of at least 2 stages"),
    ({"integration_steps": 0}, "1 integration step"),
    ({"sample_time": 0.0}, "sample time must be positive"),
    ({"sample_time": math.nan}, "sample time must be positive"),
    ({"sample_time": math.inf}, "sample time must be positive"),
    ({"bounds": {"wings": Bound(lower=0.0, upper=1.0)}}, "Bound on 'wings', which is no state"),
)


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        *WRONG,
        ({"weights": (1.0, 1.0)}, "weights needs 3 values, got 2"),
        ({"weights": (1.0, -1.0, 1.0)}, "weights must be finite and not negative"),
        ({"terminal_weights": (1.0, math.nan, 0.0)}, "terminal_weights must be finite"),
        ({"bounds": {"speed": Bound(lower=0.0, upper=1.0)}}, "Bound on 'speed', which is no state or input"),
    ],
)
def test_control_problem(changes: dict[str, Any], complaint: str) -> None:
    with pytest.raises(SolverError, match=re.escape(complaint)):
        control(**changes)


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        *WRONG,
        ({"weights": (1.0,) * 7}, "weights needs 8 values"),
        ({"prior_deviation": (1.0,) * 6}, "prior_deviation needs 11 values"),
        ({"prior_deviation": (0.0,) * 11}, "prior_deviation must be positive"),
        ({"process_deviation": (math.inf,) * 11}, "process_deviation must be finite"),
        ({"common_deviation": (1.0,) * 6}, "common_deviation needs 11 values"),
        ({"common_deviation": (-1.0,) * 11}, "common_deviation must be finite and not negative"),
    ],
)
def test_estimation_problem(changes: dict[str, Any], complaint: str) -> None:
    with pytest.raises(SolverError, match=re.escape(complaint)):
        estimation(**changes)


@pytest.mark.parametrize(
    "values",
    [
        {"lower": 1.0, "upper": 0.0},
        {"lower": math.nan, "upper": 0.0},
        {"lower": 0.0, "upper": math.nan},
        {"lower": 0.0, "upper": 1.0, "linear_penalty": 0.0},
        {"lower": 0.0, "upper": 1.0, "linear_penalty": math.nan},
        {"lower": 0.0, "upper": 1.0, "linear_penalty": 1.0, "quadratic_penalty": -1.0},
        {"lower": 0.0, "upper": 1.0, "linear_penalty": 1.0, "quadratic_penalty": math.inf},
    ],
)
def test_bound(values: dict[str, float]) -> None:
    with pytest.raises(SolverError):
        Bound(**values)


def test_terminal_weight_on_an_output_of_the_input_is_refused() -> None:
    with pytest.raises(SolverError, match=re.escape("its terminal weight must be 0, got 2.0")):
        transcribe(control(terminal_weights=(1.0, 1.0, 2.0)))


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
        assert changed.source() == transcribe(problem()).source()
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
        return transcribe(control(model=model, weights=(1.0,), terminal_weights=(1.0,))).source()

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
