"""The search on closed forms: it finds a known front, and continues after a kill as if there had been none."""

import math
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from pathlib import Path

import numpy as np
import optuna
import pytest

from drawbar.errors import DrawbarError, StorageError
from drawbar.experiment.cluster import Failure
from drawbar.experiment.tuning.parameters import Parameter, Values
from drawbar.experiment.tuning.study import BATCH, Score, Trial, finished_trials, front, importances, open_study, search

PARAMETERS = (
    Parameter(key="x", low=-4.0, high=4.0, log=False, own=3.0),
    Parameter(key="y", low=0.01, high=100.0, log=True, own=30.0),
    Parameter(key="n", low=1, high=5, log=False, own=4),
)


def analytic(batch: Sequence[tuple[int, Values]]) -> list[Score | Failure]:
    """Score: the Pareto set is x in [-1, 1], y = 1, n = 2."""
    return [closed_form(**values) for _, values in batch]


def closed_form(x: float, y: float, n: int) -> Score:
    rest = 0.1 * math.log(y) ** 2 + (n - 2) ** 2
    return Score(error=(x - 1.0) ** 2 + rest, effort=(x + 1.0) ** 2 + rest)


def driver_that_dies(after: int, file: Path) -> str:
    return f"""
import os
from pathlib import Path
from test_study import PARAMETERS, analytic, open_study, search
calls = []
def evaluate(batch):
    calls.append(batch)
    if len(calls) > {after}:
        os._exit(9)
    return analytic(batch)
search(open_study(Path({str(file)!r}), "s"), PARAMETERS, evaluate, trials=30, seed=5)
"""


def run(file: Path, trials: int, seed: int = 5, evaluate=analytic) -> optuna.Study:
    study = open_study(file, "s")
    search(study, PARAMETERS, evaluate, trials=trials, seed=seed)
    return study


@pytest.fixture(scope="module")
def thirty(tmp_path_factory: pytest.TempPathFactory) -> list[Trial]:
    return finished_trials(run(tmp_path_factory.mktemp("study") / "journal", 30))


def test_the_first_trial_is_the_configurations_own(thirty: list[Trial]) -> None:
    assert [trial.number for trial in thirty] == list(range(30))
    assert thirty[0].values == {"x": 3.0, "y": 30.0, "n": 4}
    assert thirty[0].outcome == closed_form(3.0, 30.0, 4)
    for trial in thirty:
        assert isinstance(trial.values["n"], int)
        assert all(one.low <= trial.values[one.key] <= one.high for one in PARAMETERS)


def test_a_known_front_is_approached(tmp_path: Path) -> None:
    study = run(tmp_path / "journal", 80)
    best = front(finished_trials(study))
    assert best[0].number > 0
    for trial in best:
        assert trial.values["n"] in (1, 2, 3)
        # on the front itself the square roots of both objectives add up to the distance 2 of their optima
        assert math.sqrt(trial.outcome.error) + math.sqrt(trial.outcome.effort) < 3.3
    assert min(math.sqrt(trial.outcome.error) + math.sqrt(trial.outcome.effort) for trial in best) < 2.4
    shares = importances(study)
    assert shares.keys() == {"x", "y", "n"}
    assert sum(error for error, _ in shares.values()) == pytest.approx(1.0)
    assert shares["x"][0] > shares["y"][0]


def test_a_killed_search_goes_on_as_if_it_had_not_been_killed(thirty: list[Trial], tmp_path: Path) -> None:
    file = tmp_path / "journal"
    program = driver_that_dies(2, file)
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parent)}
    assert subprocess.run([sys.executable, "-c", program], env=environment, check=False).returncode == 9
    before = finished_trials(open_study(file, "s"))
    assert before == thirty[: 2 * BATCH]
    drawn = []

    def evaluate(batch: Sequence[tuple[int, Values]]) -> list[Score | Failure]:
        drawn.extend(number for number, _ in batch)
        return analytic(batch)

    assert finished_trials(run(file, 30, evaluate=evaluate)) == thirty
    assert drawn == list(range(2 * BATCH, 30))


