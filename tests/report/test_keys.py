"""The keys of a configuration are listed whole, as they are declared, and the page of the documentation is current."""

import importlib.util
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from drawbar.config import load_configuration
from drawbar.configurations import shipped_names
from drawbar.report.keys import events, sections

ROOT = Path(__file__).parents[2]


def leaves(data: dict[str, Any], name: str = "") -> Iterator[str]:
    for key, value in data.items():
        if isinstance(value, dict) and not name.endswith(("lqr", "disturbances", "estimation", "increments")):
            yield from leaves(value, f"{name}{key}.")
        else:
            yield f"{name}{key}"


@pytest.mark.parametrize("name", shipped_names())
def test_every_key_of_a_configuration_is_listed_with_its_value(name: str) -> None:
    configuration = load_configuration(name, ["vehicle.wheelbase=1.75"])
    listed = {key.name: key for section in sections(configuration) for key in section.keys}
    maps = ("lqr", "disturbances", "estimation", "increments")
    missing = {
        key
        for key in leaves(configuration.model_dump(mode="json"))
        if key not in listed and not any(f".{each}." in key for each in maps)
    }
    assert not missing
    assert (listed["vehicle.wheelbase"].default, listed["vehicle.wheelbase"].unit) == ("1.75", "m")


def test_units_ranges_and_meanings_are_those_of_the_declarations() -> None:
    keys = {(section.name, section.variant, key.name): key for section in sections() for key in section.keys}
    limit = keys["vehicle", "", "vehicle.tractor_steering_limit"]
    assert (limit.default, limit.unit, limit.allowed) == ("0.5236", "rad", "number > 0, < 1.396")
    assert limit.meaning == "largest |delta_t| that may be commanded"
    horizon = keys["controller", 'model = "tricycle"', "controller.horizon"]
    assert (horizon.default, horizon.allowed) == ("20", "integer ≥ 2, ≤ 200")
    assert keys["", "", "speed"].allowed == "number ≥ 0.05, ≤ 20", "a limit that another one implies is left out"
    assert keys["", "", "acceleration"].unit == "m/s²"
    assert keys["start", "", "start.ahead"].unit == "m"
    widening = keys["controller.sharing", "", "controller.sharing.widening"]
    assert (widening.unit, widening.meaning.partition(":")[0].split()[-1]) == ("m²", "curvature")
    assert keys["actuation", "", "actuation.body_lag_per_speed"].unit == "s²/m"
    assert [key.unit for (_, _, name), key in keys.items() if name == "machine.tractor.mass"] == ["kg"]
    assert keys["", "", "name"].default == ""
    assert "list of number > 0, ≤ 1000" in keys["path", "", "path.radii"].allowed
    assert keys["tube", "", "tube.nominal"].allowed == '"predicted", "propagated", "optimised"'
    assert not [name for name, key in keys.items() if key.allowed.endswith(" of")]
    assert [key.allowed for key in keys.values() if key.name.endswith("pulses_per_metre")] == ["number, or left out"]


def test_a_section_that_may_be_left_out_is_called_one() -> None:
    keys = {key.name: key for section in sections(load_configuration("articulated")) for key in section.keys}
    assert keys["devices"].allowed == "section, or left out"


def test_every_number_has_a_meaning() -> None:
    without = [key.name for section in sections() for key in section.keys if not key.meaning and not key.unit]
    assert not [name for name in without if name.rpartition(".")[2] not in ("model", "kind")]


def test_events_are_the_kinds_that_may_happen() -> None:
    assert [section.variant for section in events()] == [
        f'kind = "{kind}"' for kind in ("slip_step", "side_slope", "bump", "gps_loss", "gps_jump", "gps_float")
    ]


def test_the_page_of_the_documentation_is_what_the_code_says() -> None:
    specification = importlib.util.spec_from_file_location("configuration_page", ROOT / "docs/configuration_page.py")
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    assert module.PAGE.read_text("utf-8") == module.page(), "run python docs/configuration_page.py"
