"""The extended Kalman filter: states and parameters jointly, one sample at a time, clipped to their bounds.

The arithmetic is C: extended_kalman.h, on the square-root filter of square_root_filter.h.
"""

import casadi as ca
import numpy as np

from drawbar.codegen import Unit, Workspace
from drawbar.codegen.emit import Output, emit, emit_constants
from drawbar.codegen.statements import Input
from drawbar.errors import ModelError
from drawbar.estimation.description import EstimationModel
from drawbar.geometry import Floats
from drawbar.optimal import EstimationProblem
from drawbar.optimal.problem import row
from drawbar.optimal.transcription import Transcription, transcribe
from drawbar.vehicle.model import column

_FILTER = "struct filter *work"
_UNIT = """
#define NX {states}
#define NU {inputs}
#define NY {outputs}
#define CONSTANTS {constants}
#define LANES 1
{indices}#include "{model}_estimation.h"
#include "extended_kalman.h"
{functions}
"""


def extended_kalman_unit(model: EstimationModel) -> Unit:
    """Return the filter on a model: it corrects by what was measured, clips to the bounds, predicts the next sample.

    Clipping: Simon 2010, section 2.4. Discretisation, weights, prior and process noise are those of the model's window
    problem: H^-1 is the covariance of the measurements. The inputs are measured too; their errors enter the prediction
    as noise through dF/du.

    Raises:
        ModelError: an input of the model is not measured.
    """
    problem, discrete = model.problem, transcribe(model.problem)
    _require_measured_inputs(discrete)

    def configure(workspace: Workspace) -> None:
        field, estimated = workspace.array, problem.estimated
        field("filter.constants")[:] = [each.value for each in discrete.constants]
        field("filter.prior")[:] = row(problem.prior_deviation, estimated)
        field("filter.drift")[:] = row(problem.process_deviation, estimated)
        field("filter.common")[:] = row(problem.common_deviation, estimated)
        field("filter.noise")[:] = np.power(row(problem.weights, problem.model.outputs), -0.5)
        field("filter.lower")[:], field("filter.upper")[:] = _bounds(problem)
        field("filter.input_row")[:] = np.flatnonzero(discrete.input_outputs)
        model.configure(workspace)

    return Unit(name="estimator", source=_source(discrete, model.name), configure=configure)


def _source(discrete: Transcription, model: str) -> str:
    """Return the C unit of the filter on a discretised model, whose header is named."""
    inputs = [
        Input(place="work->x[{k}][{i}]", rows="1", symbol=discrete.x),
        Input(place="work->u[{k}][{i}]", rows="1", symbol=discrete.u),
        Input(place="work->constants[{i}]", rows="", symbol=column(discrete.constants)),
    ]
    F, A, B, h, C = _linearised(discrete)
    functions = {
        "transition": [_vector("F", F), _matrix("A", A), _matrix("B", B)],
        "output": [_vector("h", h), _matrix("C", C)],
    }
    every = [result for results in functions.values() for result in results]
    return _UNIT.format(
        states=discrete.x.numel(),
        inputs=discrete.u.numel(),
        outputs=discrete.output.numel(),
        constants=len(discrete.constants),
        indices=discrete.indices(),
        model=model,
        functions=emit_constants("filter_constants", inputs, every, _FILTER)
        + "".join(emit(name, inputs, results, _FILTER) for name, results in functions.items()),
    )


def _linearised(discrete: Transcription) -> tuple[ca.SX, ...]:
    """Return F, dF/dx, dF/du, h, dh/dx."""
    x, u, step, output = discrete.x, discrete.u, discrete.next_state, discrete.output
    return (
        *ca.cse([step, ca.jacobian(step, x), ca.jacobian(step, u)]),
        *ca.cse([output, ca.jacobian(output, x)]),
    )


def _vector(field: str, value: ca.SX) -> Output:
    return Output(place=f"work->{field}[k]", rows="1", value=value)


def _matrix(field: str, value: ca.SX) -> Output:
    return Output(place=f"((double *)work->{field}[k])", rows="1", value=value)


def _require_measured_inputs(discrete: Transcription) -> None:
    """Refuse a model whose inputs are not, each by itself and in order, among its outputs."""
    rows = [row for row, depends in enumerate(discrete.input_outputs) if depends]
    measured = ca.vertcat(*(discrete.output[row] for row in rows))
    if not (measured.shape == discrete.u.shape and ca.is_equal(measured, discrete.u, 1)):
        raise ModelError(
            f"The extended Kalman filter needs every input of {discrete.name!r} as an output by itself; there are "
            f"inputs {discrete.u} and outputs {discrete.output}. Declare the missing ones, or use moving_horizon."
        )


def _bounds(problem: EstimationProblem) -> tuple[Floats, Floats]:
    """Return lower and upper bounds (nx + np,) of states and parameters, infinite where there is none."""
    bounds = [problem.bounds.get(variable.name) for variable in problem.estimated]
    lower = np.array([bound.lower if bound else -np.inf for bound in bounds])
    upper = np.array([bound.upper if bound else np.inf for bound in bounds])
    return lower, upper
