"""Store of fields: what a line is called that is added, and read again."""

import numpy as np
import pytest

from drawbar.fields.field import Field, FieldLine
from drawbar.fields.store import FieldStore

POINTS = np.array([[50.0, 4.0], [50.001, 4.0]])


@pytest.mark.parametrize(
    ("given", "kept"),
    [("Hof/links", ["Hof links", "Hof links (2)"]), ("///", ["line 1", "line 2"]), (" a  b ", ["a b", "a b (2)"])],
)
def test_a_new_line_is_found_again_by_the_name_that_it_was_given(tmp_path, given, kept):
    store = FieldStore(tmp_path)
    field = store.add(Field(name="home"))
    assert [store.add_line(field, FieldLine(name=given, points=POINTS)) for _ in kept] == kept
    assert [line.name for line in store.load(field).lines] == kept
