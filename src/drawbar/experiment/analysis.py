"""Analysis of an experiment: the functions of its analysis.py, or the defaults, compute and show its results."""

import runpy
import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from drawbar.errors import ConfigurationError
from drawbar.experiment.elements import Element, Table
from drawbar.experiment.measured import Figures, MeasuredExperiment, NotDrivenError
from drawbar.experiment.task import Result
from drawbar.report.metrics import ALL, Metrics

FILE_NAME = "analysis.py"


@dataclass(frozen=True, slots=True, kw_only=True)
class Analysis:
    """The two functions of an experiment's analysis.py; each has a default."""

    figures: Callable[[Result], Figures]
    """of one run"""
    report: Callable[[MeasuredExperiment], Iterable[Element]]
    """of all"""


def error_figures(metrics: Metrics) -> dict[str, float]:
    """Return mean distance from the path by class of the path, as `BODY CLASS`, cm, and of the whole run more.

    `BODY SD` is the standard deviation of the signed distance, `BODY 95 %` what 95 % of the distances are at most, and
    `BODY largest` the largest.
    """
    figures: dict[str, float] = {}
    for body, errors in (("tractor", metrics.error_m.tractor), ("trailer", metrics.error_m.trailer)):
        figures |= {f"{body} {label}": 100.0 * error.mean for label, error in errors.items()}
        whole = errors[ALL]
        figures |= {f"{body} SD": 100.0 * whole.deviation, f"{body} 95 %": 100.0 * whole.p95}
        figures[f"{body} largest"] = 100.0 * whole.max
    return figures


def table_of_distances(measured: MeasuredExperiment) -> list[Element]:
    """Return the table of means of figures that are `error_figures`."""
    caption = "Distance from the path, cm: mean ± 95 % interval over the seeds; 0.1: on curves of that curvature, 1/m."
    return table_of_means(measured, caption)


def table_of_means(
    measured: MeasuredExperiment, caption: str = "Mean ± 95 % interval over the seeds."
) -> list[Element]:
    """Return one table: every figure of every case, mean ± 95 % interval over the seeds."""
    names = measured.figure_names
    rows = [
        [case, measured.finished(case), *(measured.statistic(case, name).text() for name in names)]
        for case in measured.cases
    ]
    return [Table(name="means", caption=caption, header=["case", "finished", *names], rows=rows)]


def load_analysis(folder: Path) -> Analysis:
    """Return the functions `figures` and `report` of the folder's analysis.py, or the defaults.

    Raises ConfigurationError when analysis.py has neither, or fails.
    """
    file = folder / FILE_NAME
    if not file.is_file():
        return Analysis(figures=_figures, report=table_of_distances)
    with failures_told(folder):
        names = runpy.run_path(str(file))
    if not {"figures", "report"} & names.keys():
        raise ConfigurationError(f"{file}: has neither a function figures(result) nor report(measured); add one.")
    means = table_of_means if "figures" in names else table_of_distances
    return Analysis(figures=names.get("figures", _figures), report=names.get("report", means))


@contextmanager
def failures_told(folder: Path, of: str = "") -> Iterator[None]:
    """As a context: raise what an experiment's own analysis.py raises as a ConfigurationError with its line.

    Args:
        folder: of the experiment.
        of: what was analysed.
    """
    file = str(folder / FILE_NAME)
    try:
        yield
    except NotDrivenError:
        raise
    except Exception as error:
        lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == file]
        if isinstance(error, SyntaxError) and error.filename == file:
            lines.append(error.lineno)
        if not lines:  # it is not the analysis that fails
            raise
        said = f"{type(error).__name__}: {error}{of and f', of {of}'}"
        raise ConfigurationError(f"{file}:{lines[-1]}: {said}; mend the analysis there.") from error


def _figures(result: Result) -> Figures:
    return error_figures(result.metrics)
