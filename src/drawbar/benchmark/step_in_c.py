"""One step of the product as a caller in C has it: the measurements of a run again, both phases timed in C."""

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drawbar.codegen import build
from drawbar.codegen.library import aligned, load
from drawbar.geometry import Floats
from drawbar.guidance.path import Path
from drawbar.signals import Command, Measurement
from drawbar.signals.layout import Layout
from drawbar.step.autopilot import Autopilot

_MEASUREMENT, _COMMAND = Layout(Measurement), Layout(Command)
_REPEATS = 5
"""runs, of which the shortest time of each step counts: the machine may be busy with other things"""
_UNIT = """
#define _POSIX_C_SOURCE 199309L
#include <stddef.h>
#include "clock.h"

/* Drive along recorded measurements; the times of both phases of each step, s. */
void run(int (*feedback)(void *, const void *, void *), int (*prepare)(void *), void *state, const char *measurements,
         size_t measurement, char *commands, size_t command, int count, double (*times)[2])
{
    for (int i = 0; i < count; ++i) {
        const int64_t start = clock_now();
        feedback(state, measurements + i * measurement, commands + i * command);
        const int64_t commanded = clock_now();
        prepare(state);
        times[i][0] = 1e-9 * (double)(commanded - start);
        times[i][1] = 1e-9 * (double)(clock_now() - commanded);
    }
}
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepTimes:
    """What each step of a run takes in C."""

    feedback: Floats
    """(steps,) from measurement to command, s"""
    preparation: Floats
    """(steps,) after the command, s"""
    commands: tuple[Command, ...]


def step_times(autopilot: Autopilot, path: Path, measurements: Sequence[Measurement]) -> StepTimes:
    """Let an autopilot drive along recorded measurements, from C, several times.

    Args:
        autopilot: it is started again for each of them.
        path: on which the measurements were taken.
        measurements: of all samples.

    Raises:
        CompilerError: no compiler, or it refused the code.
    """
    count, step = len(measurements), load(autopilot.library.file)
    given, taken = (aligned(count * layout.size) for layout in (_MEASUREMENT, _COMMAND))
    for index, measurement in enumerate(measurements):
        _MEASUREMENT.pack(given, measurement, index * _MEASUREMENT.size)
    times = np.full((_REPEATS, count, 2), np.inf)
    run = load(build("steps", _UNIT)).run
    for each in times:
        autopilot.begin(path)
        pointers = (ctypes.c_void_p(memory.ctypes.data) for memory in (given, taken, each))
        run(
            *(ctypes.cast(phase, ctypes.c_void_p) for phase in (step.drawbar_feedback, step.drawbar_prepare)),
            ctypes.c_void_p(ctypes.addressof(autopilot.library.state)),
            next(pointers),
            ctypes.c_size_t(_MEASUREMENT.size),
            next(pointers),
            ctypes.c_size_t(_COMMAND.size),
            count,
            next(pointers),
        )
    least = times.min(axis=0)
    commands = tuple(_COMMAND.unpack(taken, index * _COMMAND.size) for index in range(count))
    return StepTimes(feedback=least[:, 0], preparation=least[:, 1], commands=commands)
