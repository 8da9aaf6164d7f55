"""experiment.toml: what it says is what is driven, and what is wrong in it is told."""

import math
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from pydantic import ValidationError

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.experiment.declaration import Expectation
from drawbar.experiment.experiment import Experiment, find_experiments
from drawbar.experiment.statistics import Statistic

Write = Callable[[str], Experiment]


def test_every_case_has_a_task_per_seed(write_experiment: Write, two_cases: str) -> None:
    tasks = write_experiment(two_cases).tasks(4)
    assert list(tasks) == ["articulated", "slow"]
    assert [task.seed for task in tasks["slow"]] == [0, 1, 2, 3]
    assert len({task.key for case in tasks.values() for task in case}) == 8
    changes = ("path.radii=[5.0]", "path.straight_length=1.0", "speed=0.8")
    assert tasks["slow"][0].configuration == load_configuration("articulated", changes).to_toml()
    assert tasks["slow"][0].columns == ("error.tractor",)


def test_a_case_may_be_driven_more_often_than_others(write_experiment: Write) -> None:
    experiment = write_experiment(
        'title = "x"\nseeds = 2\ncases = [{ name = "paper", seeds = 3 }, { name = "articulated" }]'
    )
    assert {case: len(tasks) for case, tasks in experiment.tasks().items()} == {"paper": 3, "articulated": 2}
    assert {len(tasks) for tasks in experiment.tasks(1).values()} == {1}


def test_every_case_is_driven_in_every_variant(write_experiment: Write, two_cases: str) -> None:
    variants = 'variants = [{ name = "fast", changes = ["speed=1.5"] }, { name = "as it is" }]'
    experiment = write_experiment(two_cases + variants)
    speeds = {name: tomllib.loads(text)["speed"] for name, text in experiment.configurations.items()}
    assert speeds == {
        "articulated: fast": 1.5,
        "articulated: as it is": 1.0,
        "slow: fast": 1.5,
        "slow: as it is": 0.8,
    }


def test_a_variant_may_be_of_those_cases_only_that_name_it(write_experiment: Write) -> None:
    experiment = write_experiment(
        'title = "x"\ncases = [{ name = "paper", variants = ["a", "b"] }, { name = "articulated" }]\n'
        'variants = [{ name = "a" }, { name = "b", only_named = true }]'
    )
    assert list(experiment.configurations) == ["paper: a", "paper: b", "articulated: a"]


def test_a_case_may_be_driven_in_some_variants_only(write_experiment: Write) -> None:
    experiment = write_experiment(
        'title = "x"\ncases = [{ name = "paper", variants = ["b"] }, { name = "articulated" }]\n'
        'variants = [{ name = "a" }, { name = "b" }]'
    )
    assert list(experiment.configurations) == ["paper: b", "articulated: a", "articulated: b"]


def test_a_case_may_name_a_selection_of_variants(write_experiment: Write) -> None:
    experiment = write_experiment(
        'title = "x"\ncases = [{ name = "paper", variants = ["some", "c"] }]\n'
        'variants = [{ name = "a" }, { name = "b" }, { name = "c" }, { name = "d" }]\n'
        '[selections]\nsome = ["b", "a"]'
    )
    assert list(experiment.configurations) == ["paper: a", "paper: b", "paper: c"]


def test_a_selection_of_no_variant_is_refused(write_experiment: Write) -> None:
    with pytest.raises(ConfigurationError, match="'paper' names no variant: z; variants: a, some"):
        write_experiment(
            'title = "x"\ncases = [{ name = "paper", variants = ["some"] }]\nvariants = [{ name = "a" }]\n'
            '[selections]\nsome = ["a", "z"]'
        )


def test_figures_of_time_are_measured_on_one_core(write_experiment: Write, two_cases: str) -> None:
    alone = write_experiment("one_at_a_time = true\n" + two_cases).tasks(1)
    assert all(task.one_core for tasks in alone.values() for task in tasks)
    assert not any(task.one_core for task in write_experiment(two_cases).tasks(1)["slow"])


def test_a_case_may_have_a_configuration_of_its_own(write_experiment: Write, tmp_path: Path) -> None:
    (tmp_path / "small").mkdir()
    (tmp_path / "small" / "mine.toml").write_text('extends = "paper"\nname = "mine"\n', "utf-8")
    experiment = write_experiment('title = "x"\ncases = [{ name = "a", configuration = "mine.toml" }]')
    assert tomllib.loads(experiment.configurations["a"])["name"] == "mine"


def test_a_case_without_what_it_needs_is_left_out(write_experiment: Write, tmp_path: Path) -> None:
    cases = f"""title = "x"
cases = [{{ name = "paper" }}, {{ name = "a", configuration = "paper", needs = "{(tmp_path / "field").as_posix()}" }}]
expected.a.x = {{ at_most = 1.0 }}
"""
    experiment = write_experiment(cases)
    assert list(experiment.tasks(1)) == ["paper"]
    assert list(experiment.left_out) == ["a"]
    assert experiment.left_out["a"].endswith("field is not here")
    (tmp_path / "field").mkdir()
    assert list(write_experiment(cases).tasks(1)) == ["paper", "a"]


