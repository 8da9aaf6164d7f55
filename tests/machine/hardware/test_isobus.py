"""Settings of an ISOBUS: what they build, and what they refuse."""

import tomllib

import pytest
from pydantic import ValidationError

from drawbar.machine.hardware.isobus import IsobusSettings, ValveSettings, guidance_valve

TEXT = """
bus = "can:socketcan:can0"
preferred_address = 200
name = { identity = 7, manufacturer = 1407, function = 29 }
[tractor_valve]
wheelbase = 2.8
address = 38
[trailer_valve]
curvature = [[-0.35, -0.2], [0.0, 0.0], [0.35, 0.2]]
address = 39
rate = 20.0
"""


def test_a_section_of_toml_becomes_a_node_and_two_valves() -> None:
    settings = IsobusSettings.model_validate(tomllib.loads(TEXT))
    node = settings.node()
    assert node.claim.name.value == 7 | 1407 << 21 | 29 << 40 | 1 << 49 | 2 << 60 | 1 << 63
    node.send(0.0)
    assert node.send(0.5)[0].identifier == 0x18EEFFC8
    assert settings.tractor_valve is not None
    assert settings.trailer_valve is not None
    assert settings.tractor_valve.map().curvature(0.5) == pytest.approx(0.1951, abs=1e-4)
    assert settings.trailer_valve.map().angle(0.1) == pytest.approx(0.175)
    valves = [guidance_valve(node, valve) for valve in (settings.tractor_valve, settings.trailer_valve)]
    assert [valve._cadence.period for valve in valves] == [0.1, 0.05]


@pytest.mark.parametrize(
    ("valve", "text"),
    [
        ({}, "needs either wheelbase"),
        ({"wheelbase": 2.8, "curvature": [[0.0, 0.0], [0.1, 0.1]]}, "needs either wheelbase"),
        ({"wheelbase": -2.8}, "greater than 0"),
        ({"curvature": [[0.0, 0.0], [0.1, -0.1]]}, "must both rise"),
        ({"curvature": [[-20.0, 0.0], [20.0, 0.1]]}, "degrees"),
        ({"curvature": [[-0.2, -200.0], [0.2, 200.0]]}, "1/km. 200 1/km = 0.2 1/m"),
        ({"wheelbase": 280.0}, "280 cm = 2.8 m"),
        ({"wheelbase": 2.8, "rate": 5.0}, "greater than or equal to 10"),
        ({"wheelbase": 2.8, "address": 254}, "less than or equal to 253"),
        ({"wheel_base": 2.8}, "has no key wheel_base"),
    ],
)
def test_a_valve_that_cannot_be_is_refused(valve: dict[str, object], text: str) -> None:
    with pytest.raises(ValidationError, match=text):
        ValveSettings.model_validate(valve)


@pytest.mark.parametrize("addresses", ["address = 38", ""])
def test_two_valves_need_two_addresses(addresses: str) -> None:
    with pytest.raises(ValidationError, match="need an address each"):
        IsobusSettings.model_validate(tomllib.loads(TEXT.replace("address = 39", addresses)))


def test_the_address_of_a_valve_is_not_claimed() -> None:
    with pytest.raises(ValidationError, match=r"preferred_address = 38 is a valve's; drawbar needs another one"):
        IsobusSettings.model_validate({**tomllib.loads(TEXT), "preferred_address": 38})
