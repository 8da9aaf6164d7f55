"""Emitted C against CasADi's own evaluation of the same expressions."""

import re
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

from drawbar.codegen import Workspace, build
from drawbar.codegen.emit import Output, emit, emit_constants
from drawbar.codegen.statements import Input
from drawbar.errors import ModelError

BINARY = (
    lambda a, b: a + b,
    lambda a, b: a - b,
    lambda a, b: a * b,
    lambda a, b: a / (1 + b * b),
    lambda a, b: ca.atan2(a, 1 + b * b),
    lambda a, b: (1 + a * a) ** ca.tanh(b),
    ca.fmin,
    ca.fmax,
    lambda a, b: ca.if_else(a < b, a, ca.sin(b)),
)
UNARY = (
    lambda a: -a,
    lambda a: a * a,
    lambda a: a + a,
    lambda a: 1 / (2 + ca.sin(a)),
    ca.sin,
    ca.cos,
    lambda a: ca.tan(ca.tanh(a)),
    lambda a: ca.sqrt(1 + a * a),
    ca.fabs,
    lambda a: ca.exp(-a * a),
    lambda a: ca.log(1 + a * a),
    ca.atan,
    lambda a: ca.asin(0.9 * ca.tanh(a)),
    lambda a: ca.acos(0.9 * ca.tanh(a)),
    ca.tanh,
    lambda a: (1 + a * a) ** 1.7,
)


def random_matrix(rng: np.random.Generator, leaves: list[Any], shape: tuple[int, int], size: int) -> Any:
    """Return a matrix of expressions grown from the leaves, some entries constant, some structurally zero."""
    grown = list(leaves)
    for _ in range(size):
        a, b = (grown[i] for i in rng.integers(0, len(grown), 2))
        if rng.random() < 0.5:
            grown.append(UNARY[rng.integers(len(UNARY))](a))
        else:
            grown.append(BINARY[rng.integers(len(BINARY))](a, b))
    result = ca.SX(*shape)
    for i in range(shape[0]):
        for j in range(shape[1]):
            kind = rng.random()
            if kind < 0.6:
                result[i, j] = grown[rng.integers(len(leaves), len(grown))]
            elif kind < 0.8:
                result[i, j] = rng.choice([1.0, -2.5, 1e-300, 7.0])
    return result


@pytest.mark.parametrize("seed", range(4))
def test_random_expressions_for_any_number_of_stages(seed: int, compiled: Callable[..., Workspace]) -> None:
    rng = np.random.default_rng(seed)
    x, u = ca.SX.sym("x", 3), ca.SX.sym("u", 2)
    leaves = [*ca.vertsplit(x), *ca.vertsplit(u), ca.SX(0.7), ca.SX(-1.3)]
    f, g = random_matrix(rng, leaves, (3, 4), 60), random_matrix(rng, leaves, (2, 2), 30)
    unit = compiled(x, u, f, g)
    unit.array("x")[:], unit.array("u")[:] = rng.normal(size=(17, 3)), rng.normal(size=(5, 2))
    both = ca.Function("both", [x, u], [ca.densify(f), ca.densify(g)])
    later = np.minimum(np.arange(17), 4)  # rows beyond the last read the last one
    pairs = [both(a, b) for a, b in zip(unit.array("x"), unit.array("u")[later], strict=True)]
    expected_f = np.array([np.array(a).ravel() for a, _ in pairs])
    expected_g = np.array([np.array(b).ravel() for _, b in pairs])
    fixed_f, fixed_g = (np.array([e.is_constant() for e in ca.vertsplit(ca.vec(m.T))]) for m in (f, g))
    for count in (1, 7, 8, 9, 17):
        unit.array("f")[:], unit.array("g")[:] = np.nan, np.nan
        unit.array("first")[0], unit.array("count")[0] = 0, count
        unit.function("run")()
        for got, expected, fixed in (
            (unit.array("f"), expected_f, fixed_f),
            (unit.array("g"), expected_g, fixed_g),
        ):
            reached = min(count, len(got))
            np.testing.assert_allclose(got[:reached, ~fixed], expected[:reached, ~fixed], rtol=1e-12, atol=1e-13)
            assert np.isnan(got[reached:]).all(), "rows beyond the count were written"
            assert np.isnan(got[:, fixed]).all(), "entries that never change were written again"


