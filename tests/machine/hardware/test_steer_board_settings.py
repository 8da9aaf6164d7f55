"""Settings of steer boards: where they are, what they store, and that no two are taken for one."""

import math
from typing import Any

import pytest
from pydantic import ValidationError

from drawbar.errors import ConfigurationError
from drawbar.machine.hardware.steer_board import BoardMemory, SteerBoardSettings, refuse_equal_boards
from drawbar.protocols.agopengps.board_settings import SteerConfig, SteerSettings
from drawbar.protocols.agopengps.frame import Frame, parse


def board(address: str = "192.168.5.126", **values: Any) -> SteerBoardSettings:
    return SteerBoardSettings.model_validate({"address": address, "max_angle": 0.5, **values})


@pytest.mark.parametrize(
    ("given", "source", "transport"),
    [
        ({"address": "192.168.5.126"}, "192.168.5.126", "udp://0.0.0.0:9999?peer=192.168.5.126:8888&broadcast=1"),
        ({"address": "192.168.6.255"}, "192.168.6.126", "udp://0.0.0.0:9999?peer=192.168.6.255:8888&broadcast=1"),
        ({"address": "127.0.0.1:4711"}, "127.0.0.1:4711", "udp://0.0.0.0:9999?peer=127.0.0.1:4711&broadcast=1"),
        (
            {"address": "192.168.5.255", "board": "192.168.5.127", "listen": "0.0.0.0"},
            "192.168.5.127",
            "udp://0.0.0.0:9999?peer=192.168.5.255:8888&broadcast=1",
        ),
    ],
)
def test_says_where_to_send_and_whom_to_hear(given: dict[str, str], source: str, transport: str) -> None:
    settings = board(**given)
    assert settings.source == source
    assert settings.transport == transport


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"address": "board.local"}, "IPv4"),
        ({"address": "192.168.5.126:99999"}, "port"),
        ({"address": "192.168.5.126:"}, "port"),
        ({"max_angle": 20.0}, "degrees"),
        ({"max_angle": 0.9}, "50°"),
        ({"max_angle": math.nan}, "finite"),
        ({"memory": {"counts_per_degree": 0}}, "greater than or equal to 1"),
        ({"memory": {"gain": 256}}, "255"),
        ({"adress": "192.168.5.126"}, "its keys are"),
    ],
)
def test_refuses_what_cannot_be(values: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        board(**values)


def test_what_the_board_stores_is_what_is_configured() -> None:
    memory = BoardMemory(gain=70, counts_per_degree=41, offset=-12, invert_motor=True, steer_button=True, threshold=9)
    loop, wiring = memory.frames()
    assert loop == SteerSettings(gain=70, counts_per_degree=41, offset=-12).encode()
    expected = SteerConfig(invert_motor=True, steer_button=True, threshold=9, single_ended=True, cytron=True)
    assert wiring == expected.encode()
    assert all(isinstance(parse(frame), Frame) for frame in (loop, wiring))


def test_each_value_of_the_memory_reaches_a_frame() -> None:
    default = BoardMemory()
    for name, value in default.model_dump().items():
        changed = default.model_copy(update={name: (not value) if isinstance(value, bool) else value + 1})
        assert changed.frames() != default.frames(), name


def test_inverted_and_limit_reach_the_actuator() -> None:
    actuator = board(inverted=True, max_angle=0.349).actuator()
    assert (actuator._sign, actuator._max_angle) == (-1.0, 0.349)


@pytest.mark.parametrize(
    ("one", "two"),
    [
        ({"address": "192.168.5.126"}, {"address": "192.168.5.255"}),
        ({"address": "192.168.5.126"}, {"address": "192.168.5.126:8888"}),
        ({"address": "192.168.5.255"}, {"address": "192.168.5.255", "board": "192.168.5.127"}),
        ({"address": "192.168.5.126"}, {"address": "192.168.6.126", "board": "192.168.5.126"}),
    ],
)
def test_two_boards_with_one_address_are_refused(one: dict[str, str], two: dict[str, str]) -> None:
    with pytest.raises(ConfigurationError, match="network"):
        refuse_equal_boards((board(**one), board(**two)))


@pytest.mark.parametrize(("one", "two"), [("192.168.5.255", "192.168.6.255"), ("127.0.0.1:8001", "127.0.0.1:8002")])
def test_two_boards_with_their_own_addresses_are_taken(one: str, two: str) -> None:
    refuse_equal_boards((board(one), board(two)))
    with pytest.raises(ConfigurationError, match="network"):
        refuse_equal_boards((board(one), board(one)))
