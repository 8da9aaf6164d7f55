"""A model declared once, symbolically: from this the solvers, filters and simulations are derived."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Self

import casadi as ca

from drawbar.errors import ModelError


@dataclass(frozen=True, slots=True, kw_only=True)
class Variable:
    """A named scalar with its unit."""

    name: str
    unit: str


def variables(**units: str) -> tuple[Variable, ...]:
    """Return variables from name=unit pairs, in order."""
    return tuple(Variable(name=name, unit=unit) for name, unit in units.items())


@dataclass(frozen=True, slots=True, kw_only=True)
class Constant:
    """A named number of a model with its unit, which stands in the expressions as a symbol.

    Solvers take its value as data: a change compiles nothing. Raises ModelError when the value is not finite.
    """

    name: str
    unit: str
    value: float
    symbol: Any
    """scalar SX symbol"""

    def __post_init__(self) -> None:
        if not math.isfinite(self.value):
            raise ModelError(f"The constant {self.name!r} is {self.value}; only finite numbers are allowed.")


def constant(name: str, unit: str, value: float) -> Constant:
    """Return a constant with a symbol of its own."""
    return Constant(name=name, unit=unit, value=value, symbol=ca.SX.sym(name))


@dataclass(frozen=True, slots=True, kw_only=True)
class Model:
    """x' = derivative(x, u, p) and outputs h(x, u, p), as CasADi SX expressions of the symbols x, u, p and constants.

    Plain numbers in the expressions belong to the model's structure: another number is another model to a solver, which
    is compiled again. Raises ModelError when shapes or names do not fit each other.
    """

    name: str
    states: tuple[Variable, ...]
    inputs: tuple[Variable, ...]
    parameters: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    x: Any
    """(nx, 1) SX symbols"""
    u: Any
    """(nu, 1) SX symbols"""
    p: Any
    """(np, 1) SX symbols, known at every stage"""
    derivative: Any
    """(nx, 1) SX, per second"""
    output: Any
    """(ny, 1) SX"""
    constants: tuple[Constant, ...] = ()
    """numbers in the expressions that are data"""

    def __post_init__(self) -> None:
        _check_variables(
            self.name, states=self.states, inputs=self.inputs, parameters=self.parameters, outputs=self.outputs
        )
        pairs = (
            ("states", self.states, self.x),
            ("states", self.states, self.derivative),
            ("inputs", self.inputs, self.u),
            ("parameters", self.parameters, self.p),
            ("outputs", self.outputs, self.output),
        )
        for what, declared, expression in pairs:
            if not isinstance(expression, ca.SX):
                raise ModelError(
                    f"Model {self.name!r}: the expression for its {what} is a {type(expression).__name__}, but must be "
                    f"CasADi's SX: make symbols by symbols() or ca.SX.sym, expand() functions of MX, and put constants "
                    f"into ca.SX(...)."
                )
            if expression.shape != (len(declared), 1):
                raise ModelError(
                    f"Model {self.name!r} declares {len(declared)} {what} but the expression has shape "
                    f"{expression.shape}; declare one variable for each row of a column vector."
                )
        if not self.states or not self.inputs:
            raise ModelError(f"Model {self.name!r} needs at least one state and one input.")
        self._refuse_duplicates()
        # by hash: names may repeat
        known = {s.element_hash() for s in ca.symvar(ca.vertcat(self.x, self.u, self.p, self.c))}
        free = ca.symvar(ca.vertcat(self.derivative, self.output))
        names = {str(s) for s in free if s.element_hash() not in known}
        if names:
            raise ModelError(
                f"Model {self.name!r} uses symbols that are neither state, input, parameter nor constant: "
                f"{sorted(names)}."
            )
        if any(math.isnan(number) for number in _numbers(ca.vertcat(self.derivative, self.output))):
            raise ModelError(
                f"Model {self.name!r} has NaN in its expressions; functions of Python's math return NaN for a symbol: "
                f"take CasADi's, such as ca.sin."
            )

    @property
    def names(self) -> dict[str, tuple[str, ...]]:
        """What the elements of x, u, p and output are called, by the letters X, U, P and Y."""
        vectors = {"X": self.states, "U": self.inputs, "P": self.parameters, "Y": self.outputs}
        return {letter: tuple(each.name for each in declared) for letter, declared in vectors.items()}

    @property
    def c(self) -> Any:
        """(nc, 1) SX symbols of the constants."""
        return column(self.constants)

    def numeric(self) -> Self:
        """Return the model with the values of its constants in the expressions: functions of x, u, p alone."""
        derivative, output = with_values([self.derivative, self.output], self.constants)
        return replace(self, derivative=derivative, output=output, constants=())

    def _refuse_duplicates(self) -> None:
        """Refuse a symbol or a name that stands for two things: bounds, weights and deviations go by name."""
        given = ca.vertcat(self.x, self.u, self.p, self.c)
        if not given.is_valid_input() or len({s.element_hash() for s in ca.symvar(given)}) != given.numel():
            raise ModelError(f"Model {self.name!r}: x, u, p, constants must be symbols, all different, got {given}.")
        given_names = [each.name for each in (*self.states, *self.inputs, *self.parameters)]
        given_names += [each.name for each in self.constants]
        for names in (given_names, [each.name for each in self.outputs]):
            repeated = sorted({name for name in names if names.count(name) > 1})
            if repeated:
                raise ModelError(
                    f"Model {self.name!r} declares {', '.join(map(repr, repeated))} more than once; give every state, "
                    f"input, parameter and constant a name of its own, and every output one among the outputs."
                )


def _numbers(expression: Any) -> list[float]:
    """Return the numbers in an SX expression."""
    f = ca.Function("f", [ca.vertcat(ca.SX(0, 1), *ca.symvar(expression))], [expression])
    constants = (each for each in range(f.n_instructions()) if f.instruction_id(each) == ca.OP_CONST)
    return [f.instruction_constant(each) for each in constants]


def _check_variables(name: object, **declared: object) -> None:
    """Refuse what declares no model."""
    if not isinstance(name, str):
        raise ModelError(f"The name of a model must be a text, got {name!r}.")
    for what, given in declared.items():
        if not (isinstance(given, tuple) and all(isinstance(each, Variable) for each in given)):
            raise ModelError(
                f"Model {name!r}: {what} must be a tuple of Variable, got {given!r}; give variables(name=unit, ...)."
            )


def column(constants: tuple[Constant, ...]) -> Any:
    """Return the constants' symbols as a column."""
    return ca.vertcat(*(each.symbol for each in constants)) if constants else ca.SX(0, 1)


