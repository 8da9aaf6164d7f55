"""Study by Optuna, the search itself: multi-objective, on what a trial scores, whatever it is that is tried.

Tree-structured Parzen estimators (Bergstra, Bardenet, Bengio, Kégl 2011, *Algorithms for hyper-parameter optimization*)
for several objectives (Ozaki, Tanigaki, Watanabe, Onishi 2020, *Multiobjective tree-structured Parzen estimator for
computationally expensive optimization problems*). Trials come in batches of a fixed size, and each is drawn with a seed
of its own: the same seed gives the same study, however many processes there are and however often it was interrupted.
"""

import math
import os
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import optuna
from optuna.distributions import BaseDistribution, FloatDistribution, IntDistribution
from optuna.importance import get_param_importances
from optuna.samplers import TPESampler
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend
from optuna.trial import FrozenTrial, TrialState

from drawbar.errors import DrawbarError
from drawbar.experiment.cluster import Failure
from drawbar.experiment.tuning.parameters import Parameter, Values
from drawbar.experiment.writing import writing

BATCH = 8
"""trials that are drawn before any of them is measured"""
_OBJECTIVES = ("error", "effort")
_ENOUGH = 10
"""trials with a score from which importances are shown"""
_UNFINISHED = "unfinished"
_REASON = "reason"


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """What a trial came to, mean over its runs."""

    error: float
    """m"""
    effort: float
    """rad/s"""
    unfinished: float = 0.0
    """part of its runs that were given up before the end of the path; above zero, the trial is on no front"""

    @property
    def finite(self) -> bool:
        """Whether all of it is a number."""
        return all(map(math.isfinite, (self.error, self.effort, self.unfinished)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """What was tried and what came of it."""

    number: int
    """0: the configuration as it is"""
    values: Values
    outcome: Score | Failure


Evaluate = Callable[[Sequence[tuple[int, Values]]], Sequence[Score | Failure]]
"""scores a batch of numbered trials, in their order"""


class _Journal(JournalFileBackend):
    """Optuna's journal in a file; of what a full disk cut off nothing stays, which would make the file unreadable."""

    def append_logs(self, logs: list[dict[str, Any]]) -> None:
        """Append records. Raises StorageError: they cannot be written."""
        file = Path(self._file_path)
        with writing(file):
            size = file.stat().st_size
            try:
                super().append_logs(logs)
            except OSError:
                os.truncate(file, size)
                raise


def open_study(file: Path, name: str) -> optuna.Study:
    """Create the study of this name in Optuna's journal file, or find it there.

    Raises DrawbarError when the file cannot be read or written.
    """
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    try:
        storage = JournalStorage(_Journal(str(file)))
        return optuna.create_study(
            storage=storage, study_name=name, directions=["minimize"] * len(_OBJECTIVES), load_if_exists=True
        )
    except (OSError, ValueError) as error:
        raise DrawbarError(f"{file}: cannot keep the study there ({error}); choose another --out folder.") from error


def search(study: optuna.Study, parameters: Sequence[Parameter], evaluate: Evaluate, *, trials: int, seed: int) -> None:
    """Go on with a study until it has this many trials; the configuration's own values are the first.

    Args:
        study: as far as it is.
        parameters: what is searched.
        evaluate: scores a batch.
        trials: how many there shall be in all.
        seed: of the search.
    """
    for left in study.get_trials(deepcopy=False, states=(TrialState.RUNNING,)):
        study.tell(left.number, state=TrialState.FAIL)  # of an interrupted command; they are drawn again, the same
    while (count := len(finished_trials(study))) < trials:
        until = min(trials, (count // BATCH + 1) * BATCH)
        batch = [_ask(study, parameters, index, seed) for index in range(count, until)]
        outcomes = evaluate([(index, trial.params) for index, trial in enumerate(batch, count)])
        for trial, outcome in zip(batch, outcomes, strict=True):
            _tell(study, trial, outcome)


def finished_trials(study: optuna.Study) -> list[Trial]:
    """Return all trials with an outcome, in the order in which they were drawn."""
    outcomes = [(trial, _outcome(trial)) for trial in study.get_trials(deepcopy=False)]
    known = [(trial, outcome) for trial, outcome in outcomes if outcome]
    return [Trial(number=index, values=trial.params, outcome=outcome) for index, (trial, outcome) in enumerate(known)]


def front(trials: Sequence[Trial]) -> list[Trial]:
    """Return the trials that no other beats in one objective without losing in the other, the least error first."""
    scored = [(trial.outcome, trial) for trial in trials if isinstance(trial.outcome, Score)]
    driven = sorted(
        ((score, trial) for score, trial in scored if not score.unfinished > 0.0),
        key=lambda pair: (pair[0].error, pair[0].effort, pair[1].number),
    )
    best, least = [], math.inf
    for score, trial in driven:
        if score.effort < least:
            best.append(trial)
            least = score.effort
    return best


def importances(study: optuna.Study) -> dict[str, tuple[float, float]]:
    """Return, by key, how much each parameter alone decides which trials are among the best: shares for error, effort.

    Empty while there are too few trials to tell. PED-ANOVA (Watanabe, Bansal, Hutter 2023, *PED-ANOVA: efficiently
    quantifying hyperparameter importance in arbitrary subspaces*).
    """
    if sum(isinstance(trial.outcome, Score) for trial in finished_trials(study)) < _ENOUGH:
        return {}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="PedAnova.* low `target` values")  # these are the best ones here
        error = get_param_importances(study, target=lambda trial: float(trial.values[0]))
        effort = get_param_importances(study, target=lambda trial: float(trial.values[1]))
    return {key: (error[key], effort[key]) for key in sorted(error)}


def _ask(study: optuna.Study, parameters: Sequence[Parameter], index: int, seed: int) -> optuna.Trial:
    """Draw a trial; its draw depends on the study so far, on its index and on the seed alone."""
    if index == 0:
        study.enqueue_trial({parameter.key: parameter.own for parameter in parameters})
    study.sampler = TPESampler(seed=int(np.random.SeedSequence((seed, index)).generate_state(1)[0]))
    return study.ask({parameter.key: _distribution(parameter) for parameter in parameters})


def _tell(study: optuna.Study, trial: optuna.Trial, outcome: Score | Failure) -> None:
    if isinstance(outcome, Score) and not outcome.finite:
        outcome = Failure(reason="its runs are too short for any figure")
    if isinstance(outcome, Failure):
        trial.set_user_attr(_REASON, outcome.reason)
        study.tell(trial, state=TrialState.FAIL)
        return
    trial.set_constraint(_UNFINISHED, outcome.unfinished)
    study.tell(trial, (outcome.error, outcome.effort))


def _outcome(trial: FrozenTrial) -> Score | Failure | None:
    if trial.state == TrialState.COMPLETE:
        error, effort = trial.values
        return Score(error=error, effort=effort, unfinished=trial.constraints[_UNFINISHED])
    reason = trial.user_attrs.get(_REASON)
    return Failure(reason=reason) if reason else None


def _distribution(parameter: Parameter) -> BaseDistribution:
    low, high, log = parameter.low, parameter.high, parameter.log
    if parameter.whole:
        return IntDistribution(int(low), int(high), log=log)
    return FloatDistribution(low, high, log=log)
