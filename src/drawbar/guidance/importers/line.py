"""A recorded line: what every importer returns, checked."""

import logging
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats, LocalFrame
from drawbar.misspelt import meant

_LOGGER = logging.getLogger(__name__)

_LARGEST_COORDINATE = 1e7
"""m; room for UTM northings, none for nonsense"""
_FARTHEST = 1e5
"""m from the origin of degrees; beyond, the plane dips 800 m below the ground"""
_LARGEST_GAP = 100.0
"""a longer gap between neighbouring points, m, ..."""
_JUMP = 50.0
"""... that is also this many times the median one, is taken for a faulty point"""
_SAME_POINT = 1e-6
"""neighbouring points closer than this are one, m"""
_SHORTEST, _LONGEST = 0.1, 2e6
"""lengths between which a line may be one, m; outside, degrees were taken for metres or the reverse"""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedLine:
    """The points of a line in driving order; at least two, each apart from its neighbours."""

    name: str
    x: Floats
    """(n,): east, m"""
    y: Floats
    """(n,): north, m"""
    frame: LocalFrame | None = None
    """what x and y count from, for the fixes that are to be compared with them; None: the source has none"""

    @classmethod
    def checked(cls, name: str, points: Floats, places: list[str]) -> Self:
        """Check points (n, 2) in m, found at the given places of the source, and drop repeated ones.

        places are (n,), or the line's own place where it has no points. Raises PathError, which names the
        place, for a point that is not finite, too far out or too far from its predecessor, and for a line
        that has fewer than two different points or is too short or too long to be one.
        """
        for bad in np.flatnonzero(~(np.abs(points) <= _LARGEST_COORDINATE).all(axis=1))[:1]:
            raise PathError(
                f"{places[bad]}: point {_pair(points[bad])} m of line {name!r}; coordinates must be finite and "
                f"within ±{_LARGEST_COORDINATE:g} m of the origin: remove the point, or use an origin in the field"
            )
        step = np.hypot(*np.diff(points, axis=0).T)
        longest = max(_LARGEST_GAP, _JUMP * float(np.median(step))) if len(step) else 0.0
        for bad in np.flatnonzero(step > longest)[:1] + 1:
            raise PathError(
                f"{places[bad]}: line {name!r} jumps {step[bad - 1]:.0f} m to {_pair(points[bad])} m; "
                f"at most {longest:.0f} m are allowed between its neighbours: remove the faulty point"
            )
        apart = np.concatenate([np.ones(min(len(points), 1), dtype=bool), step > _SAME_POINT])
        kept, repeated = points[apart], int((~apart).sum())
        if len(kept) < 2:
            raise PathError(
                f"{places[0]}: line {name!r} has fewer than two different points; it needs at least two that "
                f"are more than {1e3 * _SAME_POINT:g} mm apart"
            )
        if not (_SHORTEST <= (length := float(step.sum())) <= _LONGEST):
            metres = f"{length:.0f}" if length > 1.0 else f"{length:.4g}"
            raise PathError(
                f"{places[0]}: line {name!r} is {metres} m long; {_SHORTEST:g} m to {1e-3 * _LONGEST:g} km are "
                f"allowed: are its coordinates in metres, as CSV and AgOpenGPS have them, or in degrees, as "
                f"GeoJSON has them?"
            )
        if repeated:
            _LOGGER.warning("line %r: repeated points dropped: %d", name, repeated)
        return cls(name=name, x=kept[:, 0].copy(), y=kept[:, 1].copy())


def on_frame(latitude: Floats, longitude: Floats, frame: LocalFrame, places: list[str]) -> Floats:
    """Return WGS84 degrees (n,), found at the given places of a source, as points (n, 2) of the frame, m.

    Raises PathError for a point so far from the origin that no plane holds both.
    """
    points = np.column_stack(frame.east_north_up(latitude, longitude, frame.height))
    for bad in np.flatnonzero(~(np.linalg.norm(points, axis=1) <= _FARTHEST))[:1]:
        raise PathError(
            f"{places[bad]}: latitude {latitude[bad]:z.10g}°, longitude {longitude[bad]:z.10g}° is more than "
            f"{_FARTHEST / 1e3:g} km from latitude {frame.latitude:z.10g}°, longitude {frame.longitude:z.10g}°, where "
            f"the metres count from: remove the point, or correct the origin"
        )
    return points[:, :2]


def _pair(point: Floats) -> str:
    return f"({point[0]:z.10g}, {point[1]:z.10g})"


def choose(source: Path, names: list[str], wanted: str | None) -> int:
    """Return the index of the wanted line in a source; None wants the only one.

    Raises PathError, which names the lines, when the name is missing, unknown or not unique.
    """
    listed = ", ".join(map(repr, names)) or "none"
    found = [index for index, name in enumerate(names) if wanted in (None, name)]
    if not found:
        near = meant(wanted or "", names)
        raise PathError(f"{source}: has no line {wanted or ''!r}{near}; its lines are: {listed}")
    times = Counter(names[index] for index in found)
    for name, count in times.most_common(1):
        if count > 1:
            raise PathError(f"{source}: has {count} lines named {name!r}; give them different names")
    if len(found) > 1:
        raise PathError(f"{source}: holds {len(names)} lines: {listed}; choose one with --track NAME or path.track")
    return found[0]
