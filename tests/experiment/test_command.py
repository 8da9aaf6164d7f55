"""`drawbar experiment` as its user sees it: interrupted, resumed, on a cluster whose workers die."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, nullcontext
from functools import partial
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import pytest
from distributed import Client
from short_run import Drawbar

from drawbar.experiment import command
from drawbar.experiment.analysis import failures_told
from drawbar.experiment.experiment import Experiment

pytestmark = pytest.mark.skipif(os.name == "nt", reason="POSIX signals")

Write = Callable[[str], Experiment]
PROGRAM = (sys.executable, "-m", "drawbar", "experiment")


@contextmanager
def process(*command: str) -> Iterator[subprocess.Popen[str]]:
    """Start a program in a group of its own, as a shell does, that heeds interrupts; at the end no part of it lives."""
    heed = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    options: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen(command, start_new_session=True, preexec_fn=heed, **options) as started:
        try:
            yield started
        finally:
            if started.poll() is None:
                os.killpg(started.pid, signal.SIGKILL)


def wait_for(condition: Callable[[], bool], of: subprocess.Popen[str]) -> None:
    end = monotonic() + 120.0
    while not condition() and of.poll() is None and monotonic() < end:
        sleep(0.02)


def finished(experiment: Experiment) -> dict[str, int]:
    return {file.name: os.stat(file).st_mtime_ns for file in experiment.folder.glob(".runs/*/*.msgpack")}


def results(experiment: Experiment) -> str:
    return (experiment.folder / "results.md").read_text("utf-8")


@pytest.fixture
def drawbar(drawbar: Drawbar) -> Drawbar:
    """Return a function that runs an experiment: exit code, and what it said."""
    return partial(drawbar, "experiment")


@pytest.fixture
def on_cluster(cluster: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let `drawbar` use the cluster of the session instead of one of its own."""
    monkeypatch.setattr(command, "open_cluster", lambda address, jobs: nullcontext(cluster))


def test_an_interrupted_experiment_goes_on_from_its_finished_runs(
    drawbar, on_cluster: None, write_experiment: Write, two_cases: str
) -> None:
    experiment = write_experiment(two_cases)
    arguments = (str(experiment.folder), "--seeds", "8")
    with process(*PROGRAM, *arguments, "--jobs", "2") as first:
        wait_for(lambda: len(finished(experiment)) >= 3, first)
        os.killpg(first.pid, signal.SIGINT)  # as from a keyboard: to the workers too
        said = first.communicate(timeout=300)[0]
    assert first.returncode == 130
    assert "the same command continues" in said
    assert "Traceback" not in said
    before = finished(experiment)
    assert 3 <= len(before) < 16
    code, said = drawbar(*arguments)
    assert code == 0, said
    after = finished(experiment)
    assert len(after) == 16
    assert before.items() <= after.items()
    assert "16 runs, 0 of them given up" in results(experiment)


def test_a_quick_look_leaves_the_results_in_the_experiments_folder(
    drawbar, on_cluster: None, write_experiment: Write, two_cases: str, tmp_path: Path
) -> None:
    experiment = write_experiment(two_cases)
    folder = str(experiment.folder)
    assert drawbar(folder, "--seeds", "2")[0] == 0
    committed = results(experiment)
    code, said = drawbar(folder, "--seeds", "1", "--out", str(tmp_path / "look"))
    look = tmp_path / "look" / experiment.folder.name
    assert code == 0, said
    assert str(look / "results.md") in said
    assert results(experiment) == committed
    assert "2 runs, 0 of them given up" in (look / "results.md").read_text("utf-8")
    (tmp_path / "file").touch()
    code, said = drawbar(folder, "--seeds", "9", "--out", str(tmp_path / "file"))
    assert (code, len(finished(experiment))) == (2, 4), said  # refused before anything is driven
    assert "cannot be written" in said


def test_a_worker_killed_on_a_cluster_loses_nothing(write_experiment: Write, two_cases: str, tmp_path: Path) -> None:
    experiment = write_experiment(two_cases + 'expected.slow."trailer all" = { at_most = 0.001 }')
    file = tmp_path / "scheduler.json"
    with ExitStack() as stack:
        dask = (sys.executable, "-m", "distributed.cli.dask_scheduler")
        scheduler = stack.enter_context(process(*dask, "--port", "0", "--no-dashboard", "--scheduler-file", str(file)))
        wait_for(lambda: file.exists() and file.read_text().endswith("}"), scheduler)
        worker = (sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(file), "--no-nanny")
        doomed, _ = (stack.enter_context(process(*worker, "--nthreads", "1", "--no-dashboard")) for _ in range(2))
        address = json.loads(file.read_text())["address"]
        client = (*PROGRAM, str(experiment.folder), "--seeds", "8", "--cluster", address)
        with process(*client) as started:
            wait_for(lambda: len(finished(experiment)) >= 3, started)
            assert len(finished(experiment)) < 16
            doomed.kill()
            said = started.communicate(timeout=300)[0]
    assert doomed.wait() == -signal.SIGKILL
    assert started.returncode == 1, said  # by the expected figure alone
    assert said.count("missed: ") == 1, said
    assert len(finished(experiment)) == 16
    assert "16 runs, 0 of them given up" in results(experiment)


