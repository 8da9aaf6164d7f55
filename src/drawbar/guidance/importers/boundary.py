"""The boundary of an AgOpenGPS field (Boundary.txt), and where a straight line enters and leaves it.

The file holds after "$Boundary" for each ring True or False (whether one may drive through it), a count and as many
points "easting,northing,heading"; the first ring is the field's edge, further ones are areas within it.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats
from drawbar.guidance.importers.text import is_number, numbers, read_lines

_FEWEST = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Boundary:
    """A field's edge."""

    source: Path
    ring: Floats
    """(n, 2): east, north, m; the last point joins the first"""
    holes: tuple[Floats, ...] = ()
    """rings within it through which one may not drive"""

    def chord(self, point: Floats, ahead: Floats, place: str) -> tuple[float, float]:
        """Return where the line through a point enters and leaves the field, m along `ahead` from the point.

        Of several pieces within the field that with the point, or the nearest. Raises PathError, which names the
        line's place, where the line does not cross the field.

        Args:
            point: (2,) m.
            ahead: (2,) unit vector.
            place: of the line in its file.
        """
        edge = np.roll(self.ring, -1, axis=0) - self.ring
        across = ahead[0] * edge[:, 1] - ahead[1] * edge[:, 0]
        offset = self.ring - point
        with np.errstate(divide="ignore", invalid="ignore"):
            along = (offset[:, 0] * edge[:, 1] - offset[:, 1] * edge[:, 0]) / across
            share = (offset[:, 0] * ahead[1] - offset[:, 1] * ahead[0]) / across
        crossed = np.sort(along[(share >= 0.0) & (share < 1.0) & np.isfinite(along)])
        pieces = crossed[: len(crossed) // 2 * 2].reshape(-1, 2)
        if not len(pieces):
            raise PathError(
                f"{place}: the line does not cross the field of {self.source}; say how far it goes by path.extension, m"
            )
        distance = np.maximum(np.maximum(pieces[:, 0], -pieces[:, 1]), 0.0)
        first, last = pieces[int(distance.argmin())].tolist()
        return first, last


def read_boundary(file: Path) -> Boundary | None:
    """Return the edge of a field; None where the file holds none. Raises PathError with file and line number."""
    rows = read_lines(file) if file.stat().st_size else []
    rings: list[Floats] = []
    after = 0
    while (head := next((index for index in range(after, len(rows)) if is_number(rows[index])), None)) is not None:
        through = any(row.strip().lower() == "true" for row in rows[after:head])
        ring = _ring(file, rows, head)
        after = head + 1 + len(ring)
        if not rings and len(ring) < _FEWEST:
            return None
        if not rings or (len(ring) >= _FEWEST and not through):
            rings.append(ring)
    return Boundary(source=file, ring=rings[0], holes=tuple(rings[1:])) if rings else None


def _ring(file: Path, rows: list[str], head: int) -> Floats:
    """Return the points (n, 2) that a row announces."""
    announced = float(rows[head])
    if not (announced.is_integer() and announced >= 0.0):
        raise PathError(
            f"{file}:{head + 1}: announces {rows[head]} points; a whole number is allowed: export the field "
            f"from AgOpenGPS again"
        )
    count, first = int(announced), head + 1
    if head + count >= len(rows):
        raise PathError(
            f"{file}:{head + 1}: announces {count} points, but holds {len(rows) - head - 1}; export the field from "
            f"AgOpenGPS again"
        )
    points = [numbers(rows[index], 3, f"{file}:{index + 1}")[:2] for index in range(first, first + count)]
    ring = np.array(points).reshape(-1, 2)
    for bad in np.flatnonzero(~np.isfinite(ring).all(axis=1))[:1] + first:
        raise PathError(f"{file}:{bad + 1}: is {rows[bad]!r}; finite coordinates in m are needed")
    return ring
