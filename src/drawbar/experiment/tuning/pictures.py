"""The trials of a search in pictures: against each other, and over each parameter."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drawbar.experiment.tuning.parameters import Parameter
from drawbar.experiment.tuning.study import Score, Trial
from drawbar.report import style

_COLUMNS = 3
_AXES: dict[str, tuple[str, Callable[[Score], float]]] = {
    "error": ("error, cm", lambda score: 100.0 * score.error),
    "effort": ("steering, °/s", lambda score: math.degrees(score.effort)),
}


def picture_height(parameters: Sequence[Parameter]) -> float:
    """Return the height of the picture of all parameters, inch."""
    return 0.5 + 3.4 * math.ceil(len(parameters) / _COLUMNS)


def draw_front(figure: Figure, trials: Sequence[Trial], front: Sequence[Trial], own: Trial) -> None:
    """Draw effort over error of all trials."""
    axes = figure.subplots()
    (x_title, x), (y_title, y) = _AXES["error"], _AXES["effort"]
    _scatter(axes, trials, front, own, x=lambda trial, score: x(score), y=y)
    axes.set(xlabel=x_title, ylabel=y_title)
    axes.legend()


def draw_parameters(
    figure: Figure, parameters: Sequence[Parameter], trials: Sequence[Trial], front: Sequence[Trial], own: Trial
) -> None:
    """Draw error and effort of all trials over each parameter, one above the other."""
    rows = math.ceil(len(parameters) / _COLUMNS)
    columns = min(_COLUMNS, len(parameters))
    grid = figure.subplots(2 * rows, columns, squeeze=False)
    for axes in grid.flat:
        axes.set_visible(False)
    for index, parameter in enumerate(parameters):
        row, column = divmod(index, columns)
        for offset, (title, y) in enumerate(_AXES.values()):
            axes = grid[2 * row + offset, column]
            axes.set_visible(True)
            _scatter(axes, trials, front, own, x=_value_of(parameter), y=y)
            axes.set(ylabel=title if column == 0 else "", xscale="log" if parameter.log else "linear")
        grid[2 * row + 1, column].set_xlabel(parameter.key)


def _value_of(parameter: Parameter) -> Callable[[Trial, Score], float]:
    return lambda trial, _: trial.values[parameter.key]


def _scatter(
    axes: Axes,
    trials: Sequence[Trial],
    front: Sequence[Trial],
    own: Trial,
    *,
    x: Callable[[Trial, Score], float],
    y: Callable[[Score], float],
) -> None:
    """Draw all trials that came to the end of the path, the front and the own values on top."""
    looks: tuple[tuple[str, Sequence[Trial], dict[str, Any]], ...] = (
        ("trials", trials, {"marker": "o", "s": 10, "color": style.REFERENCE, "alpha": 0.45, "linewidths": 0}),
        ("front", front, {"marker": "o", "s": 20, "color": style.TRACTOR}),
        ("own values", [own], {"marker": "D", "s": 34, "color": style.TRAILER}),
    )
    for label, shown, look in looks:
        points = [
            (x(trial, trial.outcome), y(trial.outcome))
            for trial in shown
            if isinstance(trial.outcome, Score) and not trial.outcome.unfinished > 0.0
        ]
        axes.scatter(*np.array(points).reshape(-1, 2).T, label=label, **look)
