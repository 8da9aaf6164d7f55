import dataclasses
import inspect
import pickle

import pytest

from drawbar.slots import set_through_slots


@dataclasses.dataclass(frozen=True, slots=True, kw_only=True)
class Plain:
    x: float
    name: str = "none"


@set_through_slots
@dataclasses.dataclass(frozen=True, slots=True, kw_only=True)
class Quick:
    x: float
    name: str = "none"


@pytest.mark.parametrize("given", [{"x": 1.0}, {"x": 2.0, "name": "far"}])
def test_fields_are_those_that_were_given(given):
    assert dataclasses.asdict(Quick(**given)) == dataclasses.asdict(Plain(**given))
    assert dataclasses.replace(Quick(**given), x=3.0) == Quick(**given | {"x": 3.0})
    assert pickle.loads(pickle.dumps(Quick(**given))) == Quick(**given)


@pytest.mark.parametrize("given", [{}, {"x": 1.0, "y": 2.0}])
def test_wrong_fields_are_refused_as_by_a_dataclass(given):
    for kind in (Plain, Quick):
        with pytest.raises(TypeError):
            kind(**given)
    with pytest.raises(TypeError):
        Quick(1.0)


def test_nothing_is_changed_or_added_afterwards():
    quick = Quick(x=1.0)
    with pytest.raises(dataclasses.FrozenInstanceError):
        quick.x = 2.0
    with pytest.raises((AttributeError, TypeError)):
        quick.y = 2.0
    assert inspect.signature(Quick) == inspect.signature(Plain)