WRONG = {
    "no TOML": ("title = ", "cannot be read as an experiment"),
    "no case": ('title = "x"\ncases = []', "cases"),
    "unknown key": (
        'title = "x"\nseed = 3\ncases = [{ name = "paper" }]',
        "experiment.toml: 1 wrong value.\n  experiment: has no key seed (did you mean seeds?)",
    ),
    "wrong value": (
        'title = "x"\nseeds = 0\ncases = [{ name = "paper" }]',
        "experiment.toml: 1 wrong value.\n  seeds = 0: must be greater than or equal to 1.",
    ),
    "unknown configuration": (
        'title = "x"\ncases = [{ name = "papre" }]',
        "case 'papre', whose name is that of its configuration, cannot be read: papre: is neither a file nor a shipped",
    ),
    "same name twice": (
        'title = "x"\ncases = [{ name = "paper" }, { name = "paper" }]',
        "two cases are called 'paper'",
    ),
    "expectation of no case": (
        'title = "x"\ncases = [{ name = "paper" }]\nexpected.papre.x = { at_most = 1.0 }',
        "expected names no case: papre",
    ),
    "what was learned of no case": (
        'title = "x"\nlearned = "It errs by {papre|x} cm."\ncases = [{ name = "paper" }]',
        "learned or why_missed names no case: papre; cases: paper",
    ),
    "case of no variant": (
        'title = "x"\ncases = [{ name = "paper", variants = ["b"] }]\nvariants = [{ name = "a" }]',
        "case 'paper' names no variant: b; variants: a",
    ),
    "half an expectation": (
        'title = "x"\ncases = [{ name = "paper" }]\nexpected.paper.x = { value = 1.0 }',
        "either value and within, or at_most",
    ),
    "a lower limit alone": (
        'title = "x"\ncases = [{ name = "paper" }]\nexpected.paper.x = { at_least = 1.0 }',
        "give either value and within, or at_most",
    ),
    "limits the wrong way round": (
        'title = "x"\ncases = [{ name = "paper" }]\nexpected.paper.x = { at_least = 1.0, at_most = 0.0 }',
        "at_least belongs to an at_most that is more",
    ),
    "column that no run has": (
        'title = "x"\ncolumns = ["step", "measurement.tim", "plan.tractor.deviation.2", "measurement"]\n'
        'cases = [{ name = "paper" }]',
        "columns has what no run has: 'measurement.tim' (did you mean measurement.time?), 'measurement' (did you mean",
    ),
    "body that there is not": (
        'title = "x"\ncolumns = ["error.plough"]\ncases = [{ name = "paper" }]',
        "'error.plough'",
    ),
    "column of a plain run in a rehearsal": (
        'title = "x"\nrehearsed = true\ncolumns = ["watch.speed", "error.tractor"]\ncases = [{ name = "paper" }]',
        "columns has what no run has: 'error.tractor' (did you mean watch.tractor?); a column is watch.NAME",
    ),
    "two expectations": (
        'title = "x"\ncases = [{ name = "paper" }]\nexpected.paper.x = { value = 1.0, within = 0.1, at_most = 1.0 }',
        "either value and within, or at_most",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_is_reported(write_experiment: Write, case: str) -> None:
    text, part = WRONG[case]
    with pytest.raises(ConfigurationError) as error:
        write_experiment(text)
    assert part in str(error.value)


def test_an_expectation_holds_or_not() -> None:
    near, limit = Expectation(value=-50.0, within=0.1), Expectation(at_most=3.0)
    assert [near.holds(mean) for mean in (-44.9, -45.0, -55.0, -55.1, math.nan)] == [False, True, True, False, False]
    assert [limit.holds(mean) for mean in (-9.0, 3.0, 3.1, math.nan)] == [True, True, False, False]
    between = Expectation(at_least=1.0, at_most=3.0)
    assert [between.holds(mean) for mean in (0.9, 1.0, 3.0, 3.1, math.nan)] == [False, True, True, False, False]
    assert (str(near), str(limit), str(between)) == ("-50 ± 10 %", "≤ 3", "1 to 3")


def test_a_limit_of_every_run_is_held_against_the_largest() -> None:
    statistic = Statistic.of([1.0, 2.0, 6.0])
    mean, every = Expectation(at_most=5.0), Expectation(at_most=5.0, in_every_run=True)
    assert [limit.holds(limit.judged(statistic)) for limit in (mean, every)] == [True, False]
    assert str(every) == "≤ 5 in every run"
    with pytest.raises(ValidationError, match="in_every_run belongs to an at_most alone"):
        Expectation(at_least=1.0, at_most=3.0, in_every_run=True)


def test_experiments_are_found_by_name_by_path_and_all(
    write_experiment: Write, two_cases: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = write_experiment(two_cases).folder
    assert find_experiments(str(folder)) == [folder]
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ConfigurationError, match="none; run the command where"):
        find_experiments("all")
    for name in ("second", "first"):
        (tmp_path / "experiments" / name).mkdir(parents=True)
        (tmp_path / "experiments" / name / "experiment.toml").write_text(two_cases, "utf-8")
    assert [folder.name for folder in find_experiments("all")] == ["first", "second"]
    assert find_experiments("second") == [Path("experiments/second")]
    monkeypatch.chdir(tmp_path / "experiments" / "first")
    assert find_experiments(".") == [tmp_path / "experiments" / "first"], "it is called by its folder"
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ConfigurationError, match=r"third: is no experiment, .* first, second"):
        find_experiments("third")
    with pytest.raises(ConfigurationError, match=r"frist: is no experiment \(did you mean first\?\), which"):
        find_experiments("frist")
