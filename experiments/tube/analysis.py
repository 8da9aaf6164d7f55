"""Whether the vehicle stays in its tubes and within its bounds, from the true state of every sample."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drawbar.config import Configuration, load_configuration
from drawbar.experiment.elements import Element, Picture, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.task import Result
from drawbar.geometry import Floats
from drawbar.report.style import BODY_COLOURS, REFERENCE
from drawbar.step.build import build_tubes
from drawbar.vehicle.parameters import VehicleParameters

FOLDER = Path(__file__).parent
BODIES = tuple(BODY_COLOURS)
STATES = {"tractor": 3, "trailer": 2}
DIRECTIONS = 400
"""in which every error is compared with the tube's support, besides its facets"""
ROUNDING = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """One body of one run, n steps."""

    error: Floats
    """x - x̄, (n, states)"""
    deviation: Floats
    """x̂ - x̄, (n, states)"""
    asked: Floats
    """ū + K (x̂ - x̄) before the clip, (n,) rad"""
    steering: Floats
    """true, (n,) rad"""
    margin: Floats
    """(n,)"""


@cache
def configuration(name: str) -> Configuration:
    """Return the configuration of this name, beside this file."""
    return load_configuration(str(FOLDER / f"{name}.toml"))


@cache
def tube(name: str, body: str) -> tuple[Floats, Floats]:
    """Return directions (m, states) and how far x - x̄ may be in them (m,), of a configuration's body."""
    tubes = build_tubes(configuration(name))
    assert tubes is not None
    one = getattr(tubes, body)
    extent = one.support(np.eye(STATES[body]))
    drawn = np.random.default_rng(0).normal(size=(DIRECTIONS, STATES[body])) / extent
    directions = np.vstack([one.facets, drawn])
    return directions, one.support(directions)


def body_of(result: Result, body: str) -> Body:
    """Return what a run says of a body."""
    columns = result.columns
    deviation = np.stack([columns[f"plan.{body}.deviation.{i}"] for i in range(STATES[body])], axis=1)
    return Body(
        error=deviation - estimate_error(result, body),
        deviation=deviation,
        asked=columns[f"{body}_steering.nominal"] + columns[f"{body}_steering.ancillary"],
        steering=columns[f"truth.{body}_steering"],
        margin=columns[f"{body}_steering.margin"],
    )


def estimate_error(result: Result, body: str) -> Floats:
    """Return x̂ - x (n, states) in the coordinates of a body's tube."""

    def of(name: str) -> Floats:
        return result.columns[f"estimate.{name}"] - result.columns[f"truth.{name}"]

    yaw, steering = of("tractor.yaw"), of(f"{body}_steering")
    if body == "trailer":
        return np.stack([yaw - of("trailer.yaw"), steering], axis=1)
    heading = result.columns["truth.tractor.yaw"]
    lateral = np.cos(heading) * of("tractor.y") - np.sin(heading) * of("tractor.x")
    return np.stack([lateral, yaw, steering], axis=1)


def over(run: Body, body: str, vehicle: VehicleParameters) -> dict[str, Floats]:
    """Return which samples (n,) exceed an original bound: command, true angle, the rate that a cylinder needs."""
    limit, rate = (getattr(vehicle, f"{body}_steering_{name}") for name in ("limit", "rate"))
    needed = np.abs(np.clip(run.asked, -limit, limit) - run.steering) / vehicle.steering_lag
    return {
        "command": np.abs(run.asked) > limit + ROUNDING,
        "angle": np.abs(run.steering) > limit + ROUNDING,
        "rate": needed > rate + ROUNDING,
    }


