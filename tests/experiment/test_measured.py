"""From runs to a report: measured on a cluster, judged by what was expected, written as files."""

import dataclasses
import math
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from distributed import Client

from drawbar.errors import ConfigurationError, StorageError
from drawbar.experiment.analysis import error_figures, load_analysis, table_of_means
from drawbar.experiment.document import write_report, write_results
from drawbar.experiment.elements import Text
from drawbar.experiment.experiment import Experiment
from drawbar.experiment.measure import Runs, measure
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.progress import RunsProgress
from drawbar.experiment.task import Result, run_task

Write = Callable[[str], Experiment]


def files(experiment: Experiment) -> dict[Path, int]:
    return {file: os.stat(file).st_mtime_ns for file in experiment.folder.glob(".runs/*/*.msgpack")}


def measured_of(experiment: Experiment, runs: dict[str, Runs], seeds: int = 3) -> MeasuredExperiment:
    figures = {case: [error_figures(result.metrics) for result in each.results] for case, each in runs.items()}
    return MeasuredExperiment(experiment=experiment, seeds=seeds, runs=runs, figures=figures)


def test_results_are_those_of_the_same_tasks_here_and_never_measured_twice(
    cluster: Client, write_experiment: Write, two_cases: str, progress: RunsProgress
) -> None:
    experiment = write_experiment(two_cases)
    runs = measure(cluster, experiment, 2, progress)
    for case, tasks in experiment.tasks(2).items():
        assert [result.metrics.seed for result in runs[case].results] == [0, 1]
        here = run_task(tasks[1])
        assert runs[case].results[1].metrics.error_m == here.metrics.error_m
        assert (runs[case].results[1].columns["error.tractor"] == here.columns["error.tractor"]).all()
    kept = files(experiment)
    assert len(kept) == 4
    again = measure(cluster, experiment, 3, progress)
    assert [len(each.results) for each in again.values()] == [3, 3]
    assert kept.items() <= files(experiment).items()
    assert len(files(experiment)) == 6


def test_a_run_without_a_result_is_reported_and_tried_again(
    cluster: Client, write_experiment: Write, two_cases: str, progress: RunsProgress
) -> None:
    experiment = write_experiment(two_cases + 'expected.slow."trailer all" = { at_most = 5.0 }')
    wrong = experiment.settings.model_copy(update={"columns": ("error.plough",)})  # that no file can say
    experiment = dataclasses.replace(experiment, settings=wrong)
    runs = measure(cluster, experiment, 2, progress)
    assert all(not each.results for each in runs.values())
    assert files(experiment) == {}
    misses = measured_of(experiment, runs, 2).misses()
    assert len(misses) == 3
    assert misses[0].startswith("articulated: seed 0, 1: AttributeError: "), "once for all seeds"
    assert misses[2] == "slow: trailer all is –, expected ≤ 5"


