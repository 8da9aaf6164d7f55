"""Sanity: signs in a run that no controller can mend, which slow it down or end it (sanity.h)."""

from typing import Annotated

from numpy.typing import ArrayLike
from pydantic import Field

from drawbar.codegen import Unit
from drawbar.settings import NonNegative, Positive, PositiveAngle, Settings, Share
from drawbar.vehicle.parameters import VehicleParameters


class SanitySettings(Settings):
    """When a run is driven slower, and when it ends, for what its sensors show."""

    lost: Positive = 6.0
    """distance of the tractor from the path at which the run ends, m; more than `guidance.maximum_start_distance`"""
    leaving: Positive = 1.5
    """the same once the tractor has followed the path, within 0.1 m for 5 m, m; on a real machine
    `safety.drive.leaving` stops before"""
    blind: Positive = 15.0
    """time without an accepted fix of either antenna after which the run ends, s"""
    blind_deviation: Positive = 0.15
    """standard deviation across the line, as the way without a fix makes it, at which the run ends, m; `drawbar drive`
    holds the estimator's own against `safety.drive.lateral_deviation`"""
    fine: Positive = 0.1
    """standard deviation up to which a fix is fine, m; RTK float is coarse"""
    coarse_after: NonNegative = 0.5
    """time with coarse fixes only, or with none, after which the vehicle is driven slower, s; with none not before 1.25
    times the interval of the last two, which is 1 s of receivers at 1 Hz"""
    coarse_share: Share = 0.5
    """part of the set speed then"""
    coarse_budget: Positive = 30.0
    """time with coarse fixes only after which the run ends, s"""
    jump: Positive = 0.3
    """distance of both bodies, all at once, from where their wheels have taken them, at which the run ends, m"""
    hitch: PositiveAngle = 0.15
    """difference of the measured hitch angle from the estimated one that is a contradiction on any ground, rad"""
    hitch_mean: PositiveAngle = 0.0489
    """mean difference, of hitch and joint together, that is one on smooth ground; on rough ground it is seven times
    what is usual there, rad; without meaning for an estimator without the chain"""
    hitch_patience: Positive = 0.7
    """for how long it may last before the run ends, s"""
    swing: Positive = 0.15
    """error to both sides in turn that is an oscillation, m"""
    steering_swing: PositiveAngle = 0.2
    """the same of the front wheels about the path's curvature, rad; half of it slows, for twice as many half waves"""
    swing_share: Share = 0.5
    """factor on the speed, each time that it begins to oscillate"""
    swing_calm: Positive = 30.0
    """driving without a swing after which the speed is tried once more that was the first to oscillate, s; from the
    second time on the speed stays low for the rest of the run"""
    swings_slow: Annotated[int, Field(ge=2)] = 3
    """half waves in a row after which the vehicle is driven slower"""
    swings_stop: Annotated[int, Field(ge=2)] = 6
    """half waves in a row after which the run ends"""


def sanity_unit(vehicle: VehicleParameters, settings: SanitySettings, *, position: float, chain: bool = True) -> Unit:
    """Return what watches a run from its first step on.

    Args:
        vehicle: whose wheelbase is known.
        settings: when to do what.
        position: standard deviation of one coordinate of a fix whose receiver reports none, m.
        chain: the estimator has the exact chain.
    """
    values: dict[str, ArrayLike] = {
        **settings.model_dump(exclude={"lost", "leaving", "blind", "blind_deviation"}),
        "wheelbase": vehicle.wheelbase,
        "positions.position": position,
    }
    values |= {f"positions.{key}": values.pop(key) for key in ("fine", "jump")}
    for setting, key in (("least", "hitch_mean"), ("most", "hitch"), ("patience", "hitch_patience")):
        values[f"hitch.{setting}"] = values.pop(key)
    if not chain:  # its estimates of the angles are wrong in every curve
        values |= {"hitch.least": settings.hitch, "hitch.patience": 2.0 * settings.hitch_patience}
    return Unit(name="sanity", source='#include "sanity.h"', configure=lambda workspace: workspace.write(values))
