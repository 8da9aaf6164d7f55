"""Advice where a tube leaves nothing of a bound: which declared bound to reduce, and to what."""

from collections.abc import Callable

from drawbar.control.settings import DECLARED_SECTIONS, BodyTubeSettings
from drawbar.control.tube.bounds import TightenedBound
from drawbar.control.tube.error_model import OPERATING_POINT


def advice(
    body: str, bound: TightenedBound, settings: BodyTubeSettings, left: Callable[[BodyTubeSettings], float]
) -> str:
    """Return by how much a bound is overdrawn and what would leave something of it.

    Args:
        body: tractor or trailer.
        bound: of which nothing is left.
        settings: declared.
        left: what of this bound other settings leave.
    """
    taken, unit = bound.tightening, bound.unit
    start = (
        f"The tube of the {body} leaves nothing of the {bound.name} bound: {bound.reach:.4g} {unit} less "
        f"{taken:.4g} {unit}."
    )
    spread = bound.contributions.get(OPERATING_POINT, 0.0)
    if spread > 0.5 * taken:
        start += (
            f" Of that, {spread:.4g} {unit} are due to the spread of tube.operating_range: narrow it, or give a faster "
            "gain."
        )
    from scipy.optimize import brentq  # takes long to import, and is rarely needed

    without = {
        (section, name): left(_with(settings, section, name, 0.0))
        for section in DECLARED_SECTIONS
        for name, size in getattr(settings, section).items()
        if size > 0.0
    }
    section, name = max(without, key=lambda key: without[key])
    declared, spare = getattr(settings, section)[name], without[section, name]
    share = float(brentq(lambda factor: left(_scaled(settings, factor)), 0.0, 1.0))
    if spare > 0.0:
        enough = float(brentq(lambda size: left(_with(settings, section, name, size)), 0.0, declared))
        alone = f"reduce it from {declared:.4g} to below {enough:.3g}"
    else:
        alone = f"but without its {declared:.4g}, {-spare:.4g} {unit} would still be wanting"
    return f"{start} {section}.{name} takes most: {alone}; or reduce all declared bounds to below {share:.1%}."


def _with(settings: BodyTubeSettings, section: str, name: str, size: float) -> BodyTubeSettings:
    return settings.model_copy(update={section: {**getattr(settings, section), name: size}})


def _scaled(settings: BodyTubeSettings, factor: float) -> BodyTubeSettings:
    sizes = {section: getattr(settings, section) for section in DECLARED_SECTIONS}
    return settings.model_copy(
        update={section: {name: factor * size for name, size in named.items()} for section, named in sizes.items()}
    )