def test_workers_with_other_code_are_refused(
    cluster: Client,
    write_experiment: Write,
    two_cases: str,
    progress: RunsProgress,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("drawbar.experiment.measure.source_digest", lambda: "another")
    runs = measure(cluster, write_experiment(two_cases), 1, progress)
    assert "another version of drawbar's code" in runs["slow"].failures[0]


@pytest.fixture
def measured(write_experiment: Write, two_cases: str, short_result) -> MeasuredExperiment:
    expected = 'expected.slow = { "tractor all" = { at_most = 99.0 }, "trailer all" = { at_most = 0.001 } }'
    runs = {case: Runs(results=[short_result], failures=[]) for case in ("articulated", "slow")}
    return measured_of(write_experiment(two_cases + expected), runs, seeds=1)


def test_a_figure_beyond_what_is_expected_is_a_miss(measured: MeasuredExperiment) -> None:
    assert [verdict.holds for verdict in measured.verdicts()] == [True, False]
    (miss,) = measured.misses()
    assert miss.startswith("slow: trailer all is ")
    assert miss.endswith("expected ≤ 0.001")


def test_a_misspelt_figure_is_reported_as_such(write_experiment: Write, two_cases: str, short_result) -> None:
    runs = {case: Runs(results=[short_result], failures=[]) for case in ("articulated", "slow")}
    experiment = write_experiment(two_cases + 'expected.slow."trailer al" = { at_most = 5.0 }')
    (miss,) = measured_of(experiment, runs, 1).misses()
    assert miss == "slow: trailer al is –, expected ≤ 5; no run has this figure (did you mean trailer all?)"


def test_results_point_to_what_is_compared_where_that_is_written(measured: MeasuredExperiment) -> None:
    folder = measured.experiment.folder
    write_results(measured, [])
    assert "Made by `drawbar experiment small`.\n" in (folder / "results.md").read_text("utf-8")
    (folder / "README.md").write_text("", "utf-8")
    write_results(measured, [])
    assert "`drawbar experiment small`; [README.md](README.md) says" in (folder / "results.md").read_text("utf-8")


def test_an_expected_case_must_come_to_the_end(measured: MeasuredExperiment, short_result) -> None:
    lost = dataclasses.replace(
        short_result, metrics=dataclasses.replace(short_result.metrics, finished=False, outcome="lost")
    )
    runs = {"articulated": Runs(results=[lost], failures=[]), "slow": Runs(results=[lost], failures=[])}
    measured = dataclasses.replace(measured, runs=runs)
    assert measured.misses()[0] == "slow, seed 1: lost"
    assert measured.finished("articulated") == "0/1"
    write_results(measured, [])
    write_report(measured.experiment.folder.parent)
    report = (measured.experiment.folder.parent / "REPORT.md").read_text("utf-8")
    assert (
        "- **Missed**: 1 of 2 expected figures of *Two controllers*, and 1 of its runs did not come to the end."
        in report
    )


def test_means_tell_how_many_runs_came_to_the_end_where_not_all_did(measured: MeasuredExperiment) -> None:
    figures = ("tractor all", "trailer all")
    text = " / ".join(f"{measured.statistic('slow', figure).mean:.1f}" for figure in figures)
    assert measured.means("slow", figures) == text
    assert measured.means("fast", figures) == ""
    assert dataclasses.replace(measured, seeds=2).means("slow", figures) == f"{text} (1/1)"


def test_statistics_and_names_of_figures(measured: MeasuredExperiment, short_result) -> None:
    mean = 100.0 * short_result.metrics.error_m.trailer["all"].mean
    assert measured.statistic("slow", "trailer all").mean == pytest.approx(mean)
    assert measured.figure_names[:3] == ["tractor straight", "tractor 0.2", "tractor all"]
    assert measured.statistic("slow", "no such figure").text() == "–"
    assert measured.finished("slow") == "1/1"


def test_a_seed_without_a_result_leaves_the_others_in_their_place(measured: MeasuredExperiment) -> None:
    figures = {"slow": [{"x": 1.0}, {}, {"x": 3.0}]}
    with_gap = dataclasses.replace(measured, seeds=3, figures=figures)
    first, gap, last = with_gap.values("slow", "x")
    assert (first, last) == (1.0, 3.0)
    assert math.isnan(gap)
    assert with_gap.statistic("slow", "x").text() == "–"


def test_results_and_report_say_what_was_missed(measured: MeasuredExperiment) -> None:
    elements = [*table_of_means(measured), Text(text="In words.")]
    write_results(measured, elements)
    results = (measured.experiment.folder / "results.md").read_text("utf-8")
    assert results.startswith("# Two controllers\n")
    assert "2 cases with the seeds 0 to 0: 2 runs, 0 of them given up" in results
    assert "| **missed** |" in results
    assert "([CSV](means.csv))" in results
    folder = measured.experiment.folder
    write_report(folder.parent)
    report = (folder.parent / "REPORT.md").read_text("utf-8")
    named = f"[Two controllers]({folder.name}/results.md) | [what is compared]({folder.name}/README.md)"
    assert f"| {named} | 2 | 1 | 2 | **1** |" in report
    assert "- **Missed**: 1 of 2 expected figures of *Two controllers*. The reason is not known." in report
    assert ", casadi " in report


def test_the_report_shows_the_cases_of_two_experiments_side_by_side(measured: MeasuredExperiment) -> None:
    folder = measured.experiment.folder
    settings = measured.experiment.settings.model_copy(update={"side_by_side": ("tractor all", "trailer all")})
    both = dataclasses.replace(measured, experiment=dataclasses.replace(measured.experiment, settings=settings))
    write_results(both, [])
    write_report(folder.parent)
    report = folder.parent / "REPORT.md"
    assert "side by side" not in report.read_text("utf-8"), "there is only one"
    other = folder.parent / "other"
    other.mkdir()
    shutil.copy(folder / "summary.json", other)
    write_report(folder.parent)
    means = " / ".join(measured.statistic("slow", figure).text() for figure in settings.side_by_side)
    text = report.read_text("utf-8")
    assert "tractor all / trailer all, mean over the seeds" in text
    assert f"| slow | {means} | {means} |" in text


def test_a_figure_to_be_shown_side_by_side_that_no_run_has_is_refused(measured: MeasuredExperiment) -> None:
    settings = measured.experiment.settings.model_copy(update={"side_by_side": ("tractor al",)})
    wrong = dataclasses.replace(measured, experiment=dataclasses.replace(measured.experiment, settings=settings))
    with pytest.raises(ConfigurationError, match=r"no figure 'tractor al' of a case .*figures: tractor straight"):
        write_results(wrong, [])


@pytest.mark.parametrize(
    "content", [b"", b'{"title": "x"', b'{"title": "x"}', b"[]"], ids=["empty", "cut", "old", "other"]
)
def test_a_summary_that_cannot_be_read_is_named(measured: MeasuredExperiment, content: bytes) -> None:
    folder = measured.experiment.folder
    write_results(measured, [])
    (folder / "summary.json").write_bytes(content)
    with pytest.raises(StorageError, match=rf"summary\.json: cannot be read .* drawbar experiment .*{folder.name}"):
        write_report(folder.parent)


def test_the_report_opens_with_what_was_learned_and_why_figures_were_missed(measured: MeasuredExperiment) -> None:
    experiment = measured.experiment
    told = {"learned": "It errs by {slow|trailer all} cm.", "why_missed": "Too slow."}
    settings = experiment.settings.model_copy(update=told)
    measured = dataclasses.replace(measured, experiment=dataclasses.replace(experiment, settings=settings))
    write_results(measured, [])
    write_report(experiment.folder.parent)
    opening = (experiment.folder.parent / "REPORT.md").read_text("utf-8").partition("## All experiments")[0]
    assert f"- It errs by {measured.statistic('slow', 'trailer all').text(2)} cm.\n" in opening
    assert "expected figures of *Two controllers*. Too slow." in opening


def test_what_was_learned_names_figures_that_there_are(measured: MeasuredExperiment) -> None:
    with pytest.raises(ConfigurationError, match="no figure 'trailer al' of a case 'slow'; figures: "):
        measured.filled_in("{slow|trailer al}")


@pytest.mark.parametrize("results", [None, []], ids=["not chosen", "failed"])
def test_what_was_learned_of_a_case_without_a_result_is_left_out_and_that_is_reported(
    write_experiment: Write, two_cases: str, short_result, results: list[Result] | None
) -> None:
    learned = 'learned = "It errs by {slow|trailer all} cm."\nwhy_missed = "Too slow."\n'
    runs = {"articulated": Runs(results=[short_result], failures=[])}
    if results is not None:
        runs["slow"] = Runs(results=results, failures=["seed 0: broken"])
    experiment = write_experiment(learned + two_cases).with_cases(list(runs))
    measured = measured_of(experiment, runs, 1)
    left_out = "`learned` is left out of REPORT.md: no result of slow"
    assert measured.left_out_texts() == [left_out]
    write_results(measured, table_of_means(measured))
    text = (experiment.folder / "results.md").read_text("utf-8")
    assert f"{left_out}.\n" in text
    assert "| articulated | 1/1 |" in text
    write_report(experiment.folder.parent)
    assert "It errs by" not in (experiment.folder.parent / "REPORT.md").read_text("utf-8")


def test_a_case_that_is_left_out_is_reported_and_missed_by_nobody(write_experiment: Write, short_result) -> None:
    text = 'title = "x"\nexpected.a.x = { at_most = 1.0 }\ncases = [{ name = "paper" }, '
    experiment = write_experiment(text + '{ name = "a", configuration = "paper", needs = "no such folder" }]')
    measured = measured_of(experiment, {"paper": Runs(results=[short_result], failures=[])}, 1)
    assert measured.verdicts() == []
    assert measured.misses() == []
    write_results(measured, [])
    results = (experiment.folder / "results.md").read_text("utf-8")
    assert "Not driven: a (no such folder is not here)." in results


def test_own_functions_take_the_place_of_the_defaults(measured: MeasuredExperiment, short_result) -> None:
    folder = measured.experiment.folder
    assert load_analysis(folder).figures(short_result) == error_figures(short_result.metrics)
    (means,) = load_analysis(folder).report(measured)
    assert ", cm: " in means.markdown(), "a table of lengths has a unit"
    (folder / "analysis.py").write_text("LIMIT = 3.0\ndef figures(result):\n    return {'limit': LIMIT}\n", "utf-8")
    analysis = load_analysis(folder)
    assert analysis.figures(short_result) == {"limit": 3.0}
    assert analysis.report is table_of_means
    (folder / "analysis.py").write_text("LIMIT = 3.0\n", "utf-8")
    with pytest.raises(ConfigurationError, match="neither a function figures"):
        load_analysis(folder)
