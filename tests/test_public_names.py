"""What `import drawbar` offers is there, and nothing heavy is imported for the rest."""

import subprocess
import sys
from functools import cache

import pytest

import drawbar
from drawbar.errors import ConfigurationError, DrawbarError, StorageError
from drawbar.simulation import build_path

CONFIGURATION = drawbar.load_configuration("articulated")


@pytest.mark.parametrize("name", drawbar.__all__)
def test_every_name_is_there(name):
    assert getattr(drawbar, name).__module__.startswith("drawbar.")
    assert name in dir(drawbar)


def test_a_name_that_is_not_there_tells_which_are():
    with pytest.raises(AttributeError, match="has no attribute 'simulat'; it offers Autopilot, Bound"):
        drawbar.simulat  # noqa: B018


def test_the_import_alone_loads_no_library():
    program = "import drawbar, sys; print({'casadi', 'numpy', 'scipy', 'pydantic', 'plotly'} & set(sys.modules))"
    assert (
        subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout == "set()\n"
    )


@pytest.mark.parametrize("seed", [-1, 1.5, "0"])
def test_a_seed_that_is_none_is_refused(seed):
    with pytest.raises(ConfigurationError, match=rf"seed = {seed!r} is not allowed; give a whole number"):
        drawbar.simulate(drawbar.load_configuration("articulated"), seed=seed)


def test_files_and_folders_are_named_by_texts_too(tmp_path):
    for ask in (drawbar.read_log, drawbar.write_report):
        with pytest.raises(DrawbarError, match=r"none.*cannot be read"):
            ask(str(tmp_path / "none"))
    header = drawbar.Simulation(CONFIGURATION).header()
    with pytest.raises(StorageError, match="cannot be written"):
        drawbar.Recorder(str(tmp_path / "none" / "log.mcap"), header)


@cache
def _log():
    return drawbar.simulate(CONFIGURATION)


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("estimate.tractr.x", r"estimate has no 'tractr' \(did you mean tractor\?\); it has .*trailer"),
        ("estimate.speed.x", "estimate.speed has no 'x'; it is a number itself"),
        ("estimate.tractor", "it is no number; give one of its x, y, yaw"),
        ("", "a step has no ''; it has step, "),
        (3, "name must be a str, got 3"),
    ],
)
def test_a_column_that_is_none_tells_what_there_is(name, told):
    with pytest.raises(DrawbarError, match=told):
        _log().column(name)


WRONG_ARGUMENTS = {
    "a name instead of a configuration": (
        lambda: drawbar.simulate("articulated"),
        "got 'articulated'; give what load_con",
    ),
    "no configuration": (lambda: drawbar.Simulation(None), "configuration must be a Configuration, got None"),
    "no configuration of an autopilot": (lambda: drawbar.build_autopilot({}), "configuration must be a Configuration"),
    "no configuration of a path": (lambda: build_path(3), "configuration must be a Configuration, got 3"),
    "a file instead of a path": (
        lambda: drawbar.Simulation(CONFIGURATION, path="a.csv"),
        "path must be a Path, got 'a.c",
    ),
    "a file instead of a log": (lambda: drawbar.replay("runs/log.mcap"), "log must be a RunLog.*read_log"),
    "no name of a configuration": (lambda: drawbar.load_configuration(None), "source must be the name of a file"),
    "changes that are one text": (
        lambda: drawbar.load_configuration("paper", "speed=1.0"),
        "changes must be texts KEY",
    ),
    "changes of a replay that are one text": (
        lambda: drawbar.replay(_log(), "speed=1.0"),
        "changes must be texts KEY",
    ),
    "changes that are none": (lambda: drawbar.load_configuration("paper", [("speed", 1)]), "changes must be texts KEY"),
    "no changes": (lambda: drawbar.load_configuration("paper", None), "changes must be texts KEY=VALUE, got None"),
    "no name of a log": (lambda: drawbar.read_log(3), "file must be the name of a file or folder, got 3"),
    "no name of a folder": (lambda: drawbar.write_report(None), "folder must be the name of a file or folder"),
    "no name of a new log": (lambda: drawbar.Recorder(None, None), "file must be the name of a file"),
    "no header": (lambda: drawbar.Recorder("never.mcap", CONFIGURATION), "header must be a RunHeader"),
    "no machine": (lambda: next(drawbar.drive(None, None, time_limit=1.0)), "machine must be a Machine, got None"),
    "no configuration of a header": (lambda: drawbar.run_header(None, None, None), "configuration must be a Config"),
    "no path of a header": (lambda: drawbar.run_header(CONFIGURATION, None, None), "path must be a Path, got None"),
    "no measurement": (
        lambda: drawbar.build_autopilot(CONFIGURATION).feedback(None),
        "Measurement is needed, got None",
    ),
    "no estimate": (lambda: drawbar.build_autopilot(CONFIGURATION).give({}), "Estimate is needed, got {}"),
    "no number of a speed": (lambda: drawbar.build_autopilot(CONFIGURATION).set_speed("1"), "speed must be a number"),
    "a speed that is none": (
        lambda: drawbar.build_autopilot(CONFIGURATION).set_speed(float("nan")),
        "speed = nan m/s is not allowed",
    ),
    "no place to begin at": (
        lambda: drawbar.build_autopilot(CONFIGURATION).begin(build_path(CONFIGURATION)[0], at=None),
        "at must be a number, got None",
    ),
    "no model": (
        lambda: drawbar.ControlProblem(model=None, horizon=3, sample_time=0.1, weights={}, terminal_weights={}),
        "model must be a Model, got None",
    ),
}


@pytest.mark.parametrize("case", WRONG_ARGUMENTS)
def test_an_argument_of_another_type_is_refused_by_its_name(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ask, told = WRONG_ARGUMENTS[case]
    with pytest.raises(DrawbarError, match=told):
        ask()
    assert not list(tmp_path.iterdir())


def test_a_file_may_be_named_by_bytes(tmp_path):
    with pytest.raises(DrawbarError, match=r"none.*cannot be read"):
        drawbar.read_log(bytes(tmp_path / "none"))


@pytest.mark.parametrize("limit", [None, "1", 0.0, -1.0, float("nan")])
def test_a_time_limit_that_is_none_is_refused(limit):
    with drawbar.Simulation(CONFIGURATION) as simulation, pytest.raises(DrawbarError, match=r"time_limit = .* seconds"):
        next(drawbar.drive(simulation.machine, simulation.autopilot, time_limit=limit))


def test_a_step_that_was_not_cannot_be_recorded():
    with pytest.raises(DrawbarError, match=r"call feedback\(\) first"):
        drawbar.build_autopilot(CONFIGURATION).record()
