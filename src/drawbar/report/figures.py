"""The pictures of a run along its arc length, and of its solve times: plotly figures as data."""

import math
from typing import Any

import numpy as np

from drawbar.geometry import Floats
from drawbar.recording.log import Columns
from drawbar.report import style
from drawbar.report.columns import actual_steering, along, span_along
from drawbar.report.decimation import extremes
from drawbar.report.path_errors import Bodies, PathErrors
from drawbar.report.shades import class_shades
from drawbar.report.shadow import ComparedSteering
from drawbar.report.style import Figure, axis, layout, line
from drawbar.signals import FixStatus

_NAMES = {"tractor": "Tractor", "trailer": "Trailer"}
_SOLVERS = {"estimator": style.ESTIMATOR, "tractor": style.TRACTOR, "trailer": style.TRAILER}
_BINS_PER_DECADE = 30


def _along_figure(log: Columns, traces: list[dict[str, Any]], title: str, **y_options: Any) -> Figure:
    span = list(span_along(log))
    hover = {"text": "<b>%{x:.1f} m</b>"}
    x = axis("Along the path, m", range=span, unifiedhovertitle=hover, zeroline=False)
    shades = class_shades(log.header.path)
    return {"data": traces, "layout": layout(x, axis(title, **y_options), hovermode="x unified", **shades)}


def _of_step(
    log: Columns, body: str, values: Floats, name: str, colour: str, unit: str, **options: Any
) -> dict[str, Any]:
    """Return a line over the steps of a run; `meta` makes the page add times and to follow on the map."""
    hover = "%{y:.2f}" + unit + ", at %{customdata:.1f} s"
    shown = extremes(values)
    if len(shown) < len(values):  # else the page has the times
        options["customdata"] = log.column("measurement.time")[shown].round(3)
    return line(along(log, body)[shown], values[shown], name, colour, meta="steps", hovertemplate=hover, **options)


def _bound_lines(
    log: Columns, name: str, bounds: tuple[float, float], colour: str = style.REFERENCE
) -> list[dict[str, Any]]:
    """Return two dashed lines over the whole run with one entry in the legend."""
    ends = np.array(span_along(log))
    look: dict[str, Any] = {"dash": "dash", "width": 1.0, "hoverinfo": "skip", "legendgroup": name, "meta": "whole"}
    return [line(ends, np.full(2, b), name, colour, showlegend=b == bounds[0], **look) for b in bounds]


def _span_of(traces: list[dict[str, Any]]) -> list[float] | None:
    """Return a range that shows all values of the traces with some room, None when there are none."""
    values = np.concatenate([trace["y"] for trace in traces]) if traces else np.empty(0)
    values = values[~np.isnan(values)]
    if not values.size:
        return None
    room = max(0.12 * float(np.ptp(values)), 1e-3)
    return [float(values.min()) - room, float(values.max()) + room]


def error_figure(log: Columns, errors: Bodies[PathErrors]) -> Figure:
    """Draw the lateral errors of both bodies along the path: the truth, and the estimate."""
    traces = []
    for body, colour in style.BODY_COLOURS.items():
        believed = log.column(f"reference.{body}.lateral_error") * 100
        true = getattr(errors, body).error * 100
        known = not np.isnan(true).all()
        if known:
            traces.append(_of_step(log, body, true, _NAMES[body], colour, " cm"))
        shown = {"visible": "legendonly" if known else True, "dash": "dot", "width": 1.2}
        name = f"{_NAMES[body]}, estimated"
        traces.append(_of_step(log, body, believed, name, colour, " cm", **shown))
    return _along_figure(log, traces + _masked_fixes(log), "Left of the path, cm")


