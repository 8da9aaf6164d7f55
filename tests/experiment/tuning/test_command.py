"""`drawbar tune` as its user sees it: what it drives, what it leaves, and what it says when it cannot."""

import csv
import re
import tomllib
from contextlib import nullcontext
from functools import partial
from pathlib import Path

import pytest
from distributed import Client
from rich.console import Console
from short_run import Drawbar

from drawbar.config import TuningSettings
from drawbar.errors import DrawbarError
from drawbar.experiment.cluster import Failure
from drawbar.experiment.measure import Runs
from drawbar.experiment.task import Result
from drawbar.experiment.tuning import command
from drawbar.experiment.tuning.command import study_name
from drawbar.experiment.tuning.parameters import read_space
from drawbar.experiment.tuning.trials import Driver, objectives

SHORT = ("path.radii=[5.0]", "path.straight_length=1.0")
CHANGES = (*SHORT, "tuning.seeds=1", "tuning.fresh_seeds=2")
RANGES = "guidance.look_ahead=0.8..2.0 controller.steering_weight=5..20:log"


@pytest.fixture
def drawbar(drawbar: Drawbar, cluster: Client, monkeypatch: pytest.MonkeyPatch) -> Drawbar:
    """Return a function that tunes on the session's cluster: exit code, and what it said."""
    monkeypatch.setattr(command, "open_cluster", lambda address, jobs: nullcontext(cluster))
    return partial(drawbar, "tune")


def runs_in(folder: Path) -> set[str]:
    return {file.name for file in folder.glob(".runs/*/*.msgpack")}


def test_a_search_leaves_its_report_and_goes_on_from_it(drawbar: Drawbar, tmp_path: Path) -> None:
    changes = [text for change in CHANGES for text in ("--set", change)]
    # two ranges behind one option, as the shell hands them over without quotes
    arguments = ("paper", *changes, "--parameters", *RANGES.split(), "--out", str(tmp_path))
    code, said = drawbar(*arguments, "--trials", "2")
    assert code == 0, said
    assert "Own values: error " in said
    report = (tmp_path / "results.md").read_text("utf-8")
    assert f"--parameters '{RANGES}' --trials 2 --seed 0`".replace("2.0 ", "2 ") in report
    assert {"front.svg", "parameters.svg", "front.csv", "parameters.csv"} < {file.name for file in tmp_path.iterdir()}
    with (tmp_path / "front.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert (rows[0]["trial"], rows[0]["guidance.look_ahead"], rows[0]["controller.steering_weight"]) == (
        "own",
        "1.6",
        "10",
    )
    for snippet in re.findall(r"```toml\n(.*?)```", report, re.DOTALL):
        assert {"look_ahead"} == tomllib.loads(snippet)["guidance"].keys()
    driven = runs_in(tmp_path)
    assert len(driven) >= 2 + 2
    assert drawbar(*arguments, "--trials", "2")[0] == 0
    assert runs_in(tmp_path) == driven
    assert (tmp_path / "results.md").read_text("utf-8") == report


def test_an_interrupt_is_reported(drawbar: Drawbar, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Driver, "scores", interrupted)
    code, said = drawbar("paper", "--parameters", RANGES, "--out", str(tmp_path))
    assert code == 130
    assert "the same command continues" in said


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("paper",), "nothing to search"),
        (("paper", "--parameters", "guidance.look_ahed=1..2"), "guidance has no key look_ahed"),
        (("paper", "--parameters", RANGES, "--jobs", "2", "--cluster", "tcp://127.0.0.1:1"), "--jobs 2 and --cluster"),
        (("paper", "--parameters", RANGES, "--out", "/dev/null/x"), "choose another --out folder"),
    ],
)
def test_what_is_wrong_is_reported(drawbar: Drawbar, arguments: tuple[str, ...], message: str) -> None:
    code, said = drawbar(*arguments)
    assert code == 2
    assert message in said


def test_a_study_is_its_configurations_its_ranges_and_its_seeds_alone() -> None:
    space = read_space("paper", CHANGES, [RANGES])
    name = study_name(space, 0)
    assert name == study_name(read_space("paper", [*CHANGES, "tuning.fresh_seeds=9"], [RANGES]), 0)
    others = [("tuning.seeds=3", RANGES, 0), ("tuning.error=max", RANGES, 0), ("speed=0.9", RANGES, 0)]
    others += [("speed=1.0", f"{RANGES} speed=0.5..1.5", 0), ("speed=1.0", RANGES, 1)]
    names = {study_name(read_space("paper", [*CHANGES, change], [text]), seed) for change, text, seed in others}
    assert len(names | {name}) == 6


@pytest.fixture
def driver(cluster: Client, tmp_path: Path) -> Driver:
    space = read_space(
        "articulated", CHANGES, ["tube.tractor.lateral=-2.0..0.0 vehicle.tractor_steering_limit=0.1..0.6"]
    )
    return Driver(client=cluster, folder=tmp_path, console=Console(quiet=True), space=space)


def test_values_that_cannot_be_built_or_are_not_allowed_fail_and_harm_no_other(driver: Driver) -> None:
    unstable = {"tube.tractor.lateral": 40.0}
    beyond_the_stop = {"vehicle.tractor_steering_limit": 1.3}
    good, empty, refused = driver.scores([(1, driver.space.own), (2, unstable), (3, beyond_the_stop)])
    assert not isinstance(good, Failure)
    assert 0.0 < good.error < 0.1
    assert 0.0 < good.effort < 0.5
    assert isinstance(empty, Failure)
    assert isinstance(refused, Failure)
    assert "mechanical stop" in refused.reason


def test_a_configuration_that_cannot_be_driven_as_it_is_ends_the_search(driver: Driver) -> None:
    with pytest.raises(DrawbarError, match="articulated: cannot be driven as it is"):
        driver.scores([(0, {"tube.tractor.lateral": 40.0})])


def test_a_run_that_failed_by_chance_is_not_held_against_its_values(
    driver: Driver, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("drawbar.experiment.measure.source_digest", lambda: "another")
    with pytest.raises(DrawbarError, match=r"trial 4, seed 0: .*another version.* The same command continues"):
        driver.scores([(4, driver.space.own)])


def test_what_is_made_small_is_the_mean_of_both_bodies(short_result: Result) -> None:
    metrics = short_result.metrics
    for statistic in ("mean", "rms", "max"):
        found = objectives(Runs(results=[short_result], failures=[]), TuningSettings(error=statistic))
        bodies = [getattr(body["all"], statistic) for body in (metrics.error_m.tractor, metrics.error_m.trailer)]
        assert found.error[0] == pytest.approx(sum(bodies) / 2.0)
    rate = metrics.steering_rate_mean_rad_s
    assert found.effort[0] == pytest.approx((rate.tractor + rate.trailer) / 2.0)
    assert found.given_up == 0
