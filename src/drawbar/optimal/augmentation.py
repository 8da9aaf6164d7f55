"""Augmentation by states that the solver bounds already: bounds on outputs, weights and bounds on changes of inputs.

An output h(x_k, u_k, p_k) that is bounded becomes a state of the next stage, s_{k+1} = h(x_k, u_k, p_k); one that no
input enters becomes s_{k+1} = h(F(x_k, u_k, p_k), p_{k+1}). The input that was applied before is a state as well,
v_{k+1} = u_k, so that the change u_k - v_k is an output like any other. Nothing follows from these states, so the
problem's solution is that of the problem with the constraints.

Where a sample has several shooting intervals, v is what holds the input: with b_k = 1 in a sample's first interval and
0 in its others, the model gets b_k u_k + (1 - b_k) v_k in the place of u_k, and v_{k+1} is the same. The u_k of the
others move nothing.
"""

from dataclasses import dataclass
from typing import Any

import casadi as ca

from drawbar.optimal.bound import Bound
from drawbar.optimal.problem import ControlProblem


@dataclass(frozen=True, slots=True, kw_only=True)
class Augmentation:
    """What a problem has besides its model; the states go behind the model's, the outputs behind the model's."""

    x: Any
    """(m, 1) SX symbols: inputs before, then one state for each bound, on which nothing depends"""
    applied: Any
    """(nu, 1) SX of u, x and begins: what the model gets in the place of u"""
    begins: Any
    """(1, 1) SX symbol: 1 in a sample's first shooting interval, 0 in its others; (0, 1) where it has one only"""
    next_state: Any
    """(m, 1) SX of x, u, p and p_next"""
    output: Any
    """(n, 1) SX: changes of inputs that are weighed"""
    bounds: tuple[tuple[int, str, Bound], ...]
    """(index into x; name in the solver's `lower` and `upper`; bound), on stages 1..M of that state; of a change, on
    those that end a sample's first interval"""
    states: tuple[str, ...]
    """names of x"""
    outputs: tuple[str, ...]
    """names of output"""


def augment(problem: ControlProblem, next_state: Any, p_next: Any) -> Augmentation:
    """Return what a problem's output bounds and changes of inputs ask for.

    Args:
        problem: the problem.
        next_state: (nx, 1) SX: F(x, u, p) of its model.
        p_next: (np, 1) SX symbols of the parameters at the interval's end.
    """
    model = problem.model
    before = [f"{name}_before" for name in problem.remembered]
    x = ca.vertcat(*(ca.SX.sym(name) for name in before)) if before else ca.SX(0, 1)
    place = {variable.name: i for i, variable in enumerate(model.inputs)}
    inputs = {name: model.u[place[name]] for name in problem.remembered}
    change = {name: u - x[i] for i, (name, u) in enumerate(inputs.items())}
    depends = ca.which_depends(model.output, model.u, 1, True)
    at_end = ca.substitute(model.output, ca.vertcat(model.x, model.p), ca.vertcat(next_state, p_next))
    outputs = {variable.name: i for i, variable in enumerate(model.outputs)}
    bounded = [
        (name, problem.bounds[name], (model.output if depends[i] else at_end)[i])
        for name, i in outputs.items()
        if name in problem.bounded_outputs
    ]
    bounded += [(change_name(name), bound, change[name]) for name, bound in problem.change_bounds.items()]
    weighed = [name for name in change if name in problem.change_weights]
    begins, applied = ca.SX(0, 1), model.u
    if problem.intervals_per_sample > 1:
        begins, held = ca.SX.sym("begins"), ca.vertcat(*(x[before.index(f"{name}_before")] for name in place))
        applied = begins * model.u + (1.0 - begins) * held
    return Augmentation(
        applied=applied,
        begins=begins,
        x=ca.vertcat(x, *(ca.SX.sym(name) for name, _, _ in bounded)),
        next_state=ca.vertcat(ca.SX(0, 1), *inputs.values(), *(value for _, _, value in bounded)),
        output=ca.vertcat(ca.SX(0, 1), *(change[name] for name in weighed)),
        bounds=tuple((len(before) + i, name, bound) for i, (name, bound, _) in enumerate(bounded)),
        states=(*before, *(f"bounded_{name}" for name, _, _ in bounded)),
        outputs=tuple(map(change_name, weighed)),
    )


def change_name(name: str) -> str:
    """Return what the change of an input is called among the solver's bounds."""
    return f"{name}_change"
