"""The figures of a run as rows of text, the same for the console and the page; a missing figure is a dash."""

import math
from collections.abc import Mapping

from drawbar.report.metrics import ALL, Metrics, PhaseTimes

ERROR_COLUMNS = ("mean", "rms", "sd", "95 %", "max")
_STATISTICS = ("mean", "rms", "deviation", "p95", "max")
TIME_COLUMNS = ("median", "p99", "max")

Row = tuple[str, list[str]]
"""a title and its cells"""
_UNKNOWN = "–"


def number(value: float, digits: int = 1, unit: str = "") -> str:
    """Return the value with a fixed number of digits and its unit; NaN is a dash, zero has no sign."""
    return _UNKNOWN if math.isnan(value) else f"{value:z.{digits}f}{unit}"


def _known(rows: list[Row]) -> list[Row]:
    """Return the rows with a known figure: those of parts of the path that were driven, and of what was measured."""
    return [row for row in rows if any(cell != _UNKNOWN for cell in row[1])]


def class_title(label: str) -> str:
    """Return a class of the path in words: a curvature gets its unit."""
    return f"curve {label}/m" if label[:1].isdigit() else label


def origin(metrics: Metrics, between: str) -> str:
    """Return the configuration's name, and where a simulation drew errors from it, its seed; between: the two."""
    return metrics.config if metrics.error_estimated else f"{metrics.config}{between}seed {metrics.seed}"


def error_name(metrics: Metrics) -> str:
    """Return what the distances from the path are: errors, or estimated errors."""
    return "estimated error" if metrics.error_estimated else "error"


def error_rows(metrics: Metrics) -> list[Row]:
    """Return per class of the path that was driven the ERROR_COLUMNS of the tractor, then of the trailer, cm."""
    error = metrics.error_m
    rows = [
        (
            class_title(label),
            [
                number(100.0 * getattr(body[label], name), 1)
                for body in (error.tractor, error.trailer)
                for name in _STATISTICS
            ],
        )
        for label in error.tractor
    ]
    return _known(rows)


def time_rows(metrics: Metrics) -> list[Row]:
    """Return per solver and phase median, 99th percentile and maximum of the time of one call, µs."""
    times = metrics.solve_time_s
    solvers: dict[str, PhaseTimes] = {
        "estimator": times.estimator,
        "tractor": times.tractor,
        "trailer": times.trailer,
    }
    rows = [
        (
            f"{solver}, {phase}",
            [number(1e6 * getattr(getattr(phases, phase), name), 1) for name in TIME_COLUMNS],
        )
        for solver, phases in solvers.items()
        for phase in ("prepare", "feedback")
    ]
    return rows if _known(rows) else []


def body_rows(metrics: Metrics) -> list[Row]:
    """Return what is one figure per body, of the tractor, then of the trailer, each with its unit."""
    figures = (
        ("yaw error, RMS", metrics.yaw_rmse_rad, math.degrees(1.0), 2, "°"),
        ("mean steering rate", metrics.steering_rate_mean_rad_s, math.degrees(1.0), 1, "°/s"),
        ("on straights", metrics.steering_rate_straight_rad_s, math.degrees(1.0), 1, "°/s"),
        ("ancillary share", metrics.ancillary_share, 100.0, 1, " %"),
        ("clipped commands", metrics.saturated_share, 100.0, 1, " %"),
        ("steering at its limit", metrics.at_limit_share, 100.0, 1, " %"),
        ("least tube margin", metrics.tube_margin_min, 100.0, 0, " %"),
    )
    rows = [
        (title, [number(scale * value, digits, unit) for value in (figure.tractor, figure.trailer)])
        for title, figure, scale, digits, unit in figures
    ]
    return _known(rows)


def key_figures(metrics: Metrics) -> list[tuple[str, str]]:
    """Return the figures one looks for first: title and value with unit."""
    error = metrics.error_m
    return [
        ("distance driven", _in_tile(metrics.length_m, " m")),
        ("duration", _in_tile(metrics.duration_s, " s")),
        *([] if metrics.error_estimated else [("real-time factor", number(metrics.real_time_factor, 0, "×"))]),
        (f"mean {error_name(metrics)}, tractor", number(100.0 * error.tractor[ALL].mean, 1, " cm")),
        (f"mean {error_name(metrics)}, trailer", number(100.0 * error.trailer[ALL].mean, 1, " cm")),
        ("fixes not believed", _counted({"stale": metrics.stale_fixes, "false": metrics.rejected_fixes})),
        ("solver failures", _counted({"": metrics.solver_failures})),
        (
            "commands changed by the gate",
            _counted({"limited": metrics.limited_commands, "refused": metrics.refused_commands}),
        ),
    ]


def _in_tile(value: float, unit: str) -> str:
    """Return a value with as many digits as stand in one line."""
    return number(value, 0 if value >= 1000.0 else 1, unit)


def _counted(counts: Mapping[str, int]) -> str:
    """Return counts in words, those that are not zero."""
    return ", ".join(f"{count} {name}".strip() for name, count in counts.items() if count) or "none"