def test_constants_are_laid_down_in_every_row(compiled: Callable[..., Workspace]) -> None:
    x, u = ca.SX.sym("x", 1), ca.SX.sym("u", 1)
    f = ca.SX(2, 2)
    f[0, 1], f[1, 0] = -2.5, x
    unit = compiled(x, u, f, ca.SX(3.0))
    unit.array("f")[:] = 9.0
    unit.function("constants")()
    np.testing.assert_array_equal(unit.array("f"), np.tile([9.0, -2.5, 9.0, 9.0], (17, 1)))
    np.testing.assert_array_equal(unit.array("g"), np.full((5, 1), 3.0))


def test_what_depends_on_constants_alone_is_laid_down_with_their_values(compiled: Callable[..., Workspace]) -> None:
    x, u, c = ca.SX.sym("x", 2), ca.SX.sym("u", 1), ca.SX.sym("c", 3)
    f = ca.vertcat(x[0] / c[0] + c[1] * c[2], ca.sin(c[1]) / c[2], x[0] * x[1] / (c[0] + c[2]), c[0])
    unit = compiled(x, u, f, c[1] * u, c)
    rng = np.random.default_rng(0)
    both = ca.Function("both", [x, u, c], [f, c[1] * u])
    for _ in range(2):
        unit.array("x")[:], unit.array("u")[:] = rng.normal(size=(17, 2)), rng.normal(size=(5, 1))
        unit.array("c")[:], unit.array("f")[:] = rng.uniform(1.0, 2.0, 3), np.nan
        unit.array("first")[0], unit.array("count")[0] = 0, 17
        unit.function("run")()
        np.testing.assert_array_equal(np.isnan(unit.array("f")[0]), [False, True, False, True])
        unit.function("constants")()
        for k, later in enumerate(np.minimum(np.arange(17), 4)):
            one, other = both(unit.array("x")[k], unit.array("u")[later], unit.array("c"))
            np.testing.assert_allclose(unit.array("f")[k], np.array(one).ravel(), rtol=1e-14)
            np.testing.assert_allclose(unit.array("g")[later], np.array(other).ravel(), rtol=1e-14)


def test_stages_before_the_first_are_left_alone(compiled: Callable[..., Workspace]) -> None:
    x, u = ca.SX.sym("x", 1), ca.SX.sym("u", 1)
    unit = compiled(x, u, 2 * x, x + u)
    unit.array("x")[:, 0] = np.arange(17)
    unit.array("first")[0], unit.array("count")[0] = 3, 12
    unit.function("run")()
    stages = np.arange(17)
    expected = np.where((stages >= 3) & (stages < 12), 2.0 * stages, 0.0)
    np.testing.assert_array_equal(unit.array("f")[:, 0], expected)
    np.testing.assert_array_equal(unit.array("g")[:, 0], [0, 0, 0, 3, 4])


_PACKED_UNIT = """
#define NX 5
#define NY 3
#include <math.h>
#include <stdint.h>
{include}
#include "lanes.h"
#include "fields.h"
#ifndef WIDTH
#define WIDTH 8
#endif
struct work {{ double x[11][2], padded[11][NY][WIDTH], flat[11][3][2], behind[2]; int32_t width; }};
{functions}
int64_t drawbar_size = sizeof(struct work);
const struct drawbar_field drawbar_fields[] = {{
    FIELD(work, x, 0, 11, 2, 0) FIELD(work, padded, 0, 11, NY * WIDTH, 0) FIELD(work, flat, 0, 11, 6, 0)
    FIELD(work, behind, 0, 2, 0, 0) FIELD(work, width, 1, 1, 0, 0) END_OF_FIELDS
}};
int constants(struct work *work) {{ work->width = WIDTH; lay_down(work); return 0; }}
int run(struct work *work) {{ evaluate(work, 0, 11); return 0; }}
"""


