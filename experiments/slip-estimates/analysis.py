"""How well slips and yaws are known, and how well the estimators know how well."""

import tomllib
from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drawbar.config import Configuration
from drawbar.experiment.elements import Element, Picture, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.task import Result
from drawbar.report.style import ESTIMATOR, INK, REFERENCE

SLIPS = {"longitudinal_slip": "μ", "tractor_slip": "κ", "trailer_slip": "η"}
YAWS = {"tractor": "tractor yaw", "trailer": "trailer yaw"}
SETTLED = 10.0
"""what comes before is the start, and does not count, s"""
TRUE_ETA = 1.0
"""the simulated joint's angle acts as it is"""
DASHED, DOTTED = (0, (4, 2)), (0, (1, 1))
PICTURES = {
    "paper": ("the paper's model", {"paper": "moving horizon", "paper-ekf": "extended Kalman filter"}),
    "articulated": (
        "the product's model",
        {"articulated": "moving horizon", "articulated-ekf": "extended Kalman filter"},
    ),
}


def figures(result: Result) -> dict[str, float]:
    """Return, by symbol, RMS error, mean standard deviation and the share (%) of the truth inside three of them.

    Slips as they are, yaws in degrees; NaN for a slip that the estimator's model does not have.
    """
    values: dict[str, float] = {}
    for name, symbol in SLIPS.items():
        error = result.columns[f"estimate.{name}"] - _truth(result, name)
        values |= _quality(result, symbol, error, result.columns[f"deviation.{name}"])
    for body, symbol in YAWS.items():
        turn = result.columns[f"estimate.{body}.yaw"] - result.columns[f"truth.{body}.yaw"]
        error = np.degrees(np.remainder(turn + np.pi, 2.0 * np.pi) - np.pi)
        values |= _quality(result, symbol, error, np.degrees(result.columns[f"deviation.{body}_yaw"]))
    return values


def _quality(result: Result, symbol: str, error: np.ndarray, deviation: np.ndarray) -> dict[str, float]:
    late = result.columns["measurement.time"] >= SETTLED
    error = np.where(np.isnan(deviation), np.nan, error)[late]
    inside = np.where(np.isnan(error), np.nan, np.abs(error) <= 3.0 * deviation[late])
    return {
        f"{symbol} error": float(np.sqrt(np.mean(error**2))),
        f"{symbol} deviation": float(np.mean(deviation[late])),
        f"{symbol} inside": 100.0 * float(np.mean(inside)),
    }


def _truth(result: Result, name: str) -> np.ndarray:
    if name == "trailer_slip":
        return np.full_like(result.columns["measurement.time"], TRUE_ETA)
    return result.columns[f"truth.{name}"]


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the paper's figure for both models, and the tables of slips and yaws."""
    for name, (title, cases) in PICTURES.items():
        yield Picture(
            name=f"slips-{name}",
            caption=f"Slips estimated with {title}, seed 0. Band: three standard deviations as the estimator computes "
            "them; where it fills the panel it is wider than the bounds. Dotted: truth. Dashed: bounds.",
            draw=lambda figure, cases=cases: _draw(figure, measured, cases),
            size=(9.0, 1.9 * len(_slips(measured, name)) + 0.6),
        )
    yield _slip_table(measured)
    yield _yaw_table(measured)


def _bounds(measured: MeasuredExperiment, case: str) -> dict[str, tuple[float, float]]:
    configuration = Configuration.model_validate(tomllib.loads(measured.experiment.configurations[case]))
    return configuration.estimator.bounds_by_estimate()


def _slips(measured: MeasuredExperiment, case: str) -> list[str]:
    """Return the slips that the estimator's model has."""
    return [name for name in SLIPS if name in _bounds(measured, case)]