def test_a_run_needs_no_extras() -> None:
    # refused only after the command has imported everything it uses
    program = """
import sys
from drawbar.cli.main import main
sys.argv = ["drawbar", "run", "none.toml"]
try:
    main()
except SystemExit:
    extras = {"distributed", "dask", "matplotlib", "optuna"}
    sys.exit("drawbar.step.build" not in sys.modules or bool(extras & set(sys.modules)))
"""
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


def test_jobs_are_not_for_a_running_cluster(drawbar) -> None:
    code, said = drawbar("all", "--jobs", "2", "--cluster", "tcp://127.0.0.1:1")
    assert code == 2
    assert "--jobs 2 and --cluster" in said


def test_all_experiments_make_one_report(
    drawbar, on_cluster: None, two_cases: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("first", "second"):
        folder = tmp_path / "experiments" / name
        folder.mkdir(parents=True)
        (folder / "experiment.toml").write_text(two_cases.replace("Two controllers", f"The {name} one"), "utf-8")
    analysis = "def figures(result):\n    return {'seed': result.metrics.seed}\n"
    (tmp_path / "experiments" / "second" / "analysis.py").write_text(analysis, "utf-8")
    monkeypatch.chdir(tmp_path)
    code, said = drawbar("all", "--seeds", "2")
    assert code == 0, said
    report = (tmp_path / "experiments" / "REPORT.md").read_text("utf-8")
    assert "| [The first one](first/results.md) | [what is compared](first/README.md) | 2 | 2 | 0 | 0 |" in report
    assert report.index("[The first one]") < report.index("[The second one]")
    results = (tmp_path / "experiments" / "second" / "results.md").read_text("utf-8")
    assert "| slow | 2/2 | 0.5 ± 6.4 |" in results  # of the seeds 0 and 1: t(0.975, 1) = 12.7
    assert (tmp_path / "experiments" / "second" / "means.csv").exists()


def test_tables_that_need_a_case_that_was_not_chosen_give_way_to_the_means(
    drawbar, on_cluster: None, two_cases: str, write_experiment: Write
) -> None:
    experiment = write_experiment(two_cases)
    analysis = "def report(measured):\n    return [measured.statistic('articulated', 'tractor all')]\n"
    (experiment.folder / "analysis.py").write_text(analysis, "utf-8")
    code, said = drawbar(str(experiment.folder), "--seeds", "1", "--only", "slow")
    assert code == 0, said
    assert "no result of articulated: a table of means is written in place of the" in said
    assert "| slow | 1/1 |" in results(experiment)


PICTURE = """from drawbar.experiment.elements import Picture
def report(measured):
    return [Picture(name="p", caption="c", draw=lambda figure: figure / 0)]
"""
FAILING = {
    "module": ("x = 1\ny = z\n", 2, "NameError: name 'z' is not defined"),
    "syntax": ("def figures(:\n", 1, "SyntaxError: "),
    "figures": ("def figures(result):\n    return {}['late']\n", 2, "KeyError: 'late', of 'articulated'"),
    "report": ("def report(measured):\n    return 1 // 0\n", 2, "ZeroDivisionError: "),
    "picture": (PICTURE, 3, "TypeError: "),
}


@pytest.mark.parametrize("where", FAILING)
def test_what_an_own_analysis_raises_is_told_by_its_line(
    drawbar, on_cluster: None, two_cases: str, write_experiment: Write, where: str
) -> None:
    experiment = write_experiment(two_cases)
    analysis, line, error = FAILING[where]
    file = experiment.folder / "analysis.py"
    file.write_text(analysis, "utf-8")
    code, said = drawbar(str(experiment.folder), "--seeds", "1")
    assert code == 2
    assert f"error: {file}:{line}: {error}" in said
    assert "mend the analysis there" in said


def test_what_drawbar_itself_raises_is_no_failure_of_the_analysis(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="own"), failures_told(tmp_path):
        raise ValueError("own")


def test_an_experiment_of_which_nothing_is_left_keeps_its_results(
    drawbar, on_cluster: None, write_experiment: Write
) -> None:
    experiment = write_experiment('title = "x"\ncases = [{ name = "paper", needs = "no such folder" }]')
    (experiment.folder / "results.md").write_text("measured elsewhere", "utf-8")
    code, said = drawbar(str(experiment.folder))
    assert code == 0
    assert "small: paper is left out: no such folder is not here" in said
    assert results(experiment) == "measured elsewhere"
