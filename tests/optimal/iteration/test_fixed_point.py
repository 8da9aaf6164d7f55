"""A problem whose data stay as they are is solved again and again, and nothing is left to do: every answer passes."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drawbar.signals import SolverStatus

REPEATS = 300
SEED = 7


@pytest.mark.parametrize("share", [1.0, 0.1, 1e-3])
def test_an_optimum_is_solved_again_without_an_iteration(case: Any, share: float) -> None:
    chance = np.random.default_rng(SEED)
    for _ in range(5):
        initial = share * chance.uniform(0.5, 1.0, case.initial.shape) * case.initial
        solver = replace(case, initial=initial).solver()
        seen = [(solver.prepare(), solver.feedback(), solver.iterations) for _ in range(REPEATS)]
        assert {(prepared, fed) for prepared, fed, _ in seen} == {(SolverStatus.SOLVED, SolverStatus.SOLVED)}
        assert np.ptp([iterations for _, _, iterations in seen[REPEATS // 2 :]]) == 0
