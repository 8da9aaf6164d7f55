"""Statements of C that evaluate CasADi expressions: those that are the same for all stages, and those of each lane."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca

from drawbar.errors import ModelError

_BINARY = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*", ca.OP_DIV: "/", ca.OP_LT: "<", ca.OP_LE: "<="}
_TEMPLATES = {
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
    ca.OP_NOT: "{0} == 0.0",
    ca.OP_IF_ELSE_ZERO: "{0} != 0.0 ? {1} : 0.0",
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
    """A vector argument, stored row by row, or the same for all stages."""

    place: str
    """C expression of element {i} at stage {k}, e.g. `work->u[{k}][{i}]`"""
    rows: str
    """C expression: how many rows there are; later stages read the last one; empty: the same for all stages"""
    symbol: ca.SX
    """(n, 1) symbols"""


@dataclass(slots=True)
class Statements:
    """Statements that evaluate expressions, written one after the other."""

    once: list[str] = field(default_factory=list)
    """what is the same for all stages"""
    lanes: list[str] = field(default_factory=list)
    """the rest, for one stage, which ends in out[result][lane]"""
    gathered: list[tuple[int, int]] = field(default_factory=list)
    """(input, element) that the stage reads as in[index][lane]"""
    results: list[str] = field(default_factory=list)
    """names of the expressions' values"""
    _same: set[str] = field(default_factory=set)
    """names and numbers that are the same for all stages"""
    _inverses: dict[str, str] = field(default_factory=dict)
    """names of the inverses of divisors"""

    def constant(self, value: float) -> str:
        """Return a number as C has it."""
        literal = _literal(value)
        self._same.add(literal)
        return literal

    def read(self, source: Input, argument: int, element: int, name: str) -> str:
        """Let a name be an element of an input, which is the argument of this number, and return it."""
        if source.rows:
            self.lanes.append(f"const double {name} = in[{len(self.gathered)}][lane];")
            self.gathered.append((argument, element))
        else:
            self.once.append(f"const double {name} = {source.place.format(i=element)};")
            self._same.add(name)
        return name

    def compute(self, operation: int, arguments: list[str], name: str) -> str:
        """Let a name be the value of an operation, and return it."""
        if self._same.issuperset(arguments):
            self.once.append(f"const double {name} = {_expression(operation, arguments)};")
            self._same.add(name)
            return name
        if operation == ca.OP_DIV:  # a product is several times as fast, and divisors come again
            operation, arguments = ca.OP_MUL, [arguments[0], self._inverse(arguments[1])]
        self.lanes.append(f"const double {name} = {_expression(operation, arguments)};")
        return name

    def end(self, result: int, name: str) -> None:
        """Let the value of this name be an expression's."""
        self.lanes.append(f"out[{result}][lane] = {name};")
        self.results.append(name)

    def _inverse(self, value: str) -> str:
        """Return the name of a value's inverse."""
        if value not in self._inverses:
            name = self._inverses[value] = f"inverse{len(self._inverses)}"
            lines = self.once if value in self._same else self.lanes
            lines.append(f"const double {name} = 1.0 / {value};")
        return self._inverses[value]


def statements(inputs: Sequence[Input], expressions: Sequence[ca.SX]) -> Statements:
    """Return the statements of scalar expressions of the inputs.

    Raises:
        ModelError: an operation that the runtime does not have, or a constant that is not finite.
    """
    function = ca.Function("f", [i.symbol for i in inputs], [ca.vertcat(*expressions)])
    written, names = Statements(), dict[int, str]()
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        source, target = function.instruction_input(k), function.instruction_output(k)
        if operation == ca.OP_OUTPUT:
            written.end(target[1], names[source[0]])
        elif operation == ca.OP_CONST:
            names[target[0]] = written.constant(function.instruction_constant(k))
        elif operation == ca.OP_INPUT:
            names[target[0]] = written.read(inputs[source[0]], source[0], source[1], f"t{k}")
        else:
            names[target[0]] = written.compute(operation, [names[i] for i in source], f"t{k}")
    return written


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
    if operation in _TEMPLATES:
        return _TEMPLATES[operation].format(*arguments)
    if operation in _CALLS:
        return f"{_CALLS[operation]}({', '.join(arguments)})"
    raise ModelError(
        f"The model uses CasADi operation {operation}, which the C runtime does not have; allowed are + - * /, powers, "
        "sqrt, fabs, fmin, fmax, if_else with < and <=, exp, log, tanh and the trigonometric functions."
    )
