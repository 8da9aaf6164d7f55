"""Inner box: the largest box in a zonotope, for a first state chosen with bounds on single states alone."""

from itertools import product

import numpy as np

from drawbar.control.tube.tube import SubsystemTube
from drawbar.errors import ConfigurationError
from drawbar.geometry import Floats

_TERMS = 60
"""Terms of the set's sum that are looked at; fewer make the box a little smaller."""


def inner_box(segments: Floats, shape: Floats) -> Floats:
    """Return half-widths (n,) of the largest box of a shape within the sum of segments from -row to +row.

    Every corner c must be a sum of t_j times the segments with |t_j| <= 1; the largest r for which r c all are is that
    of a linear programme. Opposite corners follow from the symmetry.

    Args:
        segments: (g, n).
        shape: (n,) half-widths, of which the box gets a multiple; zero where it shall have no extent.
    """
    from scipy.optimize import linprog  # takes long to import, and only this nominal state needs it
    from scipy.sparse import bmat, coo_matrix, csr_matrix, kron

    n = len(shape)
    corners = np.array([(1.0, *signs) for signs in product((-1.0, 1.0), repeat=n - 1)]) * shape
    # unknowns: r, then t of every corner; equations: segments' t - r c = 0
    combine = kron(np.eye(len(corners)), csr_matrix(segments.T))
    equations = bmat([[coo_matrix(-corners.reshape(-1, 1)), combine]]).tocsr()
    unknowns = equations.shape[1]
    found = linprog(
        -np.eye(1, unknowns)[0],
        A_eq=equations,
        b_eq=np.zeros(equations.shape[0]),
        bounds=[(0.0, None), *[(-1.0, 1.0)] * (unknowns - 1)],
    )
    half_widths: Floats = (found.x[0] if found.success else 0.0) * shape
    return half_widths


def initial_choice(tube: SubsystemTube) -> Floats:
    """Return half-widths (n,) of the box from which x̂ - x̄ may be chosen anew without leaving the tube.

    The box lies in Z less E, so that x - x̄ lies in Z whatever the error of the estimate (Mayne, Seron and Raković
    2005, with the estimate in place of the state). It is of Z's shape, zero where E leaves nothing of it, and infinite
    where Z has no bound.

    Raises:
        ConfigurationError: no bounds are declared, so that there is no set to choose from.
    """
    inside = tube.invariant_set
    if inside is None:
        raise ConfigurationError(
            'tube.nominal = "optimised" chooses the nominal state within the invariant set, which needs declared '
            "bounds of both bodies; declare them, or use another nominal state"
        )
    powers = inside.powers[:_TERMS]
    # of the hull over the operating points the first point's zonotope is inside
    segments = [source.bound * np.einsum("kij,gj->kgi", powers, source.generators[0]) for source in inside.sources]
    stacked = np.concatenate([each.reshape(-1, len(inside.bounded)) for each in segments])
    axes = np.eye(len(tube.gain))[inside.bounded]
    choice = np.full(len(tube.gain), np.inf)
    box = inner_box(stacked, inside.support(axes))
    choice[inside.bounded] = np.maximum(box - tube.estimation[inside.bounded], 0.0)
    return choice