def test_a_search_on_a_full_disk_names_the_journal_and_goes_on_once_there_is_room(
    thirty: list[Trial], tmp_path: Path, room: Callable[[int], AbstractContextManager[None]]
) -> None:
    file = tmp_path / "journal"
    run(file, BATCH)
    with room(file.stat().st_size + 700), pytest.raises(StorageError, match=r"journal: cannot be written \(.+\); free"):
        run(file, 30)
    assert file.read_bytes().endswith(b"}\n")
    assert finished_trials(run(file, 30)) == thirty


def test_more_trials_go_on_where_fewer_stopped(thirty: list[Trial], tmp_path: Path) -> None:
    run(tmp_path / "journal", 3 * BATCH)
    assert finished_trials(run(tmp_path / "journal", 30)) == thirty
    assert finished_trials(run(tmp_path / "journal", 5)) == thirty


def test_another_seed_draws_others(thirty: list[Trial], tmp_path: Path) -> None:
    others = finished_trials(run(tmp_path / "journal", 4, seed=6))
    assert others[0] == thirty[0]
    assert all(other.values != one.values for other, one in zip(others[1:], thirty[1:], strict=False))


def test_refused_values_are_reported_once_and_learnt_from_by_nobody(tmp_path: Path) -> None:
    def evaluate(batch: Sequence[tuple[int, Values]]) -> list[Score | Failure]:
        return [Failure(reason="n is odd") if values["n"] % 2 else closed_form(**values) for _, values in batch]

    trials = finished_trials(run(tmp_path / "journal", 20, evaluate=evaluate))
    assert len(trials) == 20
    odd = [trial for trial in trials if trial.values["n"] % 2]
    assert odd
    assert all(trial.outcome == Failure(reason="n is odd") for trial in odd)
    assert not {trial.number for trial in front(trials)} & {trial.number for trial in odd}
    assert finished_trials(run(tmp_path / "journal", 20, evaluate=None)) == trials


def test_figures_that_are_missing_are_no_score(tmp_path: Path) -> None:
    def evaluate(batch: Sequence[tuple[int, Values]]) -> list[Score | Failure]:
        return [Score(error=1.0, effort=math.nan) for _ in batch]

    trials = finished_trials(run(tmp_path / "journal", 3, evaluate=evaluate))
    assert all(isinstance(trial.outcome, Failure) for trial in trials)
    assert front(trials) == []


def test_the_front_is_that_of_optuna_and_of_the_definition(tmp_path: Path) -> None:
    def evaluate(batch: Sequence[tuple[int, Values]]) -> list[Score | Failure]:
        # runs are given up where x > 1, where both objectives would be the best
        scores = analytic(batch)
        shift = [100.0 if values["x"] > 1.0 else 0.0 for _, values in batch]
        return [
            Score(error=score.error - far, effort=score.effort - far, unfinished=0.2 * (far > 0.0))
            for score, far in zip(scores, shift, strict=True)
            if isinstance(score, Score)
        ]

    study = run(tmp_path / "journal", 40, evaluate=evaluate)
    trials = finished_trials(study)
    driven = [trial for trial in trials if not trial.outcome.unfinished]
    assert len(driven) < len(trials)
    pairs = {trial.number: np.array((trial.outcome.error, trial.outcome.effort)) for trial in driven}
    beaten = {
        number
        for number, pair in pairs.items()
        if any((other <= pair).all() and (other < pair).any() for other in pairs.values())
    }
    best = front(trials)
    assert {trial.number for trial in best} == pairs.keys() - beaten
    assert [trial.outcome.error for trial in best] == sorted(trial.outcome.error for trial in best)
    assert {trial.number for trial in best} == {trial.number for trial in study.best_trials}


def test_of_equals_the_front_keeps_the_first() -> None:
    pairs = [(2.0, 1.0), (1.0, 3.0), (1.0, 2.0), (1.0, 2.0), (3.0, 1.0), (2.0, 1.0)]
    scores = [Score(error=error, effort=effort) for error, effort in pairs]
    trials = [Trial(number=number, values={}, outcome=score) for number, score in enumerate(scores)]
    assert [trial.number for trial in front(trials)] == [2, 0]


def test_a_journal_that_is_none_is_reported(tmp_path: Path) -> None:
    with pytest.raises(DrawbarError, match="cannot keep the study there"):
        open_study(tmp_path, "s")
