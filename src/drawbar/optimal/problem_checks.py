"""Checks of problems, each of which raises SolverError with what was given, what is allowed and what to do."""

import math
from collections.abc import Iterable, Mapping
from numbers import Integral
from typing import Any

import casadi as ca

from drawbar.errors import SolverError, demand
from drawbar.optimal.bound import Bound
from drawbar.optimal.given import check_numbers
from drawbar.vehicle.integrators import Integrator
from drawbar.vehicle.model import Model, Variable

LONGEST_HORIZON, MOST_INTERVALS = 10_000, 100
"""samples of a horizon, and integration steps in an interval; shooting intervals in a sample: code and memory grow with
them"""


def check_model(model: Any) -> None:
    """Refuse anything but a model."""
    demand("model", model, Model, "give one that declare() or Model(...) made", SolverError)


def check_time(horizon: int, sample_time: float, integrator: Integrator, steps: int, tolerance: float) -> None:
    """Refuse a horizon, sample time or integrator, its steps or tolerance, that is none."""
    if not (isinstance(horizon, Integral) and isinstance(steps, Integral)):
        raise SolverError(
            f"horizon and integration_steps must be whole numbers, got {horizon!r} and {steps!r}; give an int."
        )
    check_numbers("A problem", sample_time=sample_time, integration_tolerance=tolerance)
    if integrator not in tuple(Integrator):
        allowed = ", ".join(f"Integrator.{each.name}" for each in Integrator)
        raise SolverError(f"integrator = {integrator!r} is none of {allowed}; give one of these.")
    if horizon < 2 or steps < 1:
        raise SolverError(f"horizon must be at least 2 and integration_steps at least 1, got {horizon} and {steps}.")
    if horizon > LONGEST_HORIZON or steps > LONGEST_HORIZON:
        raise SolverError(
            f"horizon and integration_steps must be at most {LONGEST_HORIZON}, got {horizon} and {steps}; take longer "
            f"samples."
        )
    if integrator == Integrator.ADAPTIVE and steps < 2:
        raise SolverError(
            f"An adaptive integrator needs integration_steps, the most that it may try, of at least 2, got {steps}; "
            f"give 100, for one."
        )
    if not 0.0 < sample_time < math.inf:
        raise SolverError(f"sample_time must be positive and finite, got {sample_time} s.")
    if not 0.0 < tolerance < 1.0:
        raise SolverError(f"integration_tolerance must lie between 0 and 1, got {tolerance}; give 1e-4, for one.")


def check_intervals(intervals: Any) -> None:
    """Refuse a number of shooting intervals in a sample that is not whole, or too large."""
    if not (isinstance(intervals, Integral) and 1 <= int(intervals) <= MOST_INTERVALS):
        raise SolverError(f"intervals_per_sample must be a whole number from 1 to {MOST_INTERVALS}, got {intervals!r}.")


def check_values(
    what: str,
    values: Mapping[str, float],
    declared: Iterable[Variable],
    required: Iterable[Variable] | None = None,
    advice: str = "give 0.0 to what shall not count",
) -> None:
    """Refuse values that are not by name, of unknown names, not complete (required None: all), negative or infinite."""
    names = [variable.name for variable in declared]
    if not isinstance(values, Mapping):
        raise SolverError(
            f"{what} go by name, such as {{{names[0]!r}: 1.0}}, got {values!r}; the names are {', '.join(names)}."
        )
    unknown = [name for name in values if name not in names]
    if unknown:
        raise SolverError(f"{what}: there is no {', '.join(map(repr, unknown))}; the names are {', '.join(names)}.")
    check_numbers(what, **values)
    needed = names if required is None else [variable.name for variable in required]
    missing = [name for name in needed if name not in values]
    if missing:
        raise SolverError(f"{what}: {', '.join(map(repr, missing))} is missing; {advice}.")
    if not all(0.0 <= value < math.inf for value in values.values()):
        raise SolverError(f"{what} must be finite and not negative, got {dict(values)}.")


def check_bounds(model: Model, bounds: Any, kinds: Mapping[str, Iterable[Variable]], what: str = "bounds") -> None:
    """Refuse bounds that are not by name, or of unknown names; kinds: of variables that may be bounded."""
    names = [variable.name for kind in kinds.values() for variable in kind]
    if not isinstance(bounds, Mapping) or not all(isinstance(bound, Bound) for bound in bounds.values()):
        raise SolverError(
            f"{what} go by name, such as {{{names[0]!r}: Bound(lower=-1.0, upper=1.0)}}, got {bounds!r}; give a Bound "
            f"for each."
        )
    for name in bounds:
        if name not in names:
            raise SolverError(
                f"{what}: {name!r} is no {', '.join(kinds)} of {model.name!r}; there are "
                f"{', '.join(dict.fromkeys(names))}."
            )


def check_acting(model: Model, acting: Mapping[str, Any]) -> None:
    """Refuse what acts in the place of no parameter, is no scalar, or depends on foreign symbols."""
    names = [variable.name for variable in model.parameters]
    if unknown := [name for name in acting if name not in names]:
        raise SolverError(
            f"acting: {', '.join(map(repr, unknown))} is no parameter of {model.name!r}; there are {', '.join(names)}."
        )
    if wrong := [name for name, value in acting.items() if not isinstance(value, ca.SX) or not value.is_scalar()]:
        raise SolverError(f"acting: {', '.join(map(repr, wrong))} must be a scalar SX of the model's symbols.")
    known = {symbol.element_hash() for symbol in ca.symvar(ca.vertcat(model.x, model.p, model.c))}
    free = {str(s) for value in acting.values() for s in ca.symvar(value) if s.element_hash() not in known}
    if free:
        raise SolverError(
            f"acting uses symbols that are neither state, parameter nor constant of {model.name!r}: {sorted(free)}."
        )
