"""`drawbar tube` as its user sees it."""

import io
import tomllib

import pytest
from rich.cells import cell_len
from rich.console import Console

from drawbar.config import load_configuration
from drawbar.control.tube.tube import bodies_of
from drawbar.errors import ConfigurationError, DrawbarError
from drawbar.recording.log import read_log
from drawbar.recording.recorder import Recorder
from drawbar.report.tube.command import show_tubes
from drawbar.report.tube.recorded import findings, recordings
from drawbar.simulation import Simulation
from drawbar.step.build import operating_conditions

SHORT = ("path.radii=[8.0]", "path.straight_length=1.0")


@pytest.fixture(scope="session")
def log(tmp_path_factory):
    """Return the log of a short run of the product, seed 0."""
    config = load_configuration("articulated", [*SHORT, "actuation.identify=false"])
    file = tmp_path_factory.mktemp("tube") / "log.mcap"
    simulation = Simulation(config)
    with Recorder(file, simulation.header()) as recorder:
        for record in simulation.steps():
            recorder.write(record)
    return file


@pytest.fixture
def tube(tmp_path):
    """Return a function that runs the command: whether something is left of every bound, and what was printed."""

    def tube(name, *changes, logs=()):
        console = Console(file=io.StringIO(), width=80, highlight=False, markup=False)
        left = show_tubes(console, load_configuration(name, changes), tmp_path / "out", logs)
        return left, console.file.getvalue()

    return tube


def test_sets_bounds_and_sources_are_printed_and_drawn(tube, tmp_path):
    left, said = tube("articulated")
    assert left
    words = ("seen error", "true error", "steering rate", "tractor yaw rate", "operating point", "left", "Not declared")
    assert all(word in said for word in words)
    assert max(map(cell_len, said.splitlines()[:-1])) <= 80
    assert {file.name for file in (tmp_path / "out").iterdir()} == {"tube.html", "tube-tractor.svg", "tube-trailer.svg"}
    page = (tmp_path / "out" / "tube.html").read_text("utf-8")
    for said in ("plans as if nothing disturbed", "what is left for the plan", "Seen error: of the estimate"):
        assert said in page
    assert page.count("<svg") == 2
    assert "http" not in page.replace("http://www.w3.org/2000/svg", "")  # nothing is fetched


def test_a_steering_rate_that_counts_as_more_than_declared_is_reported(tube):
    slow = ("sample_time=0.1", "vehicle.steering_lag=0.13", "vehicle.tractor_steering_rate=0.12")
    left, said = tube("articulated", *slow)
    assert left
    assert "disturbances.steering_rate counts as 0.353 rad/s instead of 0.18" in " ".join(said.split())
    assert "counts as" not in tube("articulated")[1]


def test_a_missing_log_is_refused_before_anything_is_printed(tmp_path, capsys):
    with pytest.raises(DrawbarError, match=r"missing\.mcap: cannot be read"):
        show_tubes(Console(), load_configuration("articulated"), tmp_path / "out", [tmp_path / "missing.mcap"])
    assert capsys.readouterr().out == ""


def test_a_gain_on_yaw_alone_says_plainly_what_has_no_bound(tube):
    left, said = tube(
        "paper", "tube.nominal=propagated", "tube.tractor.disturbances={yaw_rate=0.05, lateral_rate=0.05}"
    )
    assert left
    assert "unbounded" in said
    assert "No bound: lateral. With this K nothing brings such an error back" in " ".join(said.split())
    assert "No bounds are declared: there is no set" in " ".join(said.split())  # of the trailer


def test_where_nothing_is_left_it_says_what_to_reduce(tube, tmp_path):
    left, said = tube("paper", "tube.trailer.disturbances={coupling=0.6}")
    assert not left
    assert "nothing (" in said
    assert "disturbances.coupling takes most: reduce it from 0.6 to below" in " ".join(said.split())
    assert "nothing left of 20°" in (tmp_path / "out" / "tube-trailer.svg").read_text("utf-8")


def test_a_log_is_held_against_the_declared_bounds(tube, log):
    left, said = tube("articulated", "tube.tractor.disturbances.tractor_crab=0.002", logs=[log, log])
    assert left
    assert "Violated: disturbances.tractor_crab" in said
    assert "None is violated." in said  # of the trailer
    assert max(map(cell_len, said.splitlines()[:-1])) <= 80
    proposed = tomllib.loads(said[said.index("[tube.") : said.rindex("\n\n")])["tube"]
    assert proposed.keys() == {"tractor", "trailer"}
    assert proposed["tractor"].keys() == {"disturbances", "estimation", "increments"}
    assert 0.002 < proposed["tractor"]["disturbances"]["tractor_crab"] < 0.1


def test_proposed_bounds_are_violated_by_nothing_in_their_log(tube, log, tmp_path):
    _, said = tube("articulated", logs=[log])
    own = tmp_path / "own.toml"
    own.write_text('extends = "articulated"\n' + said[said.index("[tube.") : said.rindex("\n\n")], "utf-8")
    _, said = tube(str(own), logs=[log])
    assert said.count("None is violated.") == 2


def magnitudes(file):
    """Return what a log shows of each bound of the tractor, one number a sample."""
    config = load_configuration("articulated")
    body = bodies_of(config.controller, operating_conditions(config), config.tube)[0]
    recorded = recordings(file, read_log(file), config, "tractor", body.model)
    return {(each.section, each.name): each.magnitudes for each in findings(recorded, body, config.tube.tractor)}


def test_a_log_that_lacks_steps_says_so_and_what_is_beside_a_gap_counts_as_no_step(tube, log, tmp_path):
    content, file = read_log(log), tmp_path / "gaps.mcap"
    with Recorder(file, content.header) as recorder:
        for record in content.records:
            if record.step % 50 not in (20, 21, 22):
                recorder.write(record)
    assert f"{file}: steps 20 to 22 are lost" in tube("articulated", logs=[file])[1].replace("\n", " ")
    whole, of_gaps = magnitudes(log), magnitudes(file)
    assert of_gaps.keys() == whole.keys()
    for name, values in of_gaps.items():
        assert len(values) > 0.8 * len(whole[name])
        assert set(values) <= set(whole[name]), name


def test_a_log_of_another_controller_is_refused(tube, log):
    with pytest.raises(DrawbarError, match=r"was driven with controller\.model = 'articulated'"):
        tube("paper", logs=[log])


def test_a_controller_without_nominal_state_has_no_tube(tube):
    with pytest.raises(ConfigurationError, match="'lqr' follows no nominal state"):
        tube("articulated", "controller.model=lqr")


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (("articulated",), 0, "Not declared"),
        (("paper", "--set", "tube.trailer.disturbances={coupling=0.6}"), 1, "takes most"),
        (("articulated", "--set", "tube.tractor.disturbances.sway=0.1"), 2, "tube.tractor.disturbances has no sway"),
        (("articulated", "--from-log", "nothing.mcap"), 2, "nothing.mcap: cannot be read"),
    ],
)
def test_the_command_line_says_by_its_exit_code_whether_there_is_a_tube(
    arguments, code, said, drawbar, monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)
    ended, text = drawbar("tube", *arguments, "--out", "out")
    assert ended == code
    assert said in text
