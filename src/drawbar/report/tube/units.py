"""Units in which people read quantities: centimetres and degrees."""

import math

_SHOWN = {
    "m": (100.0, "cm"),
    "rad": (math.degrees(1.0), "°"),
    "m/s": (100.0, "cm/s"),
    "rad/s": (math.degrees(1.0), "°/s"),
}


def scale(unit: str) -> tuple[float, str]:
    """Return what to multiply a value of this unit by, and the unit it then has."""
    return _SHOWN.get(unit, (1.0, "" if unit == "1" else unit))


def shown(value: float, unit: str) -> str:
    """Return a value with its unit, three significant digits, at most four decimals; infinity is `unbounded`."""
    factor, name = scale(unit)
    if not math.isfinite(value):
        return "unbounded" if value > 0.0 else "–"
    return with_unit(f"{round(factor * value, 4):.3g}", name)


def with_unit(number: str, unit: str) -> str:
    """Return a number with its unit, a degree sign without a space."""
    return f"{number}{unit}" if unit.startswith("°") else f"{number} {unit}".rstrip()


def title(name: str) -> str:
    """Return a name as words."""
    return name.replace("_", " ")
