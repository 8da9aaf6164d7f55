"""The tutorial's examples run, do what the tutorial says, and are what the tutorial shows; other scripts run."""

import importlib.util
import itertools
import math
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import casadi as ca
import numpy as np
import pytest

from drawbar import build_autopilot, build_path, drive, read_log, replay
from drawbar.errors import DrawbarError
from drawbar.geometry import Floats, nearest_branch
from drawbar.optimal import ControlSolver, EstimationSolver
from drawbar.signals import Measurement, SolverStatus
from drawbar.vehicle.integrators import integrate

ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "examples" / "own_vehicle.py"
PAGES = {
    ROOT / "docs" / "tutorial.md": (EXAMPLE, ROOT / "examples" / "pid_controller.py"),
    ROOT / "docs" / "tutorial-constraints.md": (ROOT / "examples" / "crane.py", ROOT / "examples" / "two_trailers.py"),
}
"""the scripts that each page explains, in its order"""
TOLD = [(page, place) for page, scripts in PAGES.items() for place in range(len(scripts))]
SETTLED = slice(100, None)
"""samples after 10 s"""


def _imported(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module  # where dataclasses look themselves up
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def example() -> ModuleType:
    return _imported(EXAMPLE)


@pytest.fixture(scope="module", params=range(5), ids="seed {}".format)
def record(example: ModuleType, request: pytest.FixtureRequest) -> Floats:
    record: Floats = example.run(seconds=60.0, seed=request.param)
    return record


def test_settles_on_the_circle(record: Floats) -> None:
    distance = np.abs(record[SETTLED, 0])
    assert record[0, 0] == 1.5
    assert distance.mean() < 0.01
    assert distance.max() < 0.04


def test_steers_at_the_bound_first_and_never_beyond(example: ModuleType, record: Floats) -> None:
    steering = np.abs(record[:, 3])
    assert (steering <= example.LIMIT + 1e-9).all()
    assert (steering[:10] > example.LIMIT - 1e-6).all()
    assert (steering[SETTLED] < example.LIMIT / 2).all()


def test_finds_out_heading_and_offset(record: Floats) -> None:
    _, yaw, offset, _ = record[SETTLED].T
    assert np.sqrt(np.mean(yaw**2)) < np.radians(0.4)
    assert np.sqrt(np.mean(offset**2)) < np.radians(0.15)


def on_the_circle(example: ModuleType, estimator: EstimationSolver, samples: range, wrong: dict[int, float]) -> Floats:
    """Let an estimator watch a robot that drives the circle exactly; return by how much it is off, m."""
    speed, offset, errors = *example.TRUTH, []
    for sample in samples:
        angle = speed * example.SAMPLE_TIME / example.RADIUS * sample
        east, north = example.RADIUS * np.array([np.cos(angle), np.sin(angle)])
        yaw = nearest_branch(angle + np.pi / 2, estimator.x[estimator.newest, 2])
        estimator.y[estimator.newest, :4] = wrong.get(sample, east), north, yaw + offset, speed
        estimator.feedback()
        errors.append(np.hypot(*(estimator.x[estimator.newest, :2] - (east, north))))
        estimator.y[estimator.newest, 4] = np.arctan(example.WHEELBASE / example.RADIUS)
        estimator.advance()
    return np.array(errors)


@pytest.fixture(scope="module")
def at_the_start(example: ModuleType) -> Floats:
    return np.array([example.RADIUS, 0.0, np.pi / 2, *example.TRUTH])


@pytest.mark.parametrize("wrong", [1e4, 1e8, -1e10, 1e12])
def test_a_wrong_reading_loses_the_robot_until_a_restart(
    example: ModuleType, at_the_start: Floats, wrong: float
) -> None:
    estimator = EstimationSolver(example.ESTIMATION, at_the_start)
    # where a lost estimate wanders to is rounding's, and so the compiler's
    assert on_the_circle(example, estimator, range(300), {50: wrong})[-50:].mean() > 0.2 * example.RADIUS
    fresh = EstimationSolver(example.ESTIMATION, at_the_start)
    assert estimator.restart(at_the_start) == SolverStatus.SOLVED
    for each in (estimator, fresh):
        assert on_the_circle(example, each, range(100), {}).max() < 1e-4
    np.testing.assert_array_equal(estimator.x, fresh.x)
    np.testing.assert_array_equal(estimator.root, fresh.root)


@pytest.mark.parametrize("wrong", [np.nan, 1.001e12, -np.inf])
def test_a_reading_that_is_missing_or_refused_does_no_harm(
    example: ModuleType, at_the_start: Floats, wrong: float
) -> None:
    estimator = EstimationSolver(example.ESTIMATION, at_the_start)
    assert on_the_circle(example, estimator, range(300), {50: wrong}).max() < 1e-3


@pytest.mark.parametrize(("page", "place"), TOLD, ids=[PAGES[page][place].stem for page, place in TOLD])
def test_prints_what_the_tutorial_shows(page: Path, place: int) -> None:
    script = PAGES[page][place]
    printed = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True).stdout
    shown = re.findall(r"```text\n(.*?)```", page.read_text("utf-8"), re.DOTALL)
    assert len(shown) == len(PAGES[page])
    assert_alike(printed, shown[place])


