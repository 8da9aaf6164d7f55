"""Call of a function of a foreign C library, timed in C as drawbar's own functions are."""

import ctypes
from typing import Any

import numpy as np

from drawbar.benchmark.stopwatch import Stopwatch
from drawbar.codegen import build

_UNIT = """
struct call { void (*function)(void *, void *, void *, void *); void *arguments[4]; };
int call(struct call *c)
{
    c->function(c->arguments[0], c->arguments[1], c->arguments[2], c->arguments[3]);
    return 0;
}
"""


class TimedCall:
    """A function of up to four pointers, whose result is of no interest."""

    def __init__(self, function: Any, *arguments: Any, repeats: int) -> None:
        """Bind it to its arguments, which must outlive this object; the shortest of `repeats` runs counts."""
        pointers = [ctypes.cast(each, ctypes.c_void_p).value or 0 for each in (function, *arguments)]
        memory = np.array(pointers + [0] * (5 - len(pointers)), np.uint64).view(np.uint8)
        self._watch = Stopwatch(build("call", _UNIT), memory, repeats=repeats)

    def time(self) -> float:
        """Call it and return how long it takes, s."""
        return self._watch.time("call")
