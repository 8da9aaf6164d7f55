"""Which compiler is found, and that the wheel's compiler builds the same solver as the system's."""

import importlib.util
import re
import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drawbar.codegen.compiler import compiler_identity, find_compiler
from drawbar.errors import CompilerError
from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem, ControlSolver
from drawbar.signals import SolverStatus
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle_tractor

pytestmark = pytest.mark.usefixtures("no_compiler_yet")


def executable(path: Path) -> Path:
    path.write_text("#!/bin/sh\nexit 1\n")
    path.chmod(0o755)
    return path


def test_chosen_compiler_comes_first_with_its_arguments(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", f"'{sys.executable}' -m ziglang cc")
    assert find_compiler() == (sys.executable, "-m", "ziglang", "cc")


def test_chosen_compiler_that_is_missing_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler -O2")
    with pytest.raises(CompilerError, match=re.escape("CC='no-such-compiler -O2' names no program")):
        find_compiler()


@pytest.mark.parametrize("chosen", ['"x', "''"])
def test_chosen_compiler_that_is_no_command_is_refused(monkeypatch: pytest.MonkeyPatch, chosen: str) -> None:
    monkeypatch.setenv("CC", chosen)
    with pytest.raises(CompilerError, match=re.escape(f"CC={chosen!r}") + ".* name a C compiler"):
        find_compiler()


def test_system_compilers_in_order(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    for name in ("clang", "gcc", "cc"):
        expected = executable(tmp_path / name)
        find_compiler.cache_clear()
        assert find_compiler() == (str(expected),)


def test_blank_choice_counts_as_none(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("CC", "  ")
    monkeypatch.setenv("PATH", str(tmp_path))
    only = executable(tmp_path / "cc")
    assert find_compiler() == (str(only),)


def test_nothing_found_says_how_to_get_one(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(CompilerError, match=re.escape(f"Try: {sys.executable} -m pip install 'ziglang>=0.17'")):
        find_compiler()


def test_another_compiler_has_another_identity(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    identities = set()
    for name in ("clang", "gcc"):
        executable(tmp_path / name)
        find_compiler.cache_clear()
        compiler_identity.cache_clear()
        identities.add(compiler_identity())
    assert len(identities) == 2


def solved() -> Floats:
    """Return the trajectory of three iterations towards a reference beside the tractor, a bound active."""
    problem = ControlProblem(
        model=tricycle_tractor(VehicleParameters()),
        horizon=10,
        sample_time=0.2,
        weights={"x": 1.0, "y": 1.0, "steering": 0.1},
        terminal_weights={"x": 10.0, "y": 10.0},
        bounds={"steering": Bound(lower=-0.3, upper=0.3)},
    )
    solver = ControlSolver(problem)
    solver.p[:] = (0.95, 0.9, 1.0)
    solver.y[:] = (2.0, 1.0, 0.0)
    for _ in range(3):
        solver.prepare()
        assert solver.feedback() == SolverStatus.SOLVED
    assert solver.iterations > 0
    return np.concatenate([solver.x.ravel(), solver.u.ravel()])


@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the ziglang wheel is not installed")
@pytest.mark.skipif(shutil.which("cc") is None, reason="no system compiler to compare with")
def test_wheel_compiler_gives_the_numbers_of_the_system_compiler(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, own_cache: Any
) -> None:
    system = solved()
    monkeypatch.setenv("PATH", str(tmp_path))
    find_compiler.cache_clear()
    compiler_identity.cache_clear()
    assert "ziglang" in find_compiler()
    wheel = solved()
    assert len(list(own_cache.glob("*.so"))) == 2
    assert (own_cache / "zig").is_dir(), "the wheel's own cache lies in ours"
    np.testing.assert_allclose(wheel, system, rtol=0, atol=1e-9)
