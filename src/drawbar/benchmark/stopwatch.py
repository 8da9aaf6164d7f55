"""Stopwatch of a compiled phase, in C: restore a recorded workspace, run, read the clock; again and again."""

import ctypes
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drawbar.codegen import build
from drawbar.codegen.library import load

_UNIT = """
#define _POSIX_C_SOURCE 199309L
#include <string.h>
#include "clock.h"

/* What reading the clock itself costs, ns. */
static int64_t clock_cost(void)
{
    int64_t least = INT64_MAX;
    for (int i = 0; i < 100; ++i) {
        const int64_t start = clock_now(), time = clock_now() - start;
        least = time < least ? time : least;
    }
    return least;
}

/* Shortest of several runs of a phase, each from the same recorded state, s. */
double shortest(int (*phase)(void *), void *work, const void *recorded, size_t size, int repeats)
{
    const int64_t cost = clock_cost();
    int64_t least = INT64_MAX;
    for (int i = 0; i < repeats; ++i) {
        memcpy(work, recorded, size);
        const int64_t start = clock_now();
        phase(work);
        const int64_t time = clock_now() - start - cost;
        least = time < least ? time : least;
    }
    return 1e-9 * (double)least;
}
"""


class Stopwatch:
    """Measures the phases of one compiled unit on a private copy of its workspace."""

    def __init__(self, library: Path, memory: NDArray[np.uint8], *, repeats: int) -> None:
        """Compile the stopwatch (or take it from the cache).

        Args:
            library: the unit to measure.
            memory: (size,) bytes of the workspace that is in use; it is only read.
            repeats: runs per measurement, of which the shortest counts: the machine may be busy with other things.
        """
        self._shortest = load(build("stopwatch", _UNIT)).shortest
        self._shortest.restype = ctypes.c_double
        self._library, self._memory, self._repeats = load(library), memory, repeats
        room = np.zeros(memory.size + 64, np.uint8)
        self._copy = room[-room.ctypes.data % 64 :][: memory.size]

    def time(self, phase: str) -> float:
        """Return the time that the named phase takes from the workspace's present state, s."""
        time: float = self._shortest(
            ctypes.cast(getattr(self._library, phase), ctypes.c_void_p),
            ctypes.c_void_p(self._copy.ctypes.data),
            ctypes.c_void_p(self._memory.ctypes.data),
            ctypes.c_size_t(self._memory.size),
            self._repeats,
        )
        return time
