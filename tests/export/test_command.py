"""`drawbar export` as its user sees it."""

import json
import os
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest
from short_run import Drawbar

from drawbar.errors import CompilerError
from drawbar.export import export
from drawbar.export.targets import Target
from drawbar.optimal.transcription import CONTROL_ITERATIONS, ESTIMATION_ITERATIONS


@pytest.fixture
def drawbar(drawbar: Drawbar, monkeypatch, tmp_path) -> Drawbar:
    """Return a function that exports inside tmp_path: exit code, and what it said."""
    monkeypatch.chdir(tmp_path)
    return partial(drawbar, "export")


def test_leaves_everything_it_promises(drawbar: Drawbar, tmp_path) -> None:
    code, said = drawbar("articulated", "--out", "library", "--set", "speed=0.8")
    assert code == 0
    assert "library/README.md" in said
    folder = tmp_path / "library"
    for name in ("include/drawbar.h", "src/step.c", "example/main.c", "example/path.csv", "CMakeLists.txt"):
        assert (folder / name).is_file()
    assert "speed = 0.8" in (folder / "config.toml").read_text("utf-8")
    header = (folder / "src" / "drawbar_components.h").read_text("utf-8")
    assert "DRAWBAR_STEP_SETTINGS {0.2, 0.8, 0.8, 0.5, 1.0, 3.0, 0.3, 0.03, 0.03, 16.0}" in header
    manifest = json.loads((folder / "manifest.json").read_text("utf-8"))
    assert manifest["configuration"]["name"] == "articulated"
    assert manifest["targets"] == {}
    iterations = {unit: bounds["interior_point_iterations"] for unit, bounds in manifest["bounds"].items()}
    assert iterations == {
        "estimator": ESTIMATION_ITERATIONS,
        "tractor": CONTROL_ITERATIONS,
        "trailer": CONTROL_ITERATIONS,
    }
    tractor = manifest["bounds"]["tractor"]
    assert tractor["active_set_columns"] == 0
    warm, newton = tractor["warm_start_passes"], tractor["projected_newton_passes"]
    # warm start; free; forward, passes, to take them back; the interior point's start, its iterations
    assert tractor["sweeps"] == warm + 1 + 1 + newton + 1 + 1 + 2 * CONTROL_ITERATIONS + 4
    assert manifest["state_bytes"] >= sum(manifest["components_bytes"].values())
    for name in ("notes.txt", "build/cache"):  # left alone
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text("mine", "utf-8")
    (folder / "src" / "step.c").write_text("changed", "utf-8")
    assert drawbar("articulated", "--out", "library")[0] == 0
    assert "changed" not in (folder / "src" / "step.c").read_text("utf-8")
    assert (folder / "notes.txt").read_text("utf-8") == (folder / "build" / "cache").read_text("utf-8") == "mine"
    (folder / "src" / "mine.c").write_text("mine", "utf-8")
    code, said = drawbar("articulated", "--out", "library")
    assert (code, "src/mine.c" in said) == (2, True)
    assert (folder / "src" / "mine.c").read_text("utf-8") == "mine"


def left_behind(folder: Path) -> dict[str, bytes]:
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def test_an_export_that_was_killed_does_not_block_the_next(drawbar: Drawbar, tmp_path) -> None:
    program = """
import os, signal, sys
import drawbar.export.export as export
from drawbar.cli.main import main
def killed(target, folder):
    (folder / "lib" / target.name).mkdir(parents=True)
    (folder / "lib" / target.name / "half.o").write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
export.build_target = killed
sys.argv = ["drawbar", "export", "articulated", "--out", "library", "--target", "cortex-m7"]
main()
"""
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=False)
    assert done.returncode == -signal.SIGKILL
    assert list((tmp_path / "library").rglob("half.o"))
    assert drawbar("articulated", "--out", "library")[0] == 0
    assert not list((tmp_path / "library").rglob("half.o"))