def assert_alike(printed: str, shown: str) -> None:
    """Compare words, and numbers up to their last digits."""
    for ours, theirs in zip(printed.split(), shown.split(), strict=True):
        try:  # compilers round the last digits differently
            value, last_digit = float(theirs.strip("[]")), 10.0 ** -len(theirs.strip("[]").partition(".")[2])
            assert float(ours.strip("[]")) == pytest.approx(value, abs=2.0 * last_digit)
        except ValueError:
            assert ours == theirs


@pytest.mark.parametrize("page", PAGES, ids=[page.stem for page in PAGES])
def test_the_tutorial_quotes_the_examples(page: Path) -> None:
    blocks = re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL)
    sources = [script.read_text("utf-8") for script in PAGES[page]]
    assert blocks
    for block in blocks:
        assert any(block in source for source in sources), block
    for source in sources:
        assert any(block in source for block in blocks)


def test_the_recorded_lines_are_those_that_the_script_drives(tmp_path: Path) -> None:
    script = ROOT / "examples" / "record_field.py"
    subprocess.run([sys.executable, script, tmp_path], check=True)
    files = [file.relative_to(tmp_path) for file in tmp_path.rglob("*.*")]
    assert len(files) == 3
    for file in files:
        (words, numbers), (kept_words, kept) = (
            parts((folder / file).read_text("utf-8")) for folder in (tmp_path, script.parent)
        )
        assert words == kept_words, file
        assert numbers == pytest.approx(kept, abs=1e-9), file  # other C libraries round a sine otherwise


def parts(text: str) -> tuple[list[str], list[float]]:
    """Return what stands between the decimal numbers of a text, and the numbers."""
    found = re.split(r"(-?\d+\.\d+(?:e-?\d+)?)", text)
    return found[::2], [float(each) for each in found[1::2]]


def test_another_seed_drives_other_lines(tmp_path: Path) -> None:
    script = ROOT / "examples" / "record_field.py"
    subprocess.run([sys.executable, script, tmp_path, "1"], check=True)
    assert (tmp_path / "brook.csv").read_text("utf-8") != (script.parent / "brook.csv").read_text("utf-8")


@pytest.mark.parametrize("seed", range(3))
def test_the_crane_sets_its_load_down_at_rest_and_within_its_bounds(seed: int) -> None:
    crane = _imported(ROOT / "examples" / "crane.py")
    load, sway, sway_error, rope_error, push = crane.run(seconds=30.0, seed=seed).T
    assert np.abs(load[-50:] - crane.TARGET).max() < 0.03
    assert np.abs(sway[-50:]).max() < np.radians(0.3)
    assert np.abs(sway[crane.LISTENED :]).max() < crane.HELD + np.radians(0.3)
    assert load.max() < crane.WALL + 0.02
    assert np.abs(sway_error[50:]).max() < np.radians(0.3)
    assert np.abs(rope_error[50:]).max() < 0.25
    assert np.abs(np.diff(push)).max() <= 0.1 + 1e-7


def test_the_cranes_controller_is_never_without_a_solution() -> None:
    crane = _imported(ROOT / "examples" / "crane.py")
    controller, model = ControlSolver(crane.CONTROL), crane.CONTROL.model
    world = ca.Function("world", [model.x, model.u, model.p], [integrate(model, crane.CONTROL.sample_time, 4)])
    controller.y[:, [0, 3]], controller.p[:], state = crane.TARGET, [4.0, 0.0], np.zeros(len(model.states))
    controller.initial[:] = state
    controller.start()
    for _ in range(100):  # hard bounds on the load and soft ones on the sway, which are states without a cost
        controller.initial[:] = state
        assert controller.feedback() == SolverStatus.SOLVED
        state = np.array(world(state, controller.u[0].copy(), controller.p[0])).ravel()
        controller.advance()


def test_the_road_train_reverses_to_the_line_without_folding_up() -> None:
    example = _imported(ROOT / "examples" / "two_trailers.py")
    _, north, *joints, front, steering = example.run(seconds=40.0).T
    assert np.abs(north[-20:]).max() < 0.01
    assert np.abs(joints).max() < example.FOLDED
    assert front.min() == pytest.approx(-example.LANE, abs=0.01), "the bound is in the way, and kept"
    assert np.abs(np.diff(steering)).max() <= example.RATE * example.SAMPLE_TIME + 1e-7


