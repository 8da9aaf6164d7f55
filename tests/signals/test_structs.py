import dataclasses
import inspect
import pickle

import msgspec
import pytest

from drawbar.signals.structs import as_struct


@dataclasses.dataclass(frozen=True, slots=True, kw_only=True)
class Plain:
    """What both are."""

    x: float
    name: str = "none"
    places: list[int] = dataclasses.field(default_factory=lambda: [0])


@as_struct
@dataclasses.dataclass(frozen=True, slots=True, kw_only=True)
class Quick:
    """What both are."""

    x: float
    name: str = "none"
    places: list[int] = dataclasses.field(default_factory=lambda: [0])


GIVEN = [{"x": 1.0}, {"x": 2.0, "name": "far", "places": [1, 2]}]


@pytest.mark.parametrize("given", GIVEN)
def test_fields_are_those_that_were_given(given):
    assert dataclasses.asdict(Quick(**given)) == dataclasses.asdict(Plain(**given))
    assert dataclasses.replace(Quick(**given), x=3.0) == Quick(**given | {"x": 3.0})
    assert pickle.loads(pickle.dumps(Quick(**given))) == Quick(**given)
    assert repr(Quick(**given)) == repr(Plain(**given)).replace("Plain", "Quick")


@pytest.mark.parametrize("given", GIVEN)
def test_it_is_written_and_read_as_the_dataclass(given):
    written = msgspec.json.encode(Quick(**given))
    assert written == msgspec.json.encode(Plain(**given))
    assert msgspec.json.decode(written, type=Quick) == Quick(**given)


@pytest.mark.parametrize("given", [{}, {"x": 1.0, "y": 2.0}])
def test_wrong_fields_are_refused_as_by_a_dataclass(given):
    for kind in (Plain, Quick):
        with pytest.raises(TypeError):
            kind(**given)
    with pytest.raises(TypeError):
        Quick(1.0)


def test_nothing_is_changed_or_added_afterwards():
    quick = Quick(x=1.0)
    for name in ("x", "y"):
        with pytest.raises(AttributeError):
            setattr(quick, name, 2.0)
    assert Quick(x=1.0).places is not quick.places


def test_a_reader_sees_the_declaration():
    assert Quick.__doc__ == Plain.__doc__
    assert inspect.signature(Quick).parameters["x"] == inspect.signature(Plain).parameters["x"]
    assert dataclasses.fields(Quick)[1].default == "none"
    assert isinstance(Quick(x=1.0), msgspec.Struct)