@pytest.mark.skipif(os.name != "posix", reason="has no locks of folders")
@pytest.mark.parametrize("meanwhile", ["record", "_write"])
@pytest.mark.parametrize("earlier", [False, True])
def test_a_second_export_into_one_folder_at_the_same_time_is_refused(
    drawbar: Drawbar, tmp_path, monkeypatch, meanwhile: str, earlier: bool
) -> None:
    if earlier:
        assert drawbar("articulated", "--out", "library", "--set", "speed=0.9")[0] == 0
    second, does = [], getattr(export, meanwhile)

    def while_another_begins(*given):
        monkeypatch.setattr(export, meanwhile, does)
        command = [sys.executable, "-m", "drawbar", "export", "articulated", "--out", "library"]
        second.append(subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False))
        return does(*given)

    monkeypatch.setattr(export, meanwhile, while_another_begins)
    code, said = drawbar("articulated", "--out", "library", "--set", "speed=0.8")
    assert code == 0, said
    (refused,) = second
    assert refused.returncode == 2
    assert "library: another export is on there; wait until it has ended" in refused.stderr
    assert "speed = 0.8" in (tmp_path / "library" / "config.toml").read_text("utf-8")
    assert (tmp_path / "library" / "manifest.json").is_file()


def test_an_export_that_is_told_to_stop_leaves_nothing(drawbar: Drawbar, tmp_path, monkeypatch) -> None:
    assert drawbar("articulated", "--out", "library")[0] == 0
    before = left_behind(tmp_path / "library")

    def stopped(_target: Target, _folder: Path) -> None:
        os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr(export, "build_target", stopped)
    for folder in ("library", "new/library"):
        assert drawbar("articulated", "--out", folder, "--target", "cortex-m7")[0] == 128 + signal.SIGTERM
    assert left_behind(tmp_path / "library") == before
    assert [each.name for each in tmp_path.iterdir()] == ["library"]


def test_an_export_that_fails_leaves_the_earlier_one(drawbar: Drawbar, tmp_path, monkeypatch) -> None:
    assert drawbar("articulated", "--out", "library")[0] == 0
    before = left_behind(tmp_path / "library")

    def refused(target: Target, folder: Path) -> None:
        (folder / "lib").mkdir()
        raise CompilerError("refused")

    monkeypatch.setattr(export, "build_target", refused)
    code, said = drawbar("articulated", "--out", "library", "--target", "cortex-m7", "--set", "speed=0.8")
    assert (code, "refused" in said) == (2, True)
    assert left_behind(tmp_path / "library") == before


@pytest.mark.parametrize("error", [KeyboardInterrupt(), CompilerError("refused")])
def test_an_export_that_ends_early_leaves_no_folder(drawbar: Drawbar, tmp_path, monkeypatch, error) -> None:
    def ended(_target: Target, _folder: Path) -> None:
        raise error

    monkeypatch.setattr(export, "build_target", ended)
    (tmp_path / "mine").mkdir()
    for folder in ("new/library", "mine/library"):
        assert drawbar("articulated", "--out", folder, "--target", "cortex-m7")[0] in (2, 130)
    assert [each.name for each in tmp_path.rglob("*")] == ["mine"]


REFUSED = {
    "no folder": ((), "--out"),
    "unknown target": (("--out", "library", "--target", "sparc"), "'sparc'"),
    "folder is a file": (("--out", "file"), "file"),
    "folder with other files": (("--out", "taken"), "choose another"),
    "a source folder of one's own": (("--out", "own"), "no earlier export wrote"),
    "simulation only": (("--out", "library", "--set", "estimator.model=ideal"), "The estimator of this configuration"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_exported_is_refused_in_one_message(drawbar: Drawbar, tmp_path, case: str) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "taken" / "src").mkdir(parents=True)
    (tmp_path / "taken" / "notes.txt").touch()
    for name in ("include/drawbar.h", "src/main.c", "manifest.json"):
        (tmp_path / "own" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "own" / name).write_text("{}", "utf-8")
    arguments, words = REFUSED[case]
    code, said = drawbar("articulated", *arguments)
    assert code == 2
    assert words in said
    assert "Traceback" not in said
    assert not (tmp_path / "library").exists()
    assert (tmp_path / "taken" / "src").is_dir()
    assert (tmp_path / "own" / "src" / "main.c").read_text("utf-8") == "{}"
