"""Ranges on the command line: what is read is what is searched, and what is wrong is told."""

import tomllib
from pathlib import Path

import pytest

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.experiment.tuning.parameters import read_space, to_toml


def test_ranges_are_read_with_the_configurations_own_values() -> None:
    texts = ["guidance.look_ahead=0.4..3 controller.steering_weight=1e-1..2e2:log", "controller.horizon=5..30"]
    space = read_space("paper", ["guidance.look_ahead=1.2"], texts)
    read = [(one.key, one.low, one.high, one.log, one.own, one.whole) for one in space.parameters]
    assert read == [
        ("guidance.look_ahead", 0.4, 3.0, False, 1.2, False),
        ("controller.steering_weight", 0.1, 200.0, True, 10.0, False),
        ("controller.horizon", 5, 30, False, 20, True),
    ]
    assert [str(one) for one in read_space("paper", [], list(map(str, space.parameters))).parameters] == list(
        map(str, space.parameters)
    )


def test_values_end_up_where_their_keys_are() -> None:
    space = read_space("paper", ["speed=0.8"], ["guidance.look_ahead=0.4..3.0", "controller.horizon=5..30"])
    configuration = space.with_values({"guidance.look_ahead": 1e-05 + 0.5, "controller.horizon": 7})
    assert (configuration.guidance.look_ahead, configuration.controller.horizon) == (0.50001, 7)
    assert (configuration.speed, configuration.name) == (0.8, "paper")
    assert space.with_values(space.own) == load_configuration("paper", ["speed=0.8"])


def test_values_as_toml_are_a_configuration(tmp_path: Path) -> None:
    values = {"controller.tractor.heading": 33.0, "controller.horizon": 18, "controller.tractor.lateral": 20.0}
    assert tomllib.loads(to_toml(values)) == {
        "controller": {"horizon": 18, "tractor": {"heading": 33.0, "lateral": 20.0}}
    }
    (tmp_path / "mine.toml").write_text(f'extends = "articulated"\nname = "mine"\n\n{to_toml(values)}', "utf-8")
    weights = load_configuration(str(tmp_path / "mine.toml")).controller.tractor
    own = load_configuration("articulated").controller.tractor
    assert (weights.heading, weights.lateral, weights.steering_rate) == (33.0, 20.0, own.steering_rate)


WRONG = {
    "": "nothing to search",
    "guidance.look_ahead": "give KEY=LOW..HIGH",
    "guidance.look_ahead=1.0": "give KEY=LOW..HIGH",
    "guidance.look_ahead=1.0..x": "give KEY=LOW..HIGH",
    "guidance.look_ahead=1.0..2.0:logarithmic": "give KEY=LOW..HIGH",
    "guidance.look_ahead=3.0..0.4": "3 is not below 0.4",
    "guidance.look_ahead=0.0..3.0:log": "needs limits above 0",
    "guidance.look_ahead=2.0..3.0": "own value, 1.6, is outside",
    "guidance.look_ahed=0.4..3.0": "guidance has no key look_ahed (did you mean look_ahead?); its keys are: mode",
    "guidanse.look_ahead=0.4..3.0": "the configuration has no key guidanse (did you mean guidance?); its keys",
    "speed.look_ahead=0.4..3.0": "speed has no key look_ahead; it is a value",
    "guidance.mode=1..2": "is 'look_ahead', and no number",
    "guidance=1..2": "and no number",
    "tube.tighten=0..1": "is True, and no number",
    "controller.horizon=10.5..30": "10.5 is no whole number",
    "guidance.look_ahead=-1.0..3.0": "does not allow -1.\n",
    "controller.horizon=1..30": "does not allow 1.\n",
    "speed=0.5..99.0": "does not allow 99.\n",
    "speed=0.5..1.5 speed=0.6..1.4": "speed given twice",
}


@pytest.mark.parametrize("text", WRONG)
def test_what_is_wrong_is_reported(text: str) -> None:
    with pytest.raises(ConfigurationError) as error:
        read_space("paper", [], [text])
    assert WRONG[text] in str(error.value)
    assert str(error.value).startswith("--parameters")
