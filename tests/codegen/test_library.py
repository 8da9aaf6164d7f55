"""A workspace is a view into the C struct, one for each instance."""

import gc
import weakref

import numpy as np
import pytest

from drawbar.codegen import Workspace, build
from drawbar.errors import SolverError

UNIT = """
#include "fields.h"
struct work { double grid[2][3]; int32_t counts[2]; double last; };
int64_t drawbar_size = sizeof(struct work);
const struct drawbar_field drawbar_fields[] = {
    FIELD(work, grid, 0, 2, 3, 0) FIELD(work, counts, 1, 2, 0, 0) FIELD(work, last, 0, 1, 0, 0)
    END_OF_FIELDS
};
int bump(struct work *w) { w->counts[1] += 1; w->last = w->grid[1][2]; return w->counts[1]; }
"""


def test_arrays_share_the_memory_of_their_own_instance() -> None:
    one, other = (Workspace(build("views", UNIT)) for _ in range(2))
    one.array("grid")[:] = [[1, 2, 3], [4, 5, 6]]
    bump = one.function("bump")
    assert [bump(), bump()] == [1, 2]
    assert one.array("last") == 6.0
    assert one.array("counts").dtype == np.int32
    np.testing.assert_array_equal(one.array("counts"), [0, 2])
    np.testing.assert_array_equal(other.array("counts"), [0, 0])
    assert other.array("grid").shape == (2, 3)
    assert one.memory.ctypes.data % 64 == 0


def test_a_function_keeps_the_memory_it_works_on() -> None:
    workspace = Workspace(build("views", UNIT))
    counts, bump, memory = workspace.array("counts"), workspace.function("bump"), weakref.ref(workspace.memory)
    assert bump() == 1
    del workspace, counts
    gc.collect()
    assert memory() is not None
    assert bump() == 2
    del bump
    gc.collect()
    assert memory() is None


def test_unknown_names_are_errors() -> None:
    workspace = Workspace(build("views", UNIT))
    with pytest.raises(SolverError, match="There is no array 'velocity'; there are grid, counts, last"):
        workspace.array("velocity")
    with pytest.raises(SolverError, match="There is no array 'velocity'"):
        workspace.write({"velocity": 1.0})
    with pytest.raises(AttributeError):
        workspace.function("stop")
