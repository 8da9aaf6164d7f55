"""The figures of a run as rows of text, the same for the console and the page; a missing figure is a dash."""

import math
from collections.abc import Iterator, Mapping

from drawbar.report.metrics import ALL, Metrics, PhaseTimes
from drawbar.report.path_errors import Bodies
from drawbar.report.shadow import ShadowMetrics
from drawbar.safety.causes import Cause
from drawbar.vehicle.parameters import STEERINGS

ERROR_COLUMNS = ("mean", "rms", "sd", "95 %", "max")
_STATISTICS = ("mean", "rms", "deviation", "p95", "max")
TIME_COLUMNS = ("median", "p99", "max")

Row = tuple[str, list[str]]
"""a title and its cells"""
_UNKNOWN = "–"


def number(value: float, digits: int = 1, unit: str = "") -> str:
    """Return the value with a fixed number of digits and its unit; NaN is a dash, zero has no sign."""
    return _UNKNOWN if math.isnan(value) else f"{value:z.{digits}f}{unit}"


def counted(count: int, name: str) -> str:
    """Return a count with the name of what is counted, which has its plural with an s: `1 step`, `2 steps`."""
    return f"{count} {name}" if count == 1 else f"{count} {name}s"


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
    figures: tuple[tuple[str, Bodies[float], float, int, str], ...] = (
        ("yaw error, RMS", metrics.yaw_rmse_rad, math.degrees(1.0), 2, "°"),
        ("mean steering rate", metrics.steering_rate_mean_rad_s, math.degrees(1.0), 1, "°/s"),
        ("on straights", metrics.steering_rate_straight_rad_s, math.degrees(1.0), 1, "°/s"),
        ("ancillary share", metrics.ancillary_share, 100.0, 1, " %"),
        ("clipped commands", metrics.saturated_share, 100.0, 1, " %"),
        ("steering at its limit", metrics.at_limit_share, 100.0, 1, " %"),
        ("least tube margin", metrics.tube_margin_min, 100.0, 0, " %"),
        *_shadow_figures(metrics.shadow),
    )
    rows = [
        (title, [number(scale * value, digits, unit) for value in (figure.tractor, figure.trailer)])
        for title, figure, scale, digits, unit in figures
    ]
    return _known(rows)


def _shadow_figures(shadow: ShadowMetrics | None) -> Iterator[tuple[str, Bodies[float], float, int, str]]:
    """Yield how far apart command and driver, and driver and line were: title, figure, scale, digits and unit."""
    if shadow is None:
        return
    pairs = (
        ("driver to command", shadow.difference_rad, math.degrees(1.0), "°"),
        ("driver to line", shadow.driver_error_m, 100.0, " cm"),
    )
    for title, both, scale, unit in pairs:
        yield f"{title}, mean", Bodies(tractor=both.tractor.mean, trailer=both.trailer.mean), scale, 1, unit
        yield f"{title}, max", Bodies(tractor=both.tractor.max, trailer=both.trailer.max), scale, 1, unit


def refusal_rows(shadow: ShadowMetrics) -> list[Row]:
    """Return for how long each cause stood against engaging, s, what it is, and what to do about it."""
    causes = [(Cause[name], lasted) for name, lasted in shadow.refused_s.items()]
    return [(number(lasted, 1, " s"), [cause.sentence, cause.advice]) for cause, lasted in causes]


def shadow_texts(shadow: ShadowMetrics) -> list[str]:
    """Return sentences about when a drive could have been engaged, and how its figures are to be read."""
    if not shadow.judged_s > 0.0:
        return ["it is not known whether anything stood against engaging: the controller never reported"]
    estimated = [name for body, name in STEERINGS.items() if not getattr(shadow.angle_measured, body)]
    told = [
        f"nothing stood against engaging for {number(100.0 * shadow.engageable_share, 0, ' %')} of "
        f"{number(shadow.judged_s, 0, ' s')}; actuators, wiggle test and emergency stop are not judged",
        "each command was computed where the driver had brought the vehicle, and leads the steering, which lags behind "
        "it: together they are no course that drawbar would have driven",
    ]
    if estimated:
        told.append(
            f"the driver's angle of {' and '.join(estimated)} is estimated, as none was measured: AIO v4 boards report "
            "theirs only while something commands them, AiO_26 boards and ISOBUS valves always"
        )
    return told


def key_figures(metrics: Metrics) -> list[tuple[str, str]]:
    """Return the figures one looks for first: title and value with unit."""
    limited = {"limited": metrics.limited_commands, "refused": metrics.refused_commands}
    return [
        ("distance driven", _in_tile(metrics.length_m, " m")),
        ("duration", _in_tile(metrics.duration_s, " s")),
        *([] if metrics.error_estimated else [("real-time factor", number(metrics.real_time_factor, 0, "×"))]),
        *(_key_errors(metrics) if metrics.shadow is None else _key_differences(metrics.shadow)),
        ("fixes not believed", _counted({"stale": metrics.stale_fixes, "false": metrics.rejected_fixes})),
        ("solver failures", _counted({"": metrics.solver_failures})),
        *([("commands changed by the gate", _counted(limited))] if metrics.shadow is None else []),
    ]


def _key_errors(metrics: Metrics) -> list[tuple[str, str]]:
    """Return the mean error of each body."""
    bodies = {"tractor": metrics.error_m.tractor, "trailer": metrics.error_m.trailer}
    name = f"mean {error_name(metrics)}"
    return [(f"{name}, {body}", number(100.0 * error[ALL].mean, 1, " cm")) for body, error in bodies.items()]


def _key_differences(shadow: ShadowMetrics) -> list[tuple[str, str]]:
    """Return when it could have been engaged, and the mean difference of each steering."""
    means = {body: getattr(shadow.difference_rad, body).mean for body in STEERINGS}
    return [
        ("nothing against engaging", number(100.0 * shadow.engageable_share, 0, " %")),
        *((f"mean difference, {STEERINGS[body]}", number(math.degrees(mean), 1, "°")) for body, mean in means.items()),
    ]


def _in_tile(value: float, unit: str) -> str:
    """Return a value with as many digits as stand in one line."""
    return number(value, 0 if value >= 1000.0 else 1, unit)


def _counted(counts: Mapping[str, int]) -> str:
    """Return counts in words, those that are not zero."""
    return ", ".join(f"{count} {name}".strip() for name, count in counts.items() if count) or "none"
