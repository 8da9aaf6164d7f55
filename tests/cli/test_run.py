"""`drawbar run` as its user sees it: exit code, one message, and what lies in the folder afterwards."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from short_run import FILES, SHORT, Drawbar

from drawbar.cli import options
from drawbar.config import load_configuration
from drawbar.recording.log import read_log
from drawbar.recording.recorder import Recorder

ROOT = Path(__file__).parents[2]


def without_times(file: Path) -> dict[str, Any]:
    metrics: dict[str, Any] = json.loads(file.read_bytes())
    del metrics["solve_time_s"], metrics["real_time_factor"]
    return metrics


def test_a_run_leaves_everything_it_promises(drawbar: Drawbar, tmp_path: Path) -> None:
    code, said = drawbar("run", *SHORT, "--seed", "3", "--out", "[out]")
    assert code == 0
    assert "[out]/report.html" in said
    assert {file.name for file in (tmp_path / "[out]").iterdir()} == FILES
    metrics = json.loads((tmp_path / "[out]" / "metrics.json").read_bytes())
    assert (metrics["config"], metrics["seed"], metrics["finished"]) == ("articulated", 3, True)
    for key in ("duration_s", "length_m", "real_time_factor"):
        assert metrics[key] > 0.0
    assert metrics["solver_failures"] == 0
    for body in ("tractor", "trailer"):
        for label in ("straight", "0.2", "all"):
            error = metrics["error_m"][body][label]
            assert 0.0 <= error["mean"] <= error["rms"] <= error["max"]
        for key in ("yaw_rmse_rad", "ancillary_share", "saturated_share"):
            assert isinstance(metrics[key][body], float)
    for solver in ("estimator", "tractor", "trailer"):
        for phase in ("prepare", "feedback"):
            time = metrics["solve_time_s"][solver][phase]
            assert 0.0 < time["median"] <= time["p99"] <= time["max"]


def readme_commands(*subcommands: str) -> list[str]:
    """Return README's command lines that call one of the subcommands."""
    return re.findall(
        rf"^    (drawbar (?:{'|'.join(subcommands)})\b.*)$", (ROOT / "README.md").read_text("utf-8"), re.M
    )


@pytest.mark.parametrize("command", readme_commands("run", "tube", "export"))
def test_readmes_commands_work_in_a_clone(drawbar: Drawbar, tmp_path: Path, command: str) -> None:
    if "export" in command:
        pytest.importorskip("ziglang")
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    code, said = drawbar(*shlex.split(command, comments=True)[1:])
    assert code == 0, said


def test_the_written_configuration_is_the_whole_run_again(drawbar: Drawbar, tmp_path: Path) -> None:
    assert drawbar("run", "paper", *SHORT, "--set", "speed=0.8", "--out", "a")[0] == 0
    assert drawbar("run", "a/config.toml", "--out", "b")[0] == 0
    assert (tmp_path / "a" / "config.toml").read_bytes() == (tmp_path / "b" / "config.toml").read_bytes()
    assert load_configuration(str(tmp_path / "b" / "config.toml")).speed == 0.8
    assert without_times(tmp_path / "a" / "metrics.json") == without_times(tmp_path / "b" / "metrics.json")


def test_metrics_are_the_same_bytes_for_a_seed_and_others_for_another(drawbar: Drawbar, tmp_path: Path) -> None:
    for folder, seed in (("a", "0"), ("b", "0"), ("c", "1")):
        assert drawbar("run", *SHORT, "--seed", seed, "--out", folder)[0] == 0
    first, again, other = (without_times(tmp_path / folder / "metrics.json") for folder in "abc")
    assert json.dumps(first) == json.dumps(again)
    assert first["error_m"] != other["error_m"]


def test_unnamed_folders_never_overwrite_each_other(drawbar: Drawbar, tmp_path: Path) -> None:
    for _ in range(2):
        assert drawbar("run", *SHORT)[0] == 0
    assert {folder.name for folder in (tmp_path / "runs").iterdir()} == {"articulated-seed0", "articulated-seed0-2"}


