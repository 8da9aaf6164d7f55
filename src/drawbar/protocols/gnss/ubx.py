"""UBX of u-blox: NAV-PVT, NAV-HPPOSLLH, NAV-RELPOSNED, and of NAV-STATUS whether signals are false.

NAV-PVT resolves 1.1 cm only; HPPOSLLH, of the same iTOW, has the digits. The library adds the high-precision parts into
HPPOSLLH's degrees and millimetres, and leaves mm, mm/s and cm.
"""

import math
from collections.abc import Callable

from drawbar.protocols.gnss.messages import (
    Accuracy,
    Attitude,
    Content,
    Date,
    Position,
    Spoofing,
    Velocity,
)
from drawbar.protocols.gnss.values import Values, place
from drawbar.signals import FixQuality

_MM = 1e-3
_THREE_DIMENSIONAL = 3
_CARRIER = {1: FixQuality.FLOAT, 2: FixQuality.FIXED}
_FIXED = 2
_SPOOFED = 2
"""from this state on: 2 and 3 are spoofing found once and several times, 1 none, 0 not known"""
_AGES = (math.nan, 0.5, 1.5, 3.5, 7.5, 12.5, 17.5, 25.0, 37.5, 52.5, 75.0, 105.0, 600.0)
"""the middle of each class of the age of corrections, s: limits of 5 and 20 s, where classes end, part the classes; the
last one, above 120 s, has no end"""


def pvt(values: Values) -> tuple[Content, ...]:
    """Return the position to 1.1 cm, velocity, quality, date."""
    latitude, longitude = place(
        values.number("lat", low=-90.0, high=90.0), values.number("lon", low=-180.0, high=180.0)
    )
    good = (
        values.integer("fixType") == _THREE_DIMENSIONAL
        and values.integer("gnssFixOk") == 1
        and values.integer("invalidLlh") == 0
    )
    plain = FixQuality.DIFFERENTIAL if values.integer("diffSoln") == 1 else FixQuality.SINGLE
    position = Position(
        latitude=latitude,
        longitude=longitude,
        height=values.number("height", _MM),
        altitude=values.number("hMSL", _MM),
        quality=_CARRIER.get(values.integer("carrSoln") or 0, plain) if good else FixQuality.NONE,
        code=values.integer("carrSoln"),
        satellites=values.integer("numSV"),
        correction_age=_AGES[min(values.integer("lastCorrectionAge") or 0, len(_AGES) - 1)],
        resolution=1e-7,
        rank=1,
    )
    speed, course = values.velocity("velN", "velE", _MM)
    date = values.day(values.integer("day"), values.integer("month"), values.integer("year"))
    velocity = Velocity(speed=speed, course=course)
    known = date is not None and values.integer("validDate") == 1
    return (position, velocity, _accuracy(values, rank=0), *((Date(day=date),) if known and date else ()))


def hpposllh(values: Values) -> tuple[Content, ...]:
    """Return the position to 0.1 mm, without quality."""
    latitude, longitude = place(
        values.number("lat", low=-90.0, high=90.0), values.number("lon", low=-180.0, high=180.0)
    )
    position = Position(
        latitude=latitude,
        longitude=longitude,
        height=values.number("height", _MM),
        altitude=values.number("hMSL", _MM),
        resolution=1e-9,
        rank=3,
    )
    return (position, _accuracy(values, rank=1)) if values.integer("invalidLlh") == 0 else ()


def _accuracy(values: Values, *, rank: int) -> Accuracy:
    """Return the deviation of each axis; hAcc is a radius."""
    axis = values.deviation("hAcc", _MM) / math.sqrt(2.0)
    return Accuracy(east=axis, north=axis, up=values.deviation("vAcc", _MM), impossible=axis <= 0.0, rank=rank)


def relposned(values: Values) -> tuple[Content, ...]:
    """Return yaw, inclination and length of the line from the moving base's antenna to the rover's."""
    length = values.number("relPosLength", 1e-2, low=0.0)
    down = values.number("relPosD", 1e-2)
    usable = all(values.integer(name) == 1 for name in ("gnssFixOK", "relPosValid", "relPosHeadingValid", "isMoving"))
    carrier = values.integer("carrSoln")
    attitude = Attitude(
        yaw=values.yaw("relPosHeading"),
        pitch=math.asin(down / length) if abs(down) < length else math.nan,
        baseline=length,
        fixed=carrier == _FIXED,
        valid=usable,
        code=carrier,
        rank=3,
    )
    return (attitude,)


def status(values: Values) -> tuple[Content, ...]:
    """Return whether the receiver has found spoofing; while it cannot decide, nothing is suspected."""
    return (Spoofing(suspected=(values.integer("spoofDetState") or 0) >= _SPOOFED),)


UBX: dict[tuple[int, int], tuple[str, int, Callable[[Values], tuple[Content, ...]]]] = {
    (0x01, 0x03): ("NAV-STATUS", 16, status),
    (0x01, 0x07): ("NAV-PVT", 92, pvt),
    (0x01, 0x14): ("NAV-HPPOSLLH", 36, hpposllh),
    (0x01, 0x3C): ("NAV-RELPOSNED", 64, relposned),
}
"""by class and id: name, length of the payload, reader"""
