"""The structured quadratic program under every solver of drawbar, on its own."""

from dataclasses import dataclass

import numpy as np

from drawbar.codegen import Workspace, build
from drawbar.errors import SolverError
from drawbar.signals import SolverStatus

_UNIT = """
#define N {stages}
#define NX {states}
#define NU {inputs}
#define NB {bounds}
#define NS 0
#define NC 0
#define CROSS 1
#define FREE_INITIAL {free}
#include "optimise.h"
#include "fields.h"
struct workspace {{ struct qp qp; union bounds_work work; }};
int64_t drawbar_size = sizeof(struct workspace);
const struct drawbar_field drawbar_fields[] = {{QP_FIELDS(qp, ) END_OF_FIELDS}};
int solve(struct workspace *s)
{{
    struct solver_resources resources = {{&s->work, IP_ITERATIONS}};
    s->qp.factored = 0;
    return s->qp.status = qp_optimise(&s->qp, &resources);
}}
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sizes:
    """Dimensions of a stage-structured quadratic program, fixed at compile time."""

    stages: int
    """N, shooting intervals"""
    states: int
    """NX"""
    inputs: int
    """NU"""
    bounds: int
    """number of bounded variables"""
    free_initial: bool
    """the first state is a variable (estimation) instead of given (control)"""

    def __post_init__(self) -> None:
        if min(self.stages, self.states, self.inputs) < 1 or self.bounds < 0:
            raise SolverError(f"A program needs at least one stage, state and input, and no negative bounds: {self}.")


class QuadraticProgram:
    """One quadratic program: write its data, solve(), read the solution, all as `array(name)`.

    Data are Q, S, R, A, B, c, g, initial, lower, upper, soft_linear, soft_quadratic and bound; the solution is z, pi
    and multiplier. The variables z are x_0 .. x_N, then u_0 .. u_{N-1}; `bound` holds the bounded ones' indices. A
    finite `soft_linear` makes a bound soft; it may be zero where `soft_quadratic` is positive. All matrices are zero at
    first, all bounds infinite and hard. qp.h has the problem's formula.
    """

    def __init__(self, sizes: Sizes) -> None:
        """Compile (or take from the cache) the solver for these sizes."""
        source = _UNIT.format(
            stages=sizes.stages,
            states=sizes.states,
            inputs=sizes.inputs,
            bounds=sizes.bounds,
            free=int(sizes.free_initial),
        )
        self.workspace = Workspace(build("qp", source))
        self.workspace.write({"lower": -np.inf, "upper": np.inf, "soft_linear": np.inf})
        self.array = self.workspace.array
        self._solve = self.workspace.function("solve")

    def solve(self) -> SolverStatus:
        """Solve the problem that the arrays hold."""
        return SolverStatus(self._solve())
