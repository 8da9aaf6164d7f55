"""Kept rate: the steering rate that plans keep on a machine for which the tube's bounds were not declared.

What a tube takes off the steering rate follows from absolute errors, an estimated steering angle that is off for one,
and grows as the lag gets shorter; a slow cylinder has little to give. A vehicle whose plans keep a tenth of its rate
does not follow its line, though no bound is overdrawn. But the bound protects the model, not the cylinder, which cannot
turn faster anyway: so the disturbance by which the cylinder falls short is taken to be larger, and the set with it.
"""

from dataclasses import replace

from drawbar.control.settings import (
    ArticulatedControllerSettings,
    BodyTubeSettings,
    Nominal,
    TricycleControllerSettings,
    TubeSettings,
)
from drawbar.control.tube.bodies import Body, OperatingConditions, falling_short_by
from drawbar.control.tube.tube import bodies_of, tube_of
from drawbar.errors import TubeError

_RATE = "steering_rate"
_DOUBLINGS = 8
"""of the steering's rate, after which more falling short leaves no more of it"""
_EXACT = 1e-3
"""of what is searched"""
_SHARES = tuple(0.8**i for i in range(1, 11))
"""of a sample time that is too long, which are tried in its place"""


def with_kept_rates(
    controller: ArticulatedControllerSettings | TricycleControllerSettings,
    conditions: OperatingConditions,
    tube: TubeSettings,
) -> TubeSettings:
    """Return the tube's settings with disturbances of the steering rates that leave what shall be kept of them.

    Raises:
        TubeError: nothing leaves so much of a rate.
    """
    if isinstance(controller, TricycleControllerSettings):
        return tube
    try:
        return _with_kept(controller, conditions, tube)
    except TubeError as error:
        raise TubeError(f"{error}{_often_enough(controller, conditions, tube)}") from error


def _often_enough(
    controller: ArticulatedControllerSettings, conditions: OperatingConditions, tube: TubeSettings
) -> str:
    """Return with which sample time it could be done at this speed, "" where none of those tried suffices."""
    for share in _SHARES:
        tried = float(f"{share * conditions.sample_time:.2g}")
        try:
            _with_kept(controller, replace(conditions, sample_time=tried), tube)
        except TubeError:
            continue
        return f"; at this speed sample_time = {tried:g} s is short enough"
    return ""


def _with_kept(
    controller: ArticulatedControllerSettings, conditions: OperatingConditions, tube: TubeSettings
) -> TubeSettings:
    tractor, trailer = bodies_of(controller, conditions, tube)
    return tube.model_copy(
        update={
            "tractor": _kept("tractor", tractor, conditions, tube.tractor, tube.nominal),
            "trailer": _kept("trailer", trailer, conditions, tube.trailer, tube.nominal),
        }
    )


def _kept(
    name: str, body: Body, conditions: OperatingConditions, settings: BodyTubeSettings, nominal: Nominal
) -> BodyTubeSettings:
    """Return the settings of one body's tube, its steering rate disturbed by as much as leaves what is kept."""
    declared, rate = settings.disturbances.get(_RATE, 0.0), body.limits[-1].value

    def left(falling_short: float) -> tuple[float, float]:
        """Return what is left of the rate beyond what is kept, and of the bound of which least is left."""
        slow = falling_short_by(body, conditions, falling_short)
        bounds = tube_of(name, slow, _falling_short(settings, falling_short), nominal).bounds
        others = min(bound.tightened for quantity, bound in bounds.items() if quantity != _RATE)
        return bounds[_RATE].tightened - settings.kept_rate * rate, others

    beyond, others = left(declared)
    if not settings.kept_rate or beyond >= 0.0 or not others > 0.0:
        return settings
    tries = (declared + rate * 0.1 * 2.0**i for i in range(_DOUBLINGS))
    enough = next((size for size in tries if min(left(size)) >= 0.0), None)
    if enough is None:
        raise TubeError(
            f"from one sample to the next (sample_time = {conditions.sample_time:g} s, at speed = "
            f"{conditions.speed:g} m/s {conditions.speed * conditions.sample_time:.2g} m) errors of the {name} may "
            f"grow so much that steering against them leaves less of its steering rate, {rate:.3g} rad/s, than plans "
            f"need (tube.{name}.kept_rate = {settings.kept_rate:g}); lower sample_time or speed, or the gain in "
            f"tube.{name}"
        )
    little = declared
    while enough - little > _EXACT * enough:
        middle = 0.5 * (little + enough)
        enough, little = (middle, little) if min(left(middle)) >= 0.0 else (enough, middle)
    return _falling_short(settings, enough)


def _falling_short(settings: BodyTubeSettings, size: float) -> BodyTubeSettings:
    return settings.model_copy(update={"disturbances": {**settings.disturbances, _RATE: size}})