@pytest.mark.parametrize("include", ['#include "packs.h"', ""])
def test_results_that_are_stored_by_packs(include: str) -> None:
    x = ca.SX.sym("x", 2)
    padded, flat = ca.SX(3, 5), ca.SX(3, 2)
    padded[0, 0], padded[0, 2], padded[0, 4] = x[0], x[0] * x[1], ca.sin(x[0])
    padded[1, 0], padded[1, 1], padded[1, 3] = x[1], 4.0, x[0] - x[1]  # the pack has an entry that is laid down
    padded[2, 1], padded[2, 2] = x[0] + 1, x[1] + 2
    flat[0, 1], flat[1, 0], flat[2, 0], flat[2, 1] = x[0] + 3, 5 * x[1], x[0] + x[1], -x[0]
    inputs = [Input(place="work->x[{k}][{i}]", rows="11", symbol=x)]
    outputs = [
        Output(place="((double *)work->padded[k])", rows="11", value=padded, stride="WIDTH"),
        Output(place="((double *)work->flat[k])", rows="10", value=flat),
    ]
    functions = emit_constants("lay_down", inputs, outputs, "struct work *work")
    functions += emit("evaluate", inputs, outputs, "struct work *work")
    assert functions.count("write_four") == 3
    workspace = Workspace(build("packed", _PACKED_UNIT.format(include=include, functions=functions)))
    array = workspace.array
    array("x")[:] = np.random.default_rng(0).normal(size=(11, 2))
    array("flat")[10], array("behind")[:] = 8.0, 9.0
    workspace.function("constants")()
    workspace.function("run")()
    width = int(array("width")[0])
    for k in range(11):
        expected = np.zeros((3, width))
        values = ca.Function("f", [x], [ca.densify(padded), ca.densify(flat)])(array("x")[k])
        expected[:, :5] = values[0].full()
        np.testing.assert_allclose(array("padded")[k].reshape(3, width), expected, rtol=1e-15, atol=1e-15)
        wanted = values[1].full().ravel() if k < 10 else np.full(6, 8.0)
        np.testing.assert_allclose(array("flat")[k], wanted, rtol=1e-15, atol=1e-15)
    assert list(array("behind")) == [9.0, 9.0]


@pytest.mark.parametrize("bound", [ca.fabs, lambda a: ca.fmin(a, 0.3), lambda a: ca.fmax(0.3, a)])
def test_kinks_that_a_model_may_use_can_be_differentiated(
    bound: Callable[[Any], Any], compiled: Callable[..., Workspace]
) -> None:
    x, u = ca.SX.sym("x", 1), ca.SX.sym("u", 1)
    slope = ca.jacobian(bound(x) * x, x)
    unit = compiled(x, u, slope, u)
    unit.array("x")[:, 0] = np.linspace(-1, 1, 17)
    unit.array("count")[0] = 17
    unit.function("run")()
    expected = ca.Function("slope", [x], [slope])(unit.array("x").T)
    np.testing.assert_allclose(unit.array("f"), np.array(expected).T, atol=1e-15)


@pytest.mark.parametrize("unknown", [ca.erf, ca.floor, ca.sinh])
def test_operation_without_a_counterpart_is_refused(unknown: Callable[[Any], Any]) -> None:
    x = ca.SX.sym("x")
    row = Input(place="work->x[{k}][{i}]", rows="1", symbol=x)
    with pytest.raises(ModelError, match=re.escape("the C runtime does not have; allowed are + - * /")):
        emit("f", [row], [Output(place="work->f[k]", rows="1", value=unknown(x))], "struct work *work")


@pytest.mark.parametrize("value", [np.inf, -np.inf, np.nan])
def test_constant_that_is_no_finite_number_is_refused(value: float) -> None:
    x = ca.SX.sym("x")
    row = Input(place="work->x[{k}][{i}]", rows="1", symbol=x)
    with pytest.raises(ModelError, match="only finite numbers are allowed"):
        emit("f", [row], [Output(place="work->f[k]", rows="1", value=ca.atan2(value, x))], "struct work *work")
    with pytest.raises(ModelError, match="only finite numbers are allowed"):
        emit_constants("f", [row], [Output(place="work->f[k]", rows="1", value=ca.SX(value))], "struct work *work")
