"""Smoothing of a recorded line to a path the vehicle can drive: curvature-continuous and within its limits."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drawbar.errors import PathError
from drawbar.geometry import Floats, LocalFrame
from drawbar.guidance import fairing
from drawbar.guidance.importers.line import RecordedLine
from drawbar.guidance.path import PIECE_LENGTH, Complexes, Path
from drawbar.guidance.settings import LineLimits

_DETAIL = 0.7
"""details of a recorded line shorter than this are smoothed everywhere, m"""
_KINK_DETAIL = 2.0
"""first guess where the line is too tight, m"""
_REACH = 12.0
"""how far before and after a spot that is too tight the line may be changed, m"""
_BEHIND = 4.0
"""margin of a kink's label: the trailer is still in it when the tractor has left, m"""
_NOTICEABLE = 0.05
"""distance from the recorded line that makes a stretch part of a kink, m"""
_STRAIGHT = 0.02
"""curvature below which a stretch is called straight, 1/m"""
_HELD = 4
"""nodes at either end of a stretch that its first guess shares with the rest of the line"""
_MARGIN = 0.995
"""share of the curvature limit that is used, for what the nodes' differences leave out"""
_RATE_MARGIN = 1.1
"""the linear programs hold the rate at the nodes to within this factor"""
_LONGEST_STRETCH = 2000.0
"""longest stretch that is worked on at once, m"""
_FEWEST_PIECES = 8
_PROJECTION_STEPS = 20
_PROJECTED = 1e-4
"""a recorded point is projected when it is no further than this ahead of its foot point, m"""
_LABELS = ("straight", "curve", "kink")


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivablePath:
    """A recorded line made drivable, and how far it had to leave the recorded points."""

    path: Path
    recorded: Floats
    """(n, 2): the recorded points, east and north, m"""
    deviations: Floats
    """(n,): distance of each recorded point from the path, m"""
    frame: LocalFrame | None
    """what the path's metres count from, for fixes; None: the line's source has none"""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Steps:
    """A recorded line resampled in equal steps."""

    recorded: Complexes
    """(n,): the recorded points, m"""
    points: Complexes
    """(m,): points in equal steps along the polyline, m"""
    vertices: NDArray[np.intp]
    """(n,): index of the step next to each recorded point"""
    step: float
    """m"""


def make_drivable(line: RecordedLine, limits: LineLimits) -> DrivablePath:
    """Return the path closest to the line within the limits.

    Classes are "straight", "curve", and "kink" where the line was tighter than the vehicle can turn. Raises
    PathError when a recorded point is too far from the path, or when no path was found.
    """
    line_in_steps = _resample(line.x + 1j * line.y)
    points, step = line_in_steps.points, line_in_steps.step
    faired = fairing.smooth(points, _DETAIL, step=step)
    allowed = _MARGIN * limits.curvature
    tight = _tight(faired, step, allowed, limits.curvature_rate)
    nodes = faired.copy()
    for stretch in _stretches(tight, round(_REACH / step)):
        _require_short(line, points[stretch], step)
        guess = _first_guess(line_in_steps, faired, stretch)
        nodes[stretch] = fairing.limit(
            guess,
            _judged(line_in_steps, stretch),
            curvature=allowed,
            rate=limits.curvature_rate,
            free=(stretch.start == 0, stretch.stop == len(points)),
        )
    kink = _spread(tight | _deviating(nodes, points), 0, round(_BEHIND / step))
    path, arc_length = _path_along(nodes, kink)
    deviations = _deviations(path, line_in_steps.recorded, arc_length[line_in_steps.vertices])
    _require_drivable(path, line.name, limits)
    _require_close(line, deviations, limits)
    recorded = np.column_stack([line.x, line.y])
    return DrivablePath(path=path, recorded=recorded, deviations=deviations, frame=line.frame)


def _resample(recorded: Complexes) -> _Steps:
    """Return the line in equal steps of at most PIECE_LENGTH."""
    along = fairing.chord_length(recorded)
    count = max(math.ceil(along[-1] / PIECE_LENGTH), _FEWEST_PIECES)
    step = float(along[-1]) / count
    points = np.interp(np.linspace(0.0, along[-1], count + 1), along, recorded)
    return _Steps(recorded=recorded, points=points, vertices=np.rint(along / step).astype(np.intp), step=step)


def _tight(nodes: Complexes, step: float, curvature: float, rate: float) -> NDArray[np.bool_]:
    """Return for each node whether the line bends or changes its curvature too fast there."""
    kappa = fairing.curvatures(nodes)
    tight = np.zeros(len(nodes), dtype=np.bool_)
    tight[1:-1] = np.abs(kappa) > curvature
    tight[2:-1] |= np.abs(np.diff(kappa)) > rate * step
    return tight


def _spread(flags: NDArray[np.bool_], before: int, after: int) -> NDArray[np.bool_]:
    """Set also the `before` flags ahead of each flag and the `after` behind it."""
    total = np.concatenate([[0], np.cumsum(flags)])
    index = np.arange(len(flags))
    spread: NDArray[np.bool_] = total[np.minimum(index + before + 1, len(flags))] > total[np.maximum(index - after, 0)]
    return spread


