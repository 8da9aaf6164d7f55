"""acados beside drawbar: how a problem is declared for it, and, where it is installed, that both find the same plan."""

import io
import os
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from rich.console import Console

from drawbar.benchmark.acados import comparison
from drawbar.benchmark.acados.__main__ import compare, main
from drawbar.benchmark.acados.declaration import QP_SOLVERS, places
from drawbar.benchmark.tables import acados_table
from drawbar.optimal import Bound, ControlProblem
from drawbar.optimal.transcription import transcribe
from drawbar.vehicle.model import declare, variables

FOLDER = os.environ.get("DRAWBAR_ACADOS")
"""where `pip install --no-deps --target FOLDER comma-deps-acados` has put it"""
installed = pytest.mark.skipif(FOLDER is None, reason="DRAWBAR_ACADOS names no folder with acados")


def test_a_bound_is_found_by_its_stage() -> None:
    model = declare(
        "cart",
        states=variables(place="m", speed="m/s"),
        inputs=variables(push="m/s²", brake="m/s²"),
        parameters=(),
        outputs=variables(place="m"),
        equations=lambda x, u, p: (ca.vertcat(x[1], u[0] - u[1]), x[0]),
    )
    problem = ControlProblem(
        model=model,
        horizon=3,
        sample_time=0.1,
        weights={"place": 1.0},
        terminal_weights={"place": 1.0},
        bounds={
            "speed": Bound(lower=-1.0, upper=1.0, linear_penalty=10.0),
            "brake": Bound(lower=0.0, upper=2.0),
            "push": Bound(lower=0.0, upper=3.0),
        },
    )
    found = places(transcribe(problem))
    # rows of lower and upper: speed at the stages 1 to 3, push at 0 to 2, brake at 0 to 2
    assert found.states == {1: [0], 2: [1], 3: [2]}
    assert found.inputs == {0: [3, 6], 1: [4, 7], 2: [5, 8]}


def test_a_folder_without_acados_is_refused_with_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["acados", str(tmp_path), "--only", "paper"])
    assert main() == 2
    assert f"pip install --no-deps --target {tmp_path} comma-deps-acados" in capsys.readouterr().err


@installed
@pytest.mark.parametrize("name", ["paper", "articulated", "articulated-centralised"])
def test_both_find_the_same_plan(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Soft and hard bounds, missing measurements, an arrival cost, and constants that the run changes."""
    assert FOLDER is not None
    monkeypatch.setattr(comparison, "QP_SOLVERS", (QP_SOLVERS[2],))
    rows = list(compare(Path(FOLDER), name, 4, ["path.straight_length=4.0"]))
    others = [row for row in rows if row["solver"] != "drawbar"]
    assert len(others) == (1 if name.endswith("centralised") else 3)
    for row in others:
        assert row["largest_difference"] < 1e-5, row
        assert 0.0 < row["total_us"]["median"] < np.inf
    console = Console(file=io.StringIO(), width=120)
    console.print(acados_table(rows, 15))
    assert console.file.getvalue().count(f"acados, {QP_SOLVERS[2].name}") == len(others)
