"""The tubes of both bodies: gain, invariant set, and what it leaves of every bound.

The vehicle is at x, estimated at x^ = x + eps, and nominally at x̄; the law u = ū + K (x^ - x̄) acts on the estimate.
Which error is invariant depends on what the nominal state is:

    propagated   e = x - x̄:    e+  = (A + B K) e + G w + B K eps             (Mayne 2004)
    optimised    the same; x̄ may be chosen anew where x^ - x̄ lies in Z less E, so that x - x̄ lies in Z (Mayne 2005)
    predicted    e^ = x^ - x̄:  e^+ =      B K  e^ + G w + eps+ - A eps

The last starts from the estimate at every sample and carries no error on. With Z the invariant set and E that of eps,
the other of both errors lies in Z + E, and the nominal problem gets the bounds that remain when these are taken off.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations

import numpy as np

from drawbar.control.matrix_equations import spectral_radius
from drawbar.control.settings import (
    ArticulatedControllerSettings,
    BodyTubeSettings,
    Nominal,
    TricycleControllerSettings,
    TubeSettings,
)
from drawbar.control.tube import bodies
from drawbar.control.tube.advice import advice
from drawbar.control.tube.bodies import Body, OperatingConditions
from drawbar.control.tube.bounds import TightenedBound, tightened_bounds
from drawbar.control.tube.error_model import ErrorModel, Source
from drawbar.control.tube.gain import gain_of
from drawbar.control.tube.invariant_set import SLOWEST, Indices, InvariantSet
from drawbar.control.tube.sources import declared_sources, invariant_set
from drawbar.errors import TubeError
from drawbar.geometry import Floats
from drawbar.vehicle.parameters import VehicleParameters


@dataclass(frozen=True, slots=True, kw_only=True)
class SubsystemTube:
    """The tube of one body; without declared bounds it has no set and tightens nothing."""

    model: ErrorModel
    gain: Floats
    """K (n,): command, rad, per error"""
    nominal: Nominal
    estimation: Floats
    """(n,): half-widths of E"""
    invariant_set: InvariantSet | None
    """Z"""
    bounds: Mapping[str, TightenedBound]
    facets: Floats
    """(m, n): directions in which the margin is measured"""
    heights: Floats
    """(m,): how far x^ - x̄ can be in these directions"""

    def support(self, directions: Floats) -> Floats:
        """Return how far x - x̄ can be in directions (m, n): (m,), NaN without declared bounds."""
        return self._extent(directions, widened=self.nominal is Nominal.PREDICTED)

    def seen(self, directions: Floats) -> Floats:
        """Return how far x^ - x̄ can be in directions (m, n): (m,), NaN without declared bounds."""
        return self._extent(directions, widened=self.nominal is not Nominal.PREDICTED)

    def _extent(self, directions: Floats, *, widened: bool) -> Floats:
        if self.invariant_set is None:
            return np.full(len(directions), np.nan)
        extent = self.invariant_set.support(directions)
        return extent + np.abs(directions) @ self.estimation if widened else extent


@dataclass(frozen=True, slots=True, kw_only=True)
class Tubes:
    """The tubes of both bodies."""

    tractor: SubsystemTube
    trailer: SubsystemTube


def tubes_of(
    vehicle: VehicleParameters,
    controller: ArticulatedControllerSettings | TricycleControllerSettings,
    tube: TubeSettings,
    *,
    speed: float,
    sample_time: float,
) -> Tubes:
    """Return the tubes of both bodies at the set speed (m/s) with the sample time (s).

    Raises:
        ConfigurationError: a gain or declared bound belongs to none of the model's states or disturbances.
        TubeError: an error that is steered has no invariant set, or nothing is left of a bound.
    """
    conditions = OperatingConditions(vehicle=vehicle, ranges=tube.operating_range, speed=speed, sample_time=sample_time)
    tractor, trailer = bodies_of(controller, conditions, tube)
    tubes = Tubes(
        tractor=tube_of("tractor", tractor, tube.tractor, tube.nominal),
        trailer=tube_of("trailer", trailer, tube.trailer, tube.nominal),
    )
    overdrawn = [
        *overdrawn_bounds("tractor", tractor, tube.tractor, tubes.tractor),
        *overdrawn_bounds("trailer", trailer, tube.trailer, tubes.trailer),
    ]
    if overdrawn:
        raise TubeError("\n".join(overdrawn))
    return tubes if tube.tighten else Tubes(tractor=_untightened(tubes.tractor), trailer=_untightened(tubes.trailer))


def _untightened(tube: SubsystemTube) -> SubsystemTube:
    bounds = {name: replace(bound, reach=bound.original, contributions={}) for name, bound in tube.bounds.items()}
    return replace(tube, bounds=bounds)


def overdrawn_bounds(name: str, body: Body, settings: BodyTubeSettings, tube: SubsystemTube) -> list[str]:
    """Return what to do about each bound of which a tube leaves nothing."""

    def left(other: BodyTubeSettings, quantity: str) -> float:
        return tube_of(name, body, other, tube.nominal).bounds[quantity].tightened

    return [
        advice(name, bound, settings, partial(left, quantity=quantity))
        for quantity, bound in tube.bounds.items()
        if not bound.tightened > 0.0
    ]


def bodies_of(
    controller: ArticulatedControllerSettings | TricycleControllerSettings,
    conditions: OperatingConditions,
    tube: TubeSettings,
) -> tuple[Body, Body]:
    """Return the tractor and the trailer as this controller's models see them."""
    if isinstance(controller, TricycleControllerSettings):
        return bodies.tricycle_tractor_body(conditions), bodies.tricycle_trailer_body(conditions)
    slack = [settings.disturbances.get("steering_rate", 0.0) for settings in (tube.tractor, tube.trailer)]
    return bodies.articulated_tractor_body(conditions, slack[0]), bodies.articulated_trailer_body(conditions, slack[1])