def _stretches(tight: NDArray[np.bool_], reach: int) -> list[slice]:
    """Return the runs of nodes that are within `reach` nodes of a tight one."""
    edges = np.flatnonzero(np.diff(_spread(tight, reach, reach), prepend=False, append=False))
    return [slice(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def _first_guess(line: _Steps, faired: Complexes, stretch: slice) -> Complexes:
    """Return the stretch smoothed more strongly, joined to the faired line at its ends."""
    guess = faired[stretch].copy()
    first = 0 if stretch.start == 0 else _HELD
    last = len(guess) if stretch.stop == len(faired) else len(guess) - _HELD
    guess[first:last] = line.points[stretch][first:last]
    return fairing.smooth(guess, _KINK_DETAIL, step=line.step, movable=slice(first, last))


def _judged(line: _Steps, stretch: slice) -> Complexes:
    """Return the points whose deviation counts on a stretch: the recorded ones and the steps between."""
    first, last = np.searchsorted(line.vertices, (stretch.start, stretch.stop)).tolist()
    judged: Complexes = np.concatenate([line.recorded[first:last], line.points[stretch]])
    return judged


def _deviating(nodes: Complexes, points: Complexes) -> NDArray[np.bool_]:
    """Return where the path runs noticeably beside the recorded points."""
    position, derivative = fairing.knots(nodes)
    offset = ((points - position) / derivative).imag * np.abs(derivative)
    deviating: NDArray[np.bool_] = np.abs(offset) > _NOTICEABLE
    return deviating


def _path_along(nodes: Complexes, kink: NDArray[np.bool_]) -> tuple[Path, Floats]:
    """Return the path along the nodes' B-spline, and the arc length at each of its knots (m)."""
    position, derivative = fairing.knots(nodes)
    yaw = np.unwrap(np.angle(derivative))
    half_turn = 0.5 * np.diff(yaw)
    # from chord to arc
    lengths = np.abs(np.diff(position)) / np.sinc(half_turn / math.pi)
    straight = np.abs(2.0 * half_turn) < _STRAIGHT * lengths
    classes = np.where(kink[1:] | kink[:-1], 2, np.where(straight, 0, 1))
    arc_length = np.concatenate([[0.0], np.cumsum(lengths)])
    path = Path.through(
        arc_length=arc_length,
        x=position.real,
        y=position.imag,
        yaw=yaw,
        label_of_piece=classes.astype(np.int8),
        label_names=_LABELS,
    )
    return path, arc_length


def _deviations(path: Path, recorded: Complexes, guess: Floats) -> Floats:
    """Return the distance of each recorded point from the path near the guessed arc lengths, m."""
    arc_length = guess
    for _ in range(_PROJECTION_STEPS):
        samples = path.sample(arc_length)
        offset = recorded - samples[:, 0] - 1j * samples[:, 1]
        ahead = np.clip((offset * np.exp(-1j * samples[:, 2])).real, -1.0, 1.0)
        if np.abs(ahead).max() <= _PROJECTED:
            break
        arc_length = arc_length + ahead
    distances: Floats = np.abs(offset)
    return distances


def _require_short(line: RecordedLine, points: Complexes, step: float) -> None:
    """Refuse a stretch that is too long to be worked on: it is noise, or no line for a vehicle."""
    if len(points) * step > _LONGEST_STRETCH:
        raise PathError(
            f"line {line.name!r} is too tight for the vehicle along {len(points) * step:.0f} m, "
            f"from ({points[0].real:z.1f}, {points[0].imag:z.1f}) m on; at most {_LONGEST_STRETCH:g} m of kinks in a "
            f"row can be rounded: smooth or redraw the line there"
        )


def _require_drivable(path: Path, name: str, limits: LineLimits) -> None:
    """Refuse a path that is broken, or whose curvature or its rate are out of the limits, saying where."""
    pieces = np.diff(path.nodes[:, 0])
    broken = path.broken_node()
    if broken >= 0:
        _, x, y, _ = path.nodes[broken]
        raise PathError(
            f"line {name!r} cannot be made drivable: near ({x:z.1f}, {y:z.1f}) m it goes back and forth: redraw the "
            f"line without this turn"
        )
    nodes = path.nodes[:-1, 0]
    samples = path.sample(nodes)
    middle = path.sample(nodes + 0.5 * pieces)
    rate = np.zeros(len(nodes))
    rate[1:] = np.diff(samples[:, 3]) / pieces[:-1]
    curvature = np.maximum(np.abs(samples[:, 3]), np.abs(middle[:, 3]))
    for what, values, limit, unit in (
        ("curvature", curvature, limits.curvature, "1/m"),
        ("curvature rate", np.abs(rate), _RATE_MARGIN * limits.curvature_rate, "1/m²"),
    ):
        worst = int(values.argmax())
        if not values[worst] <= limit:
            raise PathError(
                f"line {name!r} cannot be made drivable: near ({samples[worst, 0]:z.1f}, "
                f"{samples[worst, 1]:z.1f}) m its {what} stays at {values[worst]:.4g} {unit}; at most "
                f"{limit:g} {unit} is allowed: redraw the line without this turn"
            )


def _require_close(line: RecordedLine, deviations: Floats, limits: LineLimits) -> None:
    """Refuse a path that is too far from a recorded point, saying which and by how much."""
    worst = int(deviations.argmax())
    if not deviations[worst] <= limits.tolerance:
        raise PathError(
            f"line {line.name!r} is too tight for the vehicle: recorded point {worst + 1} at "
            f"({line.x[worst]:z.2f}, {line.y[worst]:z.2f}) m is {deviations[worst]:.3f} m from the closest "
            f"path within {limits.curvature:g} 1/m; at most {limits.tolerance:g} m is allowed: raise "
            f"guidance.path_tolerance, or vehicle.curvature_limit if it can turn tighter, or redraw the line there"
        )