def figures(result: Result) -> dict[str, float]:
    """Return the figures of one run; shares in % of the samples, of both bodies together."""
    name = result.metrics.config
    inside, exceeded, violated, left, margins = [], {}, [], [], []
    for body in BODIES:
        run, (directions, extent) = body_of(result, body), tube(name, body)
        inside.append((run.error @ directions.T <= extent + ROUNDING).all(axis=1))
        samples = over(run, body, configuration(name).vehicle)
        for bound, where in samples.items():
            exceeded[f"{body} {bound}"] = 100.0 * float(where.mean())
        violated.append(np.any(list(samples.values()), axis=0))
        left.append(np.logical_or.accumulate(run.margin < 0.0))
        margins.append(run.margin.min())
    return {
        "inside": 100.0 * float(np.mean(inside)),
        "over": 100.0 * float(np.mean(violated)),
        "margin": float(min(margins)),
        "unforeseen": float(np.any([v & ~seen for v, seen in zip(violated, left, strict=True)])),
        **exceeded,
    }


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the table, then a run at its bounds with and without tightening."""
    yield _table(measured)
    yield Picture(
        name="commands",
        caption="What both bodies are asked for, seed 0, adversarial errors within their bounds: nominal steering "
        "(thin, grey) and with the ancillary law (thick); the bounds of the nominal problem tightened and not. "
        "Dashed: the bounds of the machine; dotted: what the tube leaves of them.",
        draw=lambda figure: _draw_commands(figure, measured),
        size=(9.0, 5.0),
    )
    yield Picture(
        name="margins",
        caption="Least margin of each run: 1 at the centre of a tube, 0 on its boundary, negative outside.",
        draw=lambda figure: _draw_margins(figure, measured),
        size=(9.0, 0.26 * len(measured.cases) + 1.0),
    )


def _table(measured: MeasuredExperiment) -> Table:
    rows = []
    for case in measured.cases:
        values = {name: measured.values(case, name) for name in measured.figure_names}
        count = sum(len(run.columns["tractor_steering.margin"]) for run in measured.runs[case].results)
        shares = [
            f"{np.mean(values[f'tractor {name}']):.2f} / {np.mean(values[f'trailer {name}']):.2f}"
            for name in ("command", "angle", "rate")
        ]
        rows.append(
            [
                case,
                measured.finished(case),
                str(count),
                f"{np.mean(values['inside']):.2f}",
                *shares,
                f"{min(values['margin']):+.3f}",
                f"{sum(margin < 0.0 for margin in values['margin'])}/{len(values['margin'])}",
                f"{int(sum(values['unforeseen']))}",
            ]
        )
    return Table(
        name="tube",
        caption="Share of samples with the true error in the tube, %; with a bound of the machine exceeded, tractor / "
        "trailer, %; least margin; runs whose margin turned negative; runs in which a bound was exceeded before.",
        header=[
            "",
            "finished",
            "samples",
            "in the tube",
            "command",
            "angle",
            "rate",
            "least margin",
            "left the tube",
            "unforeseen",
        ],
        rows=rows,
    )


def _draw_commands(figure: Figure, measured: MeasuredExperiment) -> None:
    panels = figure.subplots(2, 2, sharex=True, sharey="row")
    for column, (case, title) in enumerate(
        (("propagated: adversarial", "tightened"), ("propagated, not tightened: adversarial", "not tightened"))
    ):
        run = measured.runs[case].results[0]
        for row, body in enumerate(BODIES):
            _draw_command(panels[row, column], run, body)
            panels[row, column].set_title(f"{body}, {title}")
    for axes in panels[:, 0]:
        axes.set_ylabel("steering, °")
    for axes in panels[1]:
        axes.set_xlabel("time, s")


def _draw_command(axes: Axes, run: Result, body: str) -> None:
    time, one = run.columns["measurement.time"], body_of(run, body)
    vehicle, tubes = configuration(run.metrics.config).vehicle, build_tubes(configuration(run.metrics.config))
    assert tubes is not None
    limit, left = getattr(vehicle, f"{body}_steering_limit"), getattr(tubes, body).bounds["command"].tightened
    axes.plot(time, np.degrees(one.asked), color=BODY_COLOURS[body], linewidth=1.6)
    axes.plot(time, np.degrees(run.columns[f"{body}_steering.nominal"]), color=REFERENCE, linewidth=0.9)
    for bound, dash in ((limit, "dashed"), (left, "dotted")):
        for side in (-bound, bound):
            axes.axhline(np.degrees(side), color=REFERENCE, linestyle=dash, linewidth=0.9)


def _draw_margins(figure: Figure, measured: MeasuredExperiment) -> None:
    axes = figure.subplots()
    for place, case in enumerate(measured.cases):
        margins = measured.values(case, "margin")
        axes.plot(margins, np.full(len(margins), place), "o", markersize=3.5, alpha=0.6, color=BODY_COLOURS["tractor"])
    axes.axvline(0.0, color=REFERENCE, linewidth=1.0)
    axes.set_yticks(range(len(measured.cases)), measured.cases)
    axes.set_ylim(len(measured.cases) - 0.5, -0.5)
    axes.set_xlabel("least margin of the run")
