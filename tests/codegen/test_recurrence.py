"""A compiled recurrence gives what CasADi's own evaluation gives, one step after the other."""

import casadi as ca
import numpy as np

from drawbar.codegen.recurrence import CompiledRecurrence


def recurrence() -> ca.Function:
    """Return F with a sparse result, an unused input and one constant too many."""
    x, u, c = ca.SX.sym("x", 3), ca.SX.sym("u", 2), ca.SX.sym("c", 3)
    after = ca.SX(3, 1)
    after[0], after[2] = ca.sin(x[0]) + c[1] * x[2], ca.fmin(x[2] + u[1], c[0])
    return ca.Function("sparse", [x, u, c], [after])


def test_each_step_starts_where_the_last_one_ended() -> None:
    function, steps, rng = recurrence(), 7, np.random.default_rng(0)
    compiled = CompiledRecurrence(function, steps)
    for _ in range(3):
        compiled.state[:], compiled.constants[:] = rng.normal(size=3), rng.normal(size=3)
        compiled.inputs[:] = rng.normal(size=(steps, 2))
        compiled()
        state = compiled.state
        for inputs, got in zip(compiled.inputs, compiled.states, strict=True):
            state = np.array(function(state, inputs, compiled.constants)).ravel()
            np.testing.assert_allclose(got, state, rtol=1e-14, atol=1e-15)
