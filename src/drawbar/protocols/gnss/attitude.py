"""Attitude of the body, from what a receiver reports of the line between its antennas."""

import math

from drawbar.geometry import wrap
from drawbar.protocols.gnss.messages import Attitude, Content, InertialAttitude
from drawbar.protocols.gnss.settings import AntennaSettings

_SMALL = 0.1
"""an inclination that is not measured may be left out where its share is below this"""


def choose_attitude(
    contents: list[Content], antennas: AntennaSettings, *, position_is_fixed: bool
) -> tuple[Attitude | None, str]:
    """Return the best attitude of an epoch that is plausible, None where there is none, or a reason to refuse it.

    A heading is taken while its own ambiguities are fixed; a sentence without that (HDT, THS) goes by the
    position's. The measured distance of the antennas must be the surveyed one.
    """
    given = [content for content in contents if isinstance(content, Attitude)]
    usable = [each for each in given if each.valid and _is_fixed(each, position_is_fixed)]
    if not usable:
        return None, "heading not fixed" if any(each.valid and math.isfinite(each.yaw) for each in given) else ""
    distances = [each.baseline for each in given if math.isfinite(each.baseline)]
    errors = [abs(each - antennas.baseline) for each in distances] if antennas.baseline > 0.0 else []
    if not max(errors, default=0.0) <= antennas.baseline_tolerance:
        return None, "heading with a wrong distance of antennas"
    return max(usable, key=lambda each: each.rank), ""


def _is_fixed(attitude: Attitude, position_is_fixed: bool) -> bool:
    return position_is_fixed if attitude.fixed is None else attitude.fixed


def body_attitude(attitude: Attitude | None, contents: list[Content], antennas: AntennaSettings) -> dict[str, float]:
    """Return yaw, roll and pitch of the body (rad), as fields of an epoch; what is known of them.

    What the line does not show is an inertial sensor's. How exact they are is stated in the configuration (`sensors`).
    A line at an angle a to the body measures its own inclination: roll = roll' cos a - pitch' sin a and
    pitch = roll' sin a + pitch' cos a, for small inclinations.
    """
    inertial = _inertial(contents)
    if attitude is None:
        return inertial
    sine, cosine = math.sin(antennas.line), math.cos(antennas.line)
    found = {
        "yaw": wrap(attitude.yaw - antennas.line),
        "roll": _sum(attitude.roll, cosine, attitude.pitch, -sine),
        "pitch": _sum(attitude.roll, sine, attitude.pitch, cosine),
    }
    return inertial | _known(found)


def _inertial(contents: list[Content]) -> dict[str, float]:
    """Return the attitude by the inertial sensor of a board."""
    sensor = next((each for each in contents if isinstance(each, InertialAttitude)), None)
    if sensor is None:
        return {}
    return {"inertial_yaw": sensor.yaw} | _known({"roll": sensor.roll, "pitch": sensor.pitch})


def _known(angles: dict[str, float]) -> dict[str, float]:
    return {name: value for name, value in angles.items() if math.isfinite(value)}


def _sum(first: float, share: float, second: float, other: float) -> float:
    """Return first * share + second * other, without a term that is missing and small; NaN if it is not small."""
    terms = ((first, share), (second, other))
    if any(math.isnan(value) and not abs(factor) <= _SMALL for value, factor in terms):
        return math.nan
    return sum(value * factor for value, factor in terms if not math.isnan(value))