def test_other_tools_find_what_drawbar_finds() -> None:
    example = _imported(ROOT / "examples" / "side_by_side.py")
    truth, _ = example.run(example.with_casadi(), 25)
    assert np.abs(np.diff(truth)).max() == pytest.approx(example.CHANGE, abs=1e-6), "the bound is in the way"
    for converged, tolerance in ((True, 1e-6), (False, 1e-3)):
        steering, _ = example.run(example.with_drawbar(converged=converged), 25)
        np.testing.assert_allclose(steering, truth, rtol=0.0, atol=tolerance)


def test_do_mpc_finds_what_drawbar_finds() -> None:
    pytest.importorskip("do_mpc")
    example = _imported(ROOT / "examples" / "side_by_side.py")
    steering, _ = example.run(example.with_do_mpc(), 25)
    truth, _ = example.run(example.with_drawbar(converged=True), 25)
    np.testing.assert_allclose(steering, truth, rtol=0.0, atol=1e-6)


OWN_MACHINE, ITS_PAGE = ROOT / "examples" / "own_machine.py", ROOT / "docs" / "own-machine.md"


def test_the_own_machine_is_driven_logged_and_replayed_as_its_page_shows(tmp_path: Path) -> None:
    printed = subprocess.run([sys.executable, OWN_MACHINE, tmp_path], capture_output=True, text=True, check=True).stdout
    (shown,) = re.findall(r"```text\n(.*?)```", ITS_PAGE.read_text("utf-8"), re.DOTALL)
    assert_alike(printed.replace(str(tmp_path), "runs/own-machine"), shown)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["log.mcap", "map.svg", "metrics.json", "report.html"]
    assert replay(read_log(tmp_path / "log.mcap")).differences == ()


@pytest.mark.parametrize("seed", range(3))
def test_the_own_machine_truly_stays_on_its_line_and_is_stopped(seed: int) -> None:
    example = _imported(OWN_MACHINE)
    machine, autopilot = example.OwnMachine(seed), build_autopilot(example.CONFIGURATION)
    path, _ = build_path(example.CONFIGURATION)
    autopilot.begin(path)
    places = np.array([machine.state[:2] for _ in drive(machine, autopilot, time_limit=120.0)])
    _, errors = path.project_track(*places.T, 0.0, behind=1.0, ahead=3.0)
    assert np.abs(errors).max() < 0.08
    assert machine.clock == pytest.approx(7060.0, abs=3.0)
    assert machine.wanted[2] == 0.0


def _end_of(alter: Callable[[Measurement, int], Any]) -> DrawbarError:
    """Return with what a drive of the own machine ends whose measurements are altered, given how many there were."""
    example, count = _imported(OWN_MACHINE), itertools.count()

    class Altered(example.OwnMachine):  # type: ignore[misc,name-defined]
        def read(self) -> Any:
            return alter(super().read(), next(count))

    path, autopilot = build_path(example.CONFIGURATION)[0], build_autopilot(example.CONFIGURATION)
    autopilot.begin(path)
    with pytest.raises(DrawbarError) as raised:
        list(drive(Altered(), autopilot, time_limit=60.0))
    return raised.value


def _row(begins: str) -> str:
    """Return what the page's table says of a machine."""
    (row,) = (line for line in ITS_PAGE.read_text("utf-8").splitlines() if line.startswith(f"| {begins}"))
    return row


NAN = math.nan
FAILS: dict[str, Callable[[Measurement, int], Any]] = {
    "returns anything but a": lambda measurement, count: None,
    "returns a text": lambda measurement, count: replace(measurement, speed="1.0"),
    "has no position": lambda measurement, count: replace(measurement, tractor_x=NAN),
    "repeats a time stamp": lambda measurement, count: replace(measurement, time=7000.0 + 0.2 * min(count, 20)),
    "reports steering angles": lambda measurement, count: replace(
        measurement, tractor_steering=-measurement.tractor_steering
    ),
}


@pytest.mark.parametrize("row", FAILS)
def test_the_page_names_the_error_of_a_machine_that_fails(row: str) -> None:
    assert f"`{type(_end_of(FAILS[row])).__name__}`" in _row(row)


def test_the_page_says_how_long_is_driven_without_a_fix() -> None:
    end = _end_of(
        lambda measurement, count: replace(measurement, tractor_x=NAN, trailer_x=NAN) if count else measurement
    )
    limits = re.findall(r"limits are (\d+ s), .* of ([\d.]+ m)", str(end))[0]
    assert all(limit in _row("reports NaN later on") for limit in (*limits, "`RunAborted`"))


def test_the_page_quotes_the_own_machine() -> None:
    blocks = re.findall(r"```python\n(.*?)```", ITS_PAGE.read_text("utf-8"), re.DOTALL)
    assert len(blocks) == 5
    assert all(block in OWN_MACHINE.read_text("utf-8") for block in blocks)


def test_the_comparison_quotes_its_program() -> None:
    source = (ROOT / "examples" / "side_by_side.py").read_text("utf-8")
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "side-by-side.md").read_text("utf-8"), re.DOTALL)
    assert len(blocks) == 4
    for block in blocks:
        assert block in source