def heading_figure(log: Columns) -> Figure:
    """Draw the yaw of both bodies against that of the path beside them, degrees."""
    source = "truth" if log.has_truth else "estimate"
    traces = []
    for body, colour in style.BODY_COLOURS.items():
        turned = log.column(f"{source}.{body}.yaw") - log.column(f"reference.{body}.closest.2")
        error = np.degrees(np.remainder(turned + np.pi, 2.0 * np.pi) - np.pi)
        traces.append(_of_step(log, body, error, _NAMES[body], colour, "°"))
    return _along_figure(log, traces, "Left of the path's direction, °")


def speed_figure(log: Columns) -> Figure:
    """Draw the wheel speed as commanded, measured and estimated, m/s."""
    looks = {
        "measurement.speed": ("Measured", style.MEASURED, 1.0),
        "estimate.speed": ("Estimated", style.ESTIMATOR, 1.6),
        "command.speed": ("Commanded", style.INK, 1.2),
    }
    return _along_figure(log, _compared(log, looks, 1.0, " m/s"), "Speed, m/s")


def hitch_figure(log: Columns) -> Figure:
    """Draw the hitch angle as measured and estimated, degrees."""
    looks = {
        "measurement.hitch_angle": ("Measured", style.MEASURED, 1.0),
        "estimate.hitch_angle": ("Estimated", style.ESTIMATOR, 1.6),
    }
    return _along_figure(log, _compared(log, looks, math.degrees(1.0), "°"), "Hitch angle, °")


def _compared(log: Columns, looks: dict[str, tuple[str, str, float]], scale: float, unit: str) -> list[dict[str, Any]]:
    """Return a line for each column by name, colour and width, times a scale."""
    return [
        _of_step(log, "tractor", scale * log.column(column), name, colour, unit, width=width)
        for column, (name, colour, width) in looks.items()
    ]


def _masked_fixes(log: Columns) -> list[dict[str, Any]]:
    """Return crosses on the path where an antenna had a fix that the estimator rejected."""
    traces = []
    for body, colour in style.BODY_COLOURS.items():
        masked = log.column(f"estimate.{body}_fix") >= FixStatus.STALE
        if masked.any():
            name = f"{_NAMES[body]}, fix not believed"
            place, cross = along(log, body)[masked], {"symbol": "x-thin-open", "size": 6}
            traces.append(
                line(place, np.zeros(len(place)), name, colour, mode="markers", marker=cross, hoverinfo="skip")
            )
    return traces


def steering_figure(log: Columns, body: str) -> Figure:
    """Draw the commanded and the actual steering of one body with its limits, degrees."""
    limit = math.degrees(getattr(log.header.vehicle, f"{body}_steering_limit"))
    actual = np.degrees(actual_steering(log, body))
    command = np.degrees(log.column(f"{body}_steering.command"))
    colour = style.BODY_COLOURS[body]
    traces = [
        _of_step(log, body, command, "Commanded", style.INK, "°", width=1.0),
        _of_step(log, body, actual, "Actual", colour, "°", width=2.0),
        *_bound_lines(log, "Limit", (-limit, limit)),
    ]
    return _along_figure(log, traces, "Steering, ° (left positive)", range=[-1.12 * limit, 1.12 * limit])


def compared_figure(log: Columns, body: str, steering: ComparedSteering) -> Figure:
    """Draw the steering of one body as the driver steered it and as drawbar would have, degrees."""
    driver = "Driver, measured" if steering.is_measured else "Driver, estimated"
    traces = [
        _of_step(log, body, np.degrees(steering.driven), driver, style.BODY_COLOURS[body], "°", width=2.0),
        _of_step(log, body, np.degrees(steering.command), "drawbar's command", style.INK, "°", width=1.0),
    ]
    return _along_figure(log, traces, "Steering, ° (left positive)")


