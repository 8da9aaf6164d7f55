"""Sources of an error model, from declared bounds: disturbances, errors of the estimate, the operating point.

The operating point's share is the disturbance (A_v - A) e by which the closed loop at any operating point v differs
from A in their middle, for e in the set itself. It is enclosed in a box of additive rates. Sets of a sum are sums of
sets, so the half-widths m of the box are the smallest solution of m = max over v of what m and all other sources make
of it, which iteration from zero approaches from below.
"""

from collections.abc import Sequence

import numpy as np

from drawbar.control.matrix_equations import spectral_radius
from drawbar.control.settings import BodyTubeSettings, Nominal
from drawbar.control.tube.error_model import OPERATING_POINT, ErrorModel, Source
from drawbar.control.tube.gain import check_names
from drawbar.control.tube.invariant_set import SLOWEST, Indices, InvariantSet
from drawbar.errors import TubeError
from drawbar.geometry import Floats

_CONVERGED = 1e-12
_HOPELESS = 1e6
"""Growth of the operating point's share, beside what it answers, from which on it has no end."""


def declared_sources(
    body: str, model: ErrorModel, gain: Floats, settings: BodyTubeSettings, nominal: Nominal
) -> tuple[Source, ...]:
    """Return the sources that are declared with a positive bound; gain: K (n,).

    Raises:
        ConfigurationError: a name is none of the model's.
    """
    check_names(f"tube.{body}.disturbances", settings.disturbances, model.disturbances)
    check_names(f"tube.{body}.estimation", settings.estimation, model.states)
    check_names(f"tube.{body}.increments", settings.increments, model.states)
    disturbances = [
        Source(name=name, unit=unit, bound=bound, generators=model.G[:, None, :, model.disturbances.index(name)])
        for name, unit in zip(model.disturbances, model.disturbance_units, strict=True)
        if (bound := settings.disturbances.get(name, 0.0)) > 0.0
    ]
    if nominal is Nominal.PREDICTED:
        estimates = [_innovation(model, settings, i) for i in range(len(gain))]
    else:
        estimates = [_fed_back(model, gain, settings, i) for i in range(len(gain))]
    return (*disturbances, *(source for source in estimates if source.bound > 0.0))


def _fed_back(model: ErrorModel, gain: Floats, settings: BodyTubeSettings, i: int) -> Source:
    """Return B K eps: an error of the estimate of state i disturbs the true one through the law alone."""
    name, generators = model.states[i], gain[i] * model.B[:, None, :]
    bound = settings.estimation.get(name, 0.0)
    return Source(name=f"estimate of {name}", unit=model.units[i], bound=bound, generators=generators)


def _innovation(model: ErrorModel, settings: BodyTubeSettings, i: int) -> Source:
    """Return eps+ - A eps of the estimate of state i: its increment where declared, or else of any two errors."""
    name, axis = model.states[i], np.eye(len(model.states))[i]
    if name in settings.increments:
        bound, generators = settings.increments[name], axis[None, None]
    else:
        bound = settings.estimation.get(name, 0.0)
        generators = np.stack([np.broadcast_to(axis, model.A[:, :, i].shape), model.A[:, :, i]], axis=1)
    return Source(name=f"estimate of {name}", unit=model.units[i], bound=bound, generators=generators)


def invariant_set(body: str, A: Floats, rates: Floats, sources: Sequence[Source], bounded: Indices) -> InvariantSet:
    """Return the set that e+ = A_v e + w never leaves at any of the operating points v, nor between them.

    Args:
        body: tractor or trailer, for messages.
        A: (v, n, n), which take the bounded coordinates to themselves.
        rates: (n, n), what additive rates, its columns, become over a sample.
        sources: declared, with generators of n coordinates.
        bounded: (b,) indices of the coordinates along which the set is bounded.

    Raises:
        TubeError: the operating points lie so far apart that no bound of their share supports itself.
    """
    loops, basis = A[:, bounded][:, :, bounded], rates[np.ix_(bounded, bounded)].T
    middle = 0.5 * (loops.max(axis=0) + loops.min(axis=0))
    if not spectral_radius(middle) < SLOWEST:
        raise _unsupported(body)
    kept = [source.within(bounded) for source in sources]
    # rows: half-widths that the operating point v asks for, as directions of e
    asked = np.linalg.solve(basis.T, loops - middle)
    units = [_operating_point(row[None]) for row in basis]
    parts = InvariantSet.of(middle, (*kept, *units), np.arange(len(bounded))).contributions(
        asked.reshape(-1, len(bounded))
    )
    parts = parts.reshape(len(loops), len(bounded), -1)
    size = _self_consistent(body, parts[:, :, len(kept) :], parts[:, :, : len(kept)].sum(axis=2))
    return InvariantSet.of(middle, (*kept, _operating_point(size[:, None] * basis)), bounded)


def _operating_point(segments: Floats) -> Source:
    return Source(name=OPERATING_POINT, unit="", bound=1.0, generators=segments[None])


def _self_consistent(body: str, own: Floats, others: Floats) -> Floats:
    """Return the smallest m (r,) with m = max over v of own[v] m + others[v], for own (v, r, r), others (v, r)."""
    size, hopeless = np.zeros(others.shape[1]), _HOPELESS * others.max()
    while size.max() <= hopeless:
        larger = (own @ size + others).max(axis=0)
        if np.all(larger <= size * (1.0 + _CONVERGED)):
            return np.asarray(larger * (1.0 + 1e3 * _CONVERGED))
        size = larger
    raise _unsupported(body)


def _unsupported(body: str) -> TubeError:
    return TubeError(
        f"the errors of the {body} have no bounds: while its speed, slip and steering change within "
        f"tube.operating_range, they may grow by more from one sample to the next than the gain in tube.{body} takes "
        f"back; lower sample_time or speed, narrow the ranges, or give a gain that lets errors decay faster"
    )
