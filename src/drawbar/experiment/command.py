"""`drawbar experiment`: measure, analyse, write, and report whether the expected figures were met."""

from collections.abc import Sequence
from pathlib import Path

from distributed import Client
from rich.console import Console
from rich.text import Text

from drawbar.experiment.analysis import Analysis, failures_told, load_analysis, table_of_means
from drawbar.experiment.cluster import open_cluster
from drawbar.experiment.document import RESULTS_NAME, write_report, write_results
from drawbar.experiment.elements import Element
from drawbar.experiment.experiment import FOLDER, Experiment, find_experiments, load_experiment
from drawbar.experiment.measure import Runs, measure
from drawbar.experiment.measured import REPORT_NAME, ByCase, Figures, MeasuredExperiment, NotDrivenError
from drawbar.experiment.progress import RunsProgress
from drawbar.experiment.writing import writing


def run_experiments(
    console: Console,
    name: str,
    *,
    seeds: int | None,
    jobs: int | None,
    address: str,
    only: Sequence[str] = (),
    out: Path | None = None,
) -> bool:
    """Run the experiment of this name, or `all`, and return whether everything came out as expected.

    Args:
        console: to report to.
        name: of the experiment, its folder, or `all`.
        seeds: runs of each case; None: as the experiment declares.
        jobs: processes on this machine; None: one per core.
        address: of a running Dask scheduler; empty: a cluster of this machine's own.
        only: cases whose names hold one of these texts; none: all.
        out: folder for a folder of results of each experiment; None: into the experiments' own folders.

    Raises:
        DrawbarError: no such experiment, no such case, an impossible configuration, no cluster.
    """
    experiments = [load_experiment(folder).with_cases(only) for folder in find_experiments(name)]
    with open_cluster(address, jobs) as client:
        outcomes = [_conduct(console, client, experiment, seeds, out) for experiment in experiments]
    if not out and any(experiment.folder.parent == FOLDER for experiment in experiments):
        write_report(FOLDER)
        console.print(f"{FOLDER / REPORT_NAME}")
    return not any(measured.misses() for measured in outcomes)


def _conduct(
    console: Console, client: Client, experiment: Experiment, seeds: int | None, out: Path | None
) -> MeasuredExperiment:
    """Run one experiment, write its results, and print what was missed."""
    folder = out / experiment.folder.name if out else experiment.folder
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
    analysis = load_analysis(experiment.folder)
    counts = {case: len(tasks) for case, tasks in experiment.tasks(seeds).items()}
    for case, reason in experiment.left_out.items():
        console.print(f"{experiment.folder.name}: {case} is left out: {reason}", soft_wrap=True)
    with RunsProgress(console, experiment.folder.name) as progress:
        runs = measure(client, experiment, seeds, progress)
    figures = ByCase[Sequence[Figures]]()
    for case, each in runs.items():
        with failures_told(experiment.folder, repr(case)):
            figures[case] = _figures(analysis, each, counts[case])
    seeds_driven = max(counts.values(), default=0)
    measured = MeasuredExperiment(experiment=experiment, seeds=seeds_driven, runs=ByCase(runs), figures=figures)
    if not runs:  # the results in the folder stay
        return measured
    with failures_told(experiment.folder):  # pictures are drawn as they are written
        write_results(measured, _tables(console, analysis, measured), folder)
    _print_outcome(console, measured, folder / RESULTS_NAME)
    return measured


def _tables(console: Console, analysis: Analysis, measured: MeasuredExperiment) -> list[Element]:
    """Return the experiment's own tables and pictures; the means where these need a case that has no result."""
    missing = [case for case, runs in measured.runs.items() if not runs.results]
    try:
        if not missing:
            return list(analysis.report(measured))
    except NotDrivenError as error:
        missing = [error.args[0]]
    name, cases = measured.experiment.folder.name, ", ".join(missing)
    console.print(f"{name}: no result of {cases}: a table of means is written in place of the experiment's own tables")
    return table_of_means(measured)


def _figures(analysis: Analysis, runs: Runs, seeds: int) -> list[Figures]:
    """Return the figures of every seed; empty where its run has no result."""
    by_seed = {result.metrics.seed: analysis.figures(result) for result in runs.results}
    return [by_seed.get(seed, {}) for seed in range(seeds)]


def _print_outcome(console: Console, measured: MeasuredExperiment, file: Path) -> None:
    misses = measured.misses()
    for miss in misses:
        console.print(Text(f"missed: {miss}", "red"))
    for each in measured.left_out_texts():
        console.print(f"{measured.experiment.folder.name}: {each}", soft_wrap=True, markup=False)
    held = [verdict.holds for verdict in measured.verdicts()]
    met = f"{sum(held)} of {len(held)} expected figures met: " if held else ""
    console.print(f"{met}{file}", soft_wrap=True)