def estimate_figure(log: Columns, names: dict[str, tuple[str, str]], title: str, unit: str, scale: float) -> Figure:
    """Draw estimated parameters with bounds and, where it is known, truth.

    names: by field name of Estimate the symbol and the colour; values are multiplied by scale. A parameter
    without bounds is one that the estimator's model does not have: it is left out.
    """
    curves, bounds = [], []
    for field, (symbol, colour) in names.items():
        if field not in log.header.estimate_bounds:
            continue
        low, high = log.header.estimate_bounds[field]
        estimate = log.column(f"estimate.{field}") * scale
        curves.append(_of_step(log, "tractor", estimate, symbol, colour, unit, width=2.0))
        if log.has_truth and field != "trailer_slip":  # the simulated machine has no such slip
            true = log.column(f"truth.{field}") * scale
            curves.append(_of_step(log, "tractor", true, f"{symbol}, true", colour, unit, width=1.0, dash="dot"))
        bounds += _bound_lines(log, f"{symbol}, bounds", (low * scale, high * scale), colour)
    return _along_figure(log, curves + bounds, title, range=_span_of(curves))


def ancillary_figure(log: Columns) -> Figure:
    """Draw the ancillary term of both bodies, degrees."""
    traces = []
    for body, colour in style.BODY_COLOURS.items():
        term = np.degrees(log.column(f"{body}_steering.ancillary"))
        traces.append(_of_step(log, body, term, _NAMES[body], colour, "°", width=1.2))
    return _along_figure(log, traces, "Ancillary steering, °")


def margin_figure(log: Columns) -> Figure:
    """Draw the margins of both bodies' tubes, %; a body without a tube is left out."""
    traces = []
    for body, colour in style.BODY_COLOURS.items():
        margin = 100.0 * log.column(f"{body}_steering.margin")
        if not np.isnan(margin).all():
            traces.append(_of_step(log, body, margin, _NAMES[body], colour, " %", width=1.2))
    span = _span_of(traces)
    return _along_figure(log, traces, "Margin, %", range=span and [min(span[0], 0.0), 105.0])


def _histogram(time: Floats, powers: Floats) -> tuple[Floats, Floats]:
    """Return the outline of a histogram between equally spaced powers of ten: its edges, the share of steps in %."""
    counts, _ = np.histogram(np.log10(time[time > 0.0]), len(powers) - 1, (powers[0], powers[-1]))
    share = 100.0 * counts / max(len(time), 1)
    return np.repeat(10.0**powers, 2), np.concatenate([[0.0], np.repeat(share, 2), [0.0]])


def solve_time_figure(log: Columns) -> Figure:
    """Draw how long the two phases of the solvers that there are took, µs, on a logarithmic axis."""
    columns = {
        (solver, phase): log.column(f"{solver}_times.{phase}") * 1e6
        for solver in _SOLVERS
        for phase in ("prepare", "feedback")
    }
    times = {name: time for name, time in columns.items() if not np.isnan(time).any()}
    least = min((time.min(initial=np.inf, where=time > 0.0) for time in times.values()), default=np.inf)
    most = max((time.max(initial=0.0) for time in times.values()), default=0.0)
    low, high = (np.log10(least), np.log10(most)) if most > 0.0 else (0.0, 1.0)
    powers = np.arange(low - 0.1, high + 0.1, 1.0 / _BINS_PER_DECADE)
    traces = []
    for (solver, phase), time in times.items():
        x, y = _histogram(time, powers)
        dash = "solid" if phase == "prepare" else "dot"
        name = f"{solver.capitalize()}, {phase}"
        hover = "%{y:.1f} % of steps near %{x:.2f} µs"
        traces.append(line(x, y, name, _SOLVERS[solver], dash=dash, width=1.8, hovertemplate=hover, fill="tozeroy"))
        traces[-1]["fillcolor"] = _SOLVERS[solver] + "1A"
    digits = (1, 2, 5) if high - low < 3.0 else (1,)  # plotly's own second and fifth label of a decade have no zeros
    ticks = [digit * 10.0**power for power in range(-3, 8) for digit in digits]
    x_axis = axis("Time of one call, µs", type="log", tickvals=ticks, tickformat="~g")
    return {"data": traces, "layout": layout(x_axis, axis("Share of steps, %", rangemode="tozero"))}
