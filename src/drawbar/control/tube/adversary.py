"""Adversary: the disturbances that drive both bodies as far out of their tubes as declared bounds allow.

The error after N samples is linear in every disturbance before it, so its largest component in a direction a comes from
w_k at its bound with the sign of a M^(N-1-k) G, and eps_k with that of a M^(N-1-k) (M - A): bang-bang. M is the closed
loop; eps_k enters once as part of the estimate that the law acts on, and once where the next estimate corrects it.
"""

from collections.abc import Sequence

import numpy as np

from drawbar.bounded import EstimateErrors, GroundErrors
from drawbar.control.settings import Nominal
from drawbar.control.tube.tube import SubsystemTube, Tubes
from drawbar.geometry import Floats

_PUSH = 40
"""Samples that each direction is pushed in: errors have long forgotten what came before."""


def worst_signs(tubes: Tubes) -> tuple[Floats, Floats]:
    """Return the signs (m, 5) of GroundErrors and (m, 6) of EstimateErrors that push in one direction after the other.

    What acts on both bodies pushes the tractor first, and the trailer when all directions have had their turn.
    """
    ground, estimate = [], []
    for first in ("tractor", "trailer"):
        order = ("tractor", "trailer") if first == "tractor" else ("trailer", "tractor")
        directions = {body: _directions(getattr(tubes, body)) for body in order}
        for turn in range(max(map(len, directions.values()))):
            pushed = {body: _push(getattr(tubes, body), rows[turn % len(rows)]) for body, rows in directions.items()}
            ground.append(_merged(list(GroundErrors.model_fields), [pushed[body][0] for body in order]))
            named = [_of_estimate(body, pushed[body][1]) for body in order]
            estimate.append(_merged(list(EstimateErrors.model_fields), named))
    return np.concatenate(ground), np.concatenate(estimate)


def _directions(tube: SubsystemTube) -> Floats:
    """Return both ways (2n + 2, n) along every error and along the command that they ask for together."""
    directions = np.vstack([np.eye(len(tube.gain)), tube.gain])
    return np.concatenate([directions, -directions])


def _push(tube: SubsystemTube, direction: Floats) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Return by name the signs (_PUSH,) of disturbances and errors of the estimate that push in a direction (n,)."""
    A, G = tube.model.A[0], tube.model.G[0]
    fed_back = np.outer(tube.model.B[0], tube.gain)
    closed = fed_back if tube.nominal is Nominal.PREDICTED else A + fed_back
    disturbances, errors, row = [], [], direction
    for _ in range(_PUSH):
        disturbances.append(np.sign(row @ G))
        errors.append(np.sign(row @ (closed - A)))
        row = row @ closed
    return (
        dict(zip(tube.model.disturbances, np.array(disturbances[::-1]).T, strict=True)),
        dict(zip(tube.model.states, np.array(errors[::-1]).T, strict=True)),
    )


def _of_estimate(body: str, signs: dict[str, Floats]) -> dict[str, Floats]:
    """Return the signs by the names of EstimateErrors; the articulation is tractor yaw minus trailer yaw."""
    named = {f"{body}_{state}": values for state, values in signs.items() if state != "articulation"}
    return named | ({"trailer_yaw": -signs["articulation"]} if "articulation" in signs else {})


def _merged(names: Sequence[str], pushes: Sequence[dict[str, Floats]]) -> Floats:
    """Return (_PUSH, len(names)): of each name the signs of the first push that has it, or none."""
    known = {name: signs for push in reversed(pushes) for name, signs in push.items()}
    return np.stack([known.get(name, np.zeros(_PUSH)) for name in names], axis=1)
