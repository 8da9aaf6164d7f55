"""The stopwatch times a phase from the recorded state and leaves that state alone."""

import numpy as np

from drawbar.benchmark.stopwatch import Stopwatch
from drawbar.codegen import Workspace, build

UNIT = """
#include "fields.h"
struct work { double sum; int32_t rounds; };
int64_t drawbar_size = sizeof(struct work);
const struct drawbar_field drawbar_fields[] = {
    FIELD(work, sum, 0, 1, 0, 0) FIELD(work, rounds, 1, 1, 0, 0) END_OF_FIELDS
};
int turn(struct work *w) { for (int i = 0; i < w->rounds; ++i) w->sum = 0.5 * w->sum + 1.0; w->rounds = 0; return 0; }
"""


def test_every_repeat_starts_from_the_recorded_state() -> None:
    library = build("turn", UNIT)
    workspace = Workspace(library)
    rounds = 100_000  # dependent additions: at least 2 cycles each, which no machine does in less than 0.1 ns
    workspace.array("rounds")[:] = rounds
    before = workspace.memory.copy()
    assert Stopwatch(library, workspace.memory, repeats=3).time("turn") > rounds * 1e-10
    np.testing.assert_array_equal(workspace.memory, before)
