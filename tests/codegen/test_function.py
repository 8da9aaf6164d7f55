"""A compiled CasADi function gives CasADi's own values and can be called again on the same arrays."""

import casadi as ca
import numpy as np

from drawbar.codegen import CompiledFunction


def test_matrices_sparse_results_and_unused_arguments() -> None:
    x, A, unused = ca.SX.sym("x", 3), ca.SX.sym("A", 3, 2), ca.SX.sym("unused", 2)
    sparse = ca.SX(2, 3)
    sparse[1, 2] = ca.sin(x[0])
    function = ca.Function("mixed", [x, A, unused], [ca.mtimes(A.T, x), sparse])
    compiled = CompiledFunction(function)
    rng = np.random.default_rng(0)
    for _ in range(3):
        for array in compiled.inputs:
            array[:] = rng.normal(size=array.size)
        compiled()
        arguments = compiled.inputs[0], compiled.inputs[1].reshape(3, 2, order="F"), compiled.inputs[2]
        for got, expected in zip(compiled.outputs, function(*arguments), strict=True):
            np.testing.assert_allclose(got, np.array(expected).ravel(order="F"), rtol=1e-14, atol=1e-15)


def test_functions_that_cannot_be_expanded() -> None:
    A, b = ca.MX.sym("A", 3, 3), ca.MX.sym("b", 3)
    function = ca.Function("linear", [A, b], [ca.solve(A, b)])
    compiled = CompiledFunction(function)
    matrix, vector = np.random.default_rng(1).normal(size=(3, 3)) + 3 * np.eye(3), np.array([1.0, 2.0, 3.0])
    compiled.inputs[0][:], compiled.inputs[1][:] = matrix.ravel(order="F"), vector
    compiled()
    np.testing.assert_allclose(compiled.outputs[0], np.linalg.solve(matrix, vector), rtol=1e-13)