def _slip_table(measured: MeasuredExperiment) -> Table:
    rows = []
    for case in measured.cases:
        cells = [cell for name in SLIPS for cell in _slip_cells(measured, case, name)]
        rows.append([case, measured.finished(case), *cells])
    return Table(
        name="slips",
        caption="RMS error of the slips (mean standard deviation as the estimator computes it), share of samples on a "
        "bound, and share of the truth inside three standard deviations (99.7 % would be consistent); mean over the "
        "seeds ± 95 % interval. The true η is 1.",
        header=[
            "",
            "finished",
            *(f"{symbol}{what}" for symbol in SLIPS.values() for what in (" error", " on bound", " inside")),
        ],
        rows=rows,
    )


def _slip_cells(measured: MeasuredExperiment, case: str, name: str) -> list[str]:
    if name not in _bounds(measured, case):
        return [""] * 3
    symbol = SLIPS[name]
    return [_error(measured, case, symbol, 3), _on_bound(measured, case, name), _inside(measured, case, symbol)]


def _error(measured: MeasuredExperiment, case: str, symbol: str, digits: int) -> str:
    deviation = measured.statistic(case, f"{symbol} deviation").mean
    return f"{measured.statistic(case, f'{symbol} error').text(digits)} ({deviation:.{digits}f})"


def _inside(measured: MeasuredExperiment, case: str, symbol: str) -> str:
    return f"{measured.statistic(case, f'{symbol} inside').mean:.1f} %"


def _on_bound(measured: MeasuredExperiment, case: str, name: str) -> str:
    bounds = np.array(_bounds(measured, case)[name])
    estimates = np.concatenate([result.columns[f"estimate.{name}"] for result in measured.runs[case].results])
    return f"{100.0 * np.mean(np.abs(estimates[:, None] - bounds).min(axis=1) < 1e-6):.1f} %"


def _yaw_table(measured: MeasuredExperiment) -> Table:
    rows = []
    for case in measured.cases:
        cells = [
            cell
            for symbol in YAWS.values()
            for cell in (_error(measured, case, symbol, 2), _inside(measured, case, symbol))
        ]
        rows.append([case, *cells])
    return Table(
        name="yaws",
        caption="RMS error of both yaws, ° (mean standard deviation as the estimator computes it), and share of the "
        "truth inside three of them; mean over the seeds ± 95 % interval.",
        header=["", *(f"{symbol}{what}" for symbol in YAWS.values() for what in (", °", " inside"))],
        rows=rows,
    )


def _draw(figure: Figure, measured: MeasuredExperiment, cases: dict[str, str]) -> None:
    slips = _slips(measured, next(iter(cases)))
    panels = figure.subplots(len(slips), len(cases), sharex=True, sharey="row", squeeze=False)
    for row, name in zip(panels, slips, strict=True):
        for axes, case in zip(row, cases, strict=True):
            _draw_slip(axes, measured, case, name)
        row[0].set_ylabel(SLIPS[name])
    for axes, title in zip(panels[0], cases.values(), strict=True):
        axes.set_title(title)
    for axes in panels[-1]:
        axes.set_xlabel("time, s")
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside upper right", ncols=4)


def _draw_slip(axes: Axes, measured: MeasuredExperiment, case: str, name: str) -> None:
    result, (low, high) = measured.runs[case].results[0], _bounds(measured, case)[name]
    time, estimate = result.columns["measurement.time"], result.columns[f"estimate.{name}"]
    band = 3.0 * result.columns[f"deviation.{name}"]
    axes.fill_between(time, estimate - band, estimate + band, color=ESTIMATOR, alpha=0.2, lw=0.0, label="3σ")
    axes.plot(time, estimate, color=ESTIMATOR, label="estimate")
    axes.plot(time, _truth(result, name), color=INK, ls=DOTTED, lw=1.2, label="truth")
    axes.axhline(low, color=REFERENCE, ls=DASHED, lw=0.9, label="bounds")
    axes.axhline(high, color=REFERENCE, ls=DASHED, lw=0.9)
    room = 0.08 * (high - low)
    axes.set(ylim=(low - room, high + room), xlim=(time[0], time[-1]))