def with_values(expressions: list[Any], constants: tuple[Constant, ...]) -> list[Any]:
    """Return the expressions with the constants' values in place of their symbols."""
    values = [each.value for each in constants]
    return list(ca.substitute(expressions, [column(constants)], [ca.DM(values)])) if constants else expressions


def by_name(declared: tuple[Variable, ...], values: Any) -> dict[str, Any]:
    """Return the elements of a column by the names of their variables."""
    return {variable.name: values[i] for i, variable in enumerate(declared)}


def symbols(declared: tuple[Variable, ...]) -> Any:
    """Return a column of SX symbols, one for each variable, under their names."""
    return ca.vertcat(*(ca.SX.sym(v.name) for v in declared)) if declared else ca.SX(0, 1)


def declare(
    name: str,
    *,
    states: tuple[Variable, ...],
    inputs: tuple[Variable, ...],
    parameters: tuple[Variable, ...],
    outputs: tuple[Variable, ...],
    equations: Callable[[Any, Any, Any], tuple[Any, Any]],
    constants: tuple[Constant, ...] = (),
) -> Model:
    """Return a model from what its variables are called and a function (x, u, p) -> (derivative, output).

    Of the constants it keeps those that the equations use.

    Raises:
        ModelError: the expressions do not fit the variables.
    """
    _check_variables(name, states=states, inputs=inputs, parameters=parameters, outputs=outputs)
    if not callable(equations):
        raise ModelError(f"Model {name!r}: equations must be a function (x, u, p), got {equations!r}; give such a one.")
    x, u, p = symbols(states), symbols(inputs), symbols(parameters)
    derivative, output = equations(x, u, p)
    used = {s.element_hash() for s in ca.symvar(ca.vertcat(derivative, output))}
    return Model(
        name=name,
        states=states,
        inputs=inputs,
        parameters=parameters,
        outputs=outputs,
        x=x,
        u=u,
        p=p,
        derivative=derivative,
        output=output,
        constants=tuple(each for each in constants if each.symbol.element_hash() in used),
    )
