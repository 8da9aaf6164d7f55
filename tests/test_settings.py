import math
from collections.abc import Mapping
from typing import Any, ClassVar

import pytest
from pydantic import ValidationError

from drawbar.settings import Angle, Horizon, NonNegative, NonNegativeAngle, Positive, PositiveAngle, Settings, Share


class Section(Settings):
    length: Positive = 1.0
    weight: NonNegative = 0.0
    share: Share = 0.5
    yaw: Angle = 0.0
    limit: PositiveAngle = 0.1
    noise: NonNegativeAngle = 0.0
    horizon: Horizon = 10
    count: int = 0
    pair: tuple[float, ...] = ()
    table: Mapping[str, float] = {}


ALLOWED: dict[str, list[Any]] = {
    "length": [1e-12, 1e9, 2],
    "weight": [0.0, -0.0, 1e9],
    "share": [0.0, 1.0],
    "yaw": [-math.pi, 0.0, math.pi],
    "limit": [1e-9, math.pi],
    "noise": [0.0, math.pi],
    "horizon": [2, 200],
    "count": [-1_000_000_000, 1_000_000_000],
    "pair": [(0.0, -1e9, 1e-12)],
    "table": [{"a": 0.0, "b": -1e-12}],
}
REFUSED: dict[str, list[Any]] = {
    "length": [0.0, -1.0, "1", True, None, 5e-324, 0.9e-12, 1.1e9, 1e300],
    "weight": [-1e-300],
    "share": [-0.01, 1.01],
    "yaw": [3.15, -3.15, 30.0],
    "limit": [0.0, -0.1, 3.15],
    "noise": [-0.1, 3.15],
    "horizon": [1, 0, -1, 1001, 2.0, True, "10"],
    "count": [1_000_000_001, -(10**300), 10**400],
    "pair": [(1.0, -1e300), (1e-300, 0.0)],
    "table": [{"a": 1.0, "b": 1e300}, {"a": -5e-324}],
}


class Renamed(Settings):
    former_keys: ClassVar[Mapping[str, str]] = {"size": "length"}
    length: Positive = 1.0


def test_a_former_key_is_read_as_the_present_one_and_written_as_that() -> None:
    assert Renamed.model_validate({"size": 2.0}).model_dump() == {"length": 2.0}
    assert Renamed.model_validate({"length": 3.0, "size": 2.0}).length == 2.0  # a change, beside a complete table
    with pytest.raises(ValidationError, match="size"):
        Section.model_validate({"size": 2.0})


@pytest.mark.parametrize(("key", "value"), [(key, value) for key, values in ALLOWED.items() for value in values])
def test_what_is_in_range_is_taken_as_it_is(key: str, value: Any) -> None:
    assert getattr(Section.model_validate({key: value}), key) == value


@pytest.mark.parametrize(
    ("key", "value"),
    [(key, value) for key, values in REFUSED.items() for value in [*values, math.nan, math.inf, -math.inf]],
)
def test_what_is_not_is_refused(key: str, value: Any) -> None:
    with pytest.raises(ValidationError):
        Section.model_validate({key: value})


def test_an_angle_in_degrees_is_reported_in_radians() -> None:
    with pytest.raises(ValidationError, match=r"degrees\? 30\.0° = 0\.5236 rad"):
        Section(yaw=30.0)


def test_an_absurd_number_is_told_what_is_allowed() -> None:
    with pytest.raises(ValidationError, match=r"a number must be 0, or from 1e-12 to 1e\+09 with either"):
        Section(length=1e300)


def test_unknown_keys_are_reported_beside_the_known_ones() -> None:
    with pytest.raises(
        ValidationError, match=r"has no key lenght \(did you mean length\?\), colour; its keys are: length, weight"
    ):
        Section.model_validate({"lenght": 1.0, "colour": 2.0})


def test_a_section_does_not_change() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        Section().length = 2.0