REFUSED = {
    "no such configuration": (("none.toml",), "none.toml"),
    "brackets in a name": (("[/red]",), "[/red]"),
    "unknown key": (("--set", "vehicle.wheelbse=1.4"), "wheelbse"),
    "no key": (("--set", "speed"), "KEY=VALUE"),
    "no such path": (("--path", "none.csv"), "none.csv"),
    "unknown kind of path": (("--path", "line.shp"), "line.shp"),
    "quotes in a path": (("--path", 'a"\n\\b.csv'), 'a"\n\\b.csv'),
    "steering too far": (("--set", "vehicle.tractor_steering_limit=0.02"), "vehicle.tractor_steering_limit = 0.02"),
    "steering too fast": (("--set", "vehicle.tractor_steering_rate=0.001"), "vehicle.tractor_steering_rate = 0.001"),
    "track without a path": (
        ("--track", "Cu 275.4°"),
        "error: --track Cu 275.4°: there is no file with lines; give --path",
    ),
    "a start 1 km away": (("--set", "start.ahead=1000.0"), "1000.0"),
    "radius too tight": (("--set", "path.radii=[1.0]"), "path.radii holds 1.0 m"),
    "sample time off the machine's grid": (("--set", "machine.step=0.03"), "0.03"),
    "too fast for the machine": (("--set", "speed=4.0"), "full_speed"),
    "empty path": (("--path", ""), "--path"),
    "no Unicode in a path": (("--path", "a\udcff.csv"), "not Unicode"),
    "folder with a long name": (("--out", "a" * 300), "too long"),
    "no seed": (("--seed", "-1"), "--seed"),
    "no number": (("--seed", "x"), "--seed"),
    "no option": (("--fast",), "--fast"),
    "folder is a file": (("--out", "file"), "file"),
    "folder below a file": (("--out", "file/out"), "file"),
    "folder with a folder for a file": (("--out", "blocked"), "blocked"),
    "folder with a folder for the log": (("--out", "blocked_log"), "blocked_log"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_driven_is_refused_in_one_message(drawbar: Drawbar, tmp_path: Path, case: str) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "line.shp").touch()
    (tmp_path / "blocked" / "config.toml").mkdir(parents=True)
    (tmp_path / "blocked_log" / "log.mcap").mkdir(parents=True)
    arguments, part = REFUSED[case]
    code, said = drawbar("run", *arguments)
    assert code == 2
    assert part in said
    assert "Traceback" not in said
    assert not (tmp_path / "runs").exists()


def test_a_recorded_field_names_its_lines(drawbar: Drawbar, recorded_field: Any) -> None:
    for track in ((), ("--track", "[/red]")):
        code, said = drawbar("run", "--path", str(recorded_field.folder), *track)
        assert code == 2
        assert ", ".join(map(repr, recorded_field.curves)) in said


@pytest.mark.parametrize("chosen", ["/nonexistent/cc", ""])
def test_no_compiler_is_reported(tmp_path: Path, chosen: str) -> None:
    hidden = "import sys; sys.modules['ziglang'] = None; import importlib.util as u; f = u.find_spec; "
    hidden += "u.find_spec = lambda name, *rest: None if name == 'ziglang' else f(name, *rest); "
    environment = {"PATH": "", "CC": chosen, "DRAWBAR_CACHE": str(tmp_path / "cache")}
    environment["PYTHONPATH"] = os.environ.get("PYTHONPATH", "")
    ended = subprocess.run(
        [sys.executable, "-c", hidden + "from drawbar.cli.main import main; main()", "run"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ended.returncode == 2
    assert "Traceback" not in ended.stderr
    assert ("CC='/nonexistent/cc'" if chosen else "-m pip install 'ziglang>=0.17'") in ended.stderr


def test_a_lost_run_ends_with_code_1_and_a_report(drawbar: Drawbar, tmp_path: Path) -> None:
    # beside the path and turned away from it, on ground that hardly lets it steer back
    changes = ("start.left=-3.0", "start.yaw=-0.9", "machine.ground.tractor_slip.mean=0.3")
    code, said = drawbar("run", *SHORT, *(f"--set={change}" for change in changes), "--out", "out")
    assert code == 1
    assert "m from the path (limit 6 m)" in " ".join(said.split())
    assert {file.name for file in (tmp_path / "out").iterdir()} == FILES
    assert not json.loads((tmp_path / "out" / "metrics.json").read_bytes())["finished"]
    log = read_log(tmp_path / "out" / "log.mcap")
    assert abs(log.records[-1].reference.tractor.lateral_error) > 5.0
    assert tomllib.loads(log.header.configuration)["start"]["yaw"] == -0.9


def test_a_folder_with_a_run_in_it_is_not_overwritten(drawbar: Drawbar, tmp_path: Path) -> None:
    assert drawbar("run", *SHORT, "--out", "out")[0] == 0
    edited = tmp_path / "out" / "config.toml"
    edited.write_text(edited.read_text("utf-8") + "# mine\n", "utf-8")
    before = {file.name: file.read_bytes() for file in edited.parent.iterdir()}
    code, said = drawbar("run", "out/config.toml", "--out", "out")
    assert code == 2
    assert "out: holds a run already (config.toml, log.mcap," in said
    assert "--force" in said
    assert {file.name: file.read_bytes() for file in edited.parent.iterdir()} == before
    assert drawbar("run", *SHORT, "--seed", "1", "--out", "out", "--force")[0] == 0
    assert "# mine" not in edited.read_text("utf-8")


@pytest.mark.parametrize("make", [Path.touch, lambda place: place.symlink_to("nowhere")], ids=["file", "dangling link"])
def test_what_is_no_folder_is_not_taken_for_one_with_a_run(
    drawbar: Drawbar, tmp_path: Path, make: Callable[[Path], None]
) -> None:
    make(tmp_path / "out")
    code, said = drawbar("run", *SHORT, "--out", "out")
    assert (code, " ".join(said.split())) == (2, "error: out: is there and is no folder; choose another --out folder.")


def test_of_two_runs_at_a_time_one_has_the_folder(
    drawbar: Drawbar, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert drawbar("run", *SHORT, "--out", "out")[0] == 0
    before = (tmp_path / "out" / "log.mcap").read_bytes()
    module = sys.modules["drawbar.cli.run"]
    monkeypatch.setattr(module, "_refuse_a_run_in", lambda folder: None)  # the other began after it had looked
    code, said = drawbar("run", *SHORT, "--out", "out")
    assert code == 2
    assert "out: holds a run already (config.toml)" in said
    assert (tmp_path / "out" / "log.mcap").read_bytes() == before


def test_a_run_that_is_on_is_not_overwritten(drawbar: Drawbar, tmp_path: Path) -> None:
    assert drawbar("run", *SHORT, "--out", "out")[0] == 0
    log = read_log(tmp_path / "out" / "log.mcap")
    with Recorder(tmp_path / "out" / "log.mcap", log.header) as recorder:
        recorder.write(log.records[0])
        before = (tmp_path / "out" / "config.toml").read_bytes()
        code, said = drawbar("run", *SHORT, "--seed", "1", "--out", "out", "--force")
        assert (code, "another run is recorded there; wait until" in " ".join(said.split())) == (2, True)
        recorder.write(log.records[1])
    assert len(read_log(tmp_path / "out" / "log.mcap").records) == 2
    assert (tmp_path / "out" / "config.toml").read_bytes() == before
    assert drawbar("run", *SHORT, "--out", "out", "--force")[0] == 0


@pytest.mark.parametrize("width", [40, 60, 79])
def test_a_narrow_terminal_shows_every_figure(drawbar: Drawbar, monkeypatch: pytest.MonkeyPatch, width: int) -> None:
    monkeypatch.setattr(options.console, "width", width)
    code, said = drawbar("run", *SHORT, "--out", "out")
    assert code == 0
    assert "…" not in said
    lines = [line for line in said.splitlines() if "report.html" not in line and not re.match(r" *\d+%", line)]
    assert [line for line in lines if len(line) > width] == []
    errors = said.split("error, cm")[1:]
    assert sum(part.split("\n", 1)[0].split().count("rms") for part in errors) == 2


@pytest.mark.parametrize(("encoding", "command"), [("cp1252", "tube"), ("ascii", "run")])
def test_output_that_is_not_utf_8_degrades(tmp_path: Path, encoding: str, command: str) -> None:
    changes = SHORT if command == "run" else ()
    done = subprocess.run(
        [sys.executable, "-m", "drawbar", command, *changes],
        cwd=tmp_path,
        env={**os.environ, "PYTHONIOENCODING": encoding},
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    text = done.stdout.decode(encoding)
    assert ("solver, us" if command == "run" else "K: ") in text


def test_a_report_is_made_again_from_a_log_whole_or_cut(drawbar: Drawbar, tmp_path: Path) -> None:
    assert drawbar("run", *SHORT, "--out", "out")[0] == 0
    first = (tmp_path / "out" / "metrics.json").read_bytes()
    (tmp_path / "out" / "report.html").unlink()
    code, said = drawbar("report", "out")
    assert code == 0
    assert "finished" in said
    assert (tmp_path / "out" / "report.html").exists()
    assert (tmp_path / "out" / "metrics.json").read_bytes() == first
    cut = tmp_path / "cut.mcap"
    whole = (tmp_path / "out" / "log.mcap").read_bytes()
    cut.write_bytes(whole[: len(whole) // 2])
    code, said = drawbar("report", "cut.mcap", "--out", "again")
    assert code == 0
    assert "stopped: the log just stops" in " ".join(said.split())
    assert {file.name for file in (tmp_path / "again").iterdir()} == {"metrics.json", "report.html", "map.svg"}
    assert drawbar("report", "nowhere", "--out", "empty")[0] == 2
    assert not (tmp_path / "empty").exists()
    (tmp_path / "file").touch()
    code, said = drawbar("report", "out", "--out", "file/again")
    assert code == 2
    told = "file/again: the report's metrics.json, report.html, map.svg cannot be written (Not a directory)"
    assert told in " ".join(said.split())


def test_a_run_is_named_by_its_folder_or_by_its_log(drawbar: Drawbar) -> None:
    drawbar("run", *SHORT, "--out", "out")
    for command in (["replay"], ["log", "export", "--csv", "table.csv"]):
        said = [drawbar(*command, run) for run in ("out", "out/log.mcap")]
        assert said[0] == said[1]
        assert said[0][0] == 0
