"""Print a CasADi SX function as C99 that evaluates it for several stages at once, one stage per SIMD lane.

The shooting intervals are independent of each other, so the same straight-line arithmetic runs over arrays of
LANES values; the compiler turns each line into one vector instruction. Inputs are gathered from, and results
scattered to, time-major arrays; entries that are constant are not computed but laid down once (emit_constants).
"""

import math
from dataclasses import dataclass

import casadi as ca

from drawbar.errors import ModelError

_BINARY = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*", ca.OP_DIV: "/", ca.OP_LT: "<", ca.OP_LE: "<="}
_UNARY = {
    ca.OP_ASSIGN: "{0}",
    ca.OP_NEG: "-{0}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "2.0 * {0}",
    ca.OP_INV: "1.0 / {0}",
    ca.OP_SIN: "lane_sin({0})",
    ca.OP_COS: "lane_cos({0})",
    ca.OP_TAN: "lane_tan({0})",
    ca.OP_SQRT: "sqrt({0})",
    ca.OP_FABS: "fabs({0})",
    ca.OP_SIGN: "({0} > 0.0) - ({0} < 0.0)",
    ca.OP_EXP: "exp({0})",
    ca.OP_LOG: "log({0})",
    ca.OP_ATAN: "atan({0})",
    ca.OP_ASIN: "asin({0})",
    ca.OP_ACOS: "acos({0})",
    ca.OP_TANH: "tanh({0})",
}
_CALLS = {
    ca.OP_ATAN2: "atan2",
    ca.OP_POW: "pow",
    ca.OP_CONSTPOW: "pow",
    ca.OP_FMIN: "fmin",
    ca.OP_FMAX: "fmax",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Input:
    """A vector argument, stored row by row."""

    place: str
    """C expression of element {i} at stage {k}, e.g. `work->u[{k}][{i}]`"""
    rows: str
    """C expression: how many rows there are; later stages read the last one"""
    symbol: ca.SX
    """(n, 1) symbols"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Output:
    """A matrix result, stored row-major for each stage."""

    place: str
    """C expression of stage k's first element, e.g. `work->qp.A[k][0]`"""
    rows: str
    """C expression: stages that have this result"""
    value: ca.SX
    """(rows, columns) expressions"""
    stride: str = ""
    """C expression: numbers from one row to the next, where rows are padded; empty: the number of columns"""

    def entries(self) -> list[tuple[str, ca.SX]]:
        """Return (place, expression) of every structural nonzero."""
        rows, columns = self.value.sparsity().get_triplet()
        stride = self.stride or str(self.value.shape[1])
        return [(f"({self.place})[{i} * {stride} + {j}]", self.value[i, j]) for i, j in zip(rows, columns, strict=True)]


def emit_constants(name: str, outputs: list[Output], arguments: str) -> str:
    """Return a C function that lays down the entries which never change, in every stage.

    Raises:
        ModelError: an entry is infinite or NaN.
    """
    loops = []
    for output in outputs:
        lines = [f"{place} = {_literal(float(value))};" for place, value in output.entries() if value.is_constant()]
        if lines:
            loops.append(f"    for (int k = 0; k < {output.rows}; ++k) {{\n        {_join(lines, 8)}\n    }}\n")
    return f"static void {name}({arguments})\n{{\n    (void)work;\n{''.join(loops)}}}\n"


def emit(name: str, inputs: list[Input], outputs: list[Output], arguments: str) -> str:
    """Return a C function `name(arguments, first, count)` that evaluates stages first .. count-1.

    Raises:
        ModelError: the expressions use an operation that the runtime does not have, or a constant that is not
            finite.
    """
    varying = [(out, place, value) for out in outputs for place, value in out.entries() if not value.is_constant()]
    function = ca.Function(name, [i.symbol for i in inputs], [ca.vertcat(*(value for _, _, value in varying))])
    body, used = _statements(function)
    gather = []
    for index, (argument, element) in enumerate(used):
        source = inputs[argument]
        value = source.place.format(k=f"(k < {source.rows} ? k : {source.rows} - 1)", i=element)
        gather.append(f"in[{index}][lane] = {value};")
    scatter = []
    for output in outputs:
        lines = [f"{place} = out[{i}][lane];" for i, (owner, place, _) in enumerate(varying) if owner is output]
        if lines:
            scatter.append(f"if (k < {output.rows}) {{\n                {_join(lines, 16)}\n            }}")
    return f"""
static void {name}({arguments}, int first, int count)
{{
    for (int base = first; base < count; base += LANES) {{
        double in[{max(len(used), 1)}][LANES], out[{max(len(varying), 1)}][LANES];
        const int lanes = count - base < LANES ? count - base : LANES;
        EACH_LANE (int lane = 0; lane < LANES; ++lane) {{
            const int k = base + (lane < lanes ? lane : lanes - 1);
            {_join(gather, 12)}
        }}
        for (int lane = 0; lane < LANES; ++lane) {{
            {_join(body, 12)}
        }}
        for (int lane = 0; lane < lanes; ++lane) {{
            const int k = base + lane;
            {_join(scatter, 12)}
        }}
    }}
}}
"""


def _join(lines: list[str], indent: int) -> str:
    return ("\n" + " " * indent).join(lines)


def _statements(function: ca.Function) -> tuple[list[str], list[tuple[int, int]]]:
    """Return the function's instructions as C statements and the (argument, element) pairs they read."""
    names: dict[int, str] = {}
    used: list[tuple[int, int]] = []
    lines: list[str] = []
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        source, target = function.instruction_input(k), function.instruction_output(k)
        if operation == ca.OP_OUTPUT:
            lines.append(f"out[{target[1]}][lane] = {names[source[0]]};")
            continue
        if operation == ca.OP_CONST:
            names[target[0]] = _literal(function.instruction_constant(k))
            continue
        if operation == ca.OP_INPUT:
            used.append((source[0], source[1]))
            expression = f"in[{len(used) - 1}][lane]"
        else:
            expression = _expression(operation, [names[i] for i in source])
        lines.append(f"const double t{k} = {expression};")
        names[target[0]] = f"t{k}"
    return lines, used


def _literal(value: float) -> str:
    text = repr(float(value))
    if not math.isfinite(value):
        raise ModelError(
            f"The model or one of its derivatives has the constant {text}; only finite numbers are allowed."
        )
    return f"({text})" if text.startswith("-") else text


def _expression(operation: int, arguments: list[str]) -> str:
    if operation in _BINARY:
        return f"{arguments[0]} {_BINARY[operation]} {arguments[1]}"
    if operation in _UNARY:
        return _UNARY[operation].format(*arguments)
    if operation in _CALLS:
        return f"{_CALLS[operation]}({', '.join(arguments)})"
    raise ModelError(
        f"The model uses CasADi operation {operation}, which the C runtime does not have; allowed are + - * /, powers, "
        "sqrt, fabs, fmin, fmax, exp, log, tanh and the trigonometric functions."
    )