def tube_of(name: str, body: Body, settings: BodyTubeSettings, nominal: Nominal) -> SubsystemTube:
    """Return the tube of the body of this name, even if it leaves nothing of a bound.

    Raises:
        ConfigurationError: a gain or declared bound belongs to none of the model's states or disturbances.
        TubeError: no error has an invariant set.
    """
    model = body.model
    gain = gain_of(name, model, settings)
    estimation = np.array([settings.estimation.get(state, 0.0) for state in model.states])
    sources = declared_sources(name, model, gain, settings, nominal)
    around = _invariant_set(name, model, closed_loop(model, gain, nominal), sources) if sources else None
    quantities, beside = _dependence(body, gain, nominal)
    tube = SubsystemTube(
        model=model,
        gain=gain,
        nominal=nominal,
        estimation=estimation,
        invariant_set=around,
        bounds=tightened_bounds(body.limits, quantities, around, np.abs(beside) @ estimation),
        facets=np.zeros((0, len(gain))),
        heights=np.zeros(0),
    )
    directions = np.array([*np.eye(len(gain)), *quantities])
    heights = tube.seen(directions)
    measured = np.isfinite(heights) & (heights > 0.0)
    return replace(tube, facets=directions[measured], heights=heights[measured])


def _invariant_set(name: str, model: ErrorModel, A: Floats, sources: tuple[Source, ...]) -> InvariantSet:
    rates = model.G[0][:, -len(model.states) :]
    return invariant_set(name, A, rates, sources, bounded_coordinates(name, model, A))


def _dependence(body: Body, gain: Floats, nominal: Nominal) -> tuple[Floats, Floats]:
    """Return how the limited quantities depend on the invariant error and on eps: (l, n) each.

    A quantity differs from its nominal value by c·(x - x̄) + d K (x^ - x̄). Where the nominal state starts at the
    estimate, x - x̄ is -eps.
    """
    states = np.array([limit.state for limit in body.limits])
    commands = np.array([limit.command * gain for limit in body.limits])
    if nominal is Nominal.PREDICTED:
        return commands, -states
    return states + commands, commands


def closed_loop(model: ErrorModel, gain: Floats, nominal: Nominal) -> Floats:
    """Return what becomes of e^ over a sample at every operating point, (v, n, n)."""
    fed_back = model.B[:, :, None] * gain
    return fed_back if nominal is Nominal.PREDICTED else model.A + fed_back


def bounded_coordinates(name: str, model: ErrorModel, A: Floats) -> Indices:
    """Return the largest set of coordinates (m,) that depend on nothing else and decay, at all points A (v, n, n).

    An error that no feedback brings back, the lateral one under a gain on yaw alone, has no bound; what does not depend
    on it may still have one.

    Raises:
        TubeError: not even one coordinate decays by itself.
    """
    n = len(model.states)
    for size in range(n, 0, -1):
        for kept in combinations(range(n), size):
            inside, outside = list(kept), [i for i in range(n) if i not in kept]
            alone = not np.any(np.abs(A[:, inside][:, :, outside]) > 1e-12)
            if alone and spectral_radius(A[0][np.ix_(inside, inside)]) < SLOWEST:
                return np.array(inside, dtype=np.intp)
    raise TubeError(
        f"the tube of the {name} has no invariant set: with this gain no error of ({', '.join(model.states)}) decays; "
        f"change the sign or size of the gain, or give lqr weights"
    )
