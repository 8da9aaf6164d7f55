"""A field: its boundary and its lines, in WGS84 degrees; what every format reads and writes."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats, LocalFrame

Degrees = Sequence[tuple[float, float]]
"""latitude and longitude of each point"""
_FEWEST_OF_LINE, _FEWEST_OF_RING = 2, 3
"""different points"""
_LONGEST = 100
"""bytes of a name"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldLine:
    """A line of a field."""

    name: str
    points: Floats
    """(n, 2): latitude and longitude, degrees. Two: an A-B line, which has no end; more: a curve"""

    @property
    def is_straight(self) -> bool:
        """Whether this is an A-B line."""
        return len(self.points) == 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """A field."""

    name: str
    lines: tuple[FieldLine, ...] = ()
    """each of another name"""
    boundary: Floats | None = None
    """(n, 2): latitude and longitude, degrees; the last point joins the first"""
    left_out: tuple[str, ...] = ()
    """what its source holds besides, in a few words each"""

    @property
    def is_empty(self) -> bool:
        """Whether there is neither a line nor a boundary."""
        return not self.lines and self.boundary is None

    def line(self, name: str) -> FieldLine:
        """Return a line by its name; raises PathError, which names those that there are."""
        found = next((line for line in self.lines if line.name == name), None)
        if found is None:
            names = ", ".join(repr(line.name) for line in self.lines) or "none"
            raise PathError(f"field {self.name!r} has no line {name!r}; its lines are: {names}")
        return found

    def frame(self) -> LocalFrame:
        """Return a plane that touches the Earth at the field's first point; raises PathError for a field of nothing."""
        known = [self.boundary] if self.boundary is not None else [line.points for line in self.lines]
        if not known:
            raise PathError(f"field {self.name!r} holds neither a line nor a boundary; record or import one")
        latitude, longitude = known[0][0].tolist()
        return LocalFrame(latitude=latitude, longitude=longitude)


def make_field(
    source: str,
    name: str,
    lines: Sequence[tuple[str, Degrees]],
    boundary: Degrees | None = None,
    left_out: Sequence[str] = (),
) -> Field:
    """Return a field of what a source holds, checked.

    Lines without a name are called by their place; of equal names the later ones get a number. A closed ring loses its
    last point. Lines of fewer than two different points are left out.

    Args:
        source: file or page, for errors.
        name: of the field.
        lines: name and points of each.
        boundary: outer ring.
        left_out: what else the source holds.

    Raises:
        PathError: a coordinate is none on Earth, or points are too few; names which.
    """
    taken: set[str] = set()
    found, besides = [], [*left_out]
    for index, (given, degrees) in enumerate(lines, 1):
        plain = plain_name(given) or f"line {index}"
        unique = plain if plain not in taken else next(n for i in count(2) if (n := f"{plain} ({i})") not in taken)
        taken.add(unique)
        points = _on_earth(f"{source}: line '{unique}'", degrees)
        if len(np.unique(points, axis=0)) >= _FEWEST_OF_LINE:
            found.append(FieldLine(name=unique, points=points))
        else:
            besides.append(f"line '{unique}' of fewer than {_FEWEST_OF_LINE} different points")
    ring = _ring(f"{source}: the boundary", boundary) if boundary is not None else None
    return Field(name=plain_name(name) or "field", lines=tuple(found), boundary=ring, left_out=tuple(besides))


def plain_name(name: str) -> str:
    """Return a name that can be that of a file, and a row of one."""
    plain = " ".join(re.sub(r"[/\\\x00-\x1f\x7f-\x9f]", " ", name).split()).lstrip(". ")
    return plain.encode("utf-8", "ignore")[:_LONGEST].decode("utf-8", "ignore")


def _ring(place: str, degrees: Degrees) -> Floats:
    ring = _on_earth(place, degrees)
    if len(np.unique(ring, axis=0)) < _FEWEST_OF_RING:
        raise PathError(f"{place} has fewer than {_FEWEST_OF_RING} different points; draw it again")
    return ring[:-1] if len(ring) > 3 and (ring[0] == ring[-1]).all() else ring


def _on_earth(place: str, degrees: Degrees) -> Floats:
    points = np.array(degrees, dtype=np.float64).reshape(-1, 2)
    for bad in np.flatnonzero(~((np.abs(points) <= (89.999, 180.0)).all(axis=1)))[:1]:
        raise PathError(
            f"{place}, point {bad + 1}: latitude {points[bad, 0]:z.10g}, longitude {points[bad, 1]:z.10g}; "
            f"degrees within ±90 and ±180 are needed"
        )
    return points
