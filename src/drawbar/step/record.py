"""The record of a step: one copy of C's struct drawbar_record, read into signals.

Predictions (planned poses and steerings) are recorded in single precision and to 1/1024 m or rad, references,
deviations from the nominal state, margins and what is identified to 2^-20 m, rad or s, the solvers' times to 2^-30 s
(hosted_step.h); nothing that is commanded, measured or estimated is rounded.
"""

import math
from struct import Struct

import numpy as np

from drawbar.signals import Command, Measurement, StepRecord, Truth
from drawbar.signals.layout import Layout
from drawbar.step.layout import StepLayout, made_of
from drawbar.step.library import StepLibrary

_MEASUREMENT, _COMMAND, _TRUTH = Layout(Measurement), Layout(Command), Layout(Truth)
_NUMBER = Struct("i")


class RecordReader:
    """Reads the newest step out of a library; what Python adds to it lies in the same memory."""

    def __init__(self, library: StepLibrary, horizon: int) -> None:
        """Take the library and the number of stages in its plans."""
        layout, self._memory = StepLayout.of(horizon), library.record
        if layout.size != library.record.size:
            raise AssertionError("struct drawbar_record and layout.py differ")
        self._copy = library.function("get_record", np.ctypeslib.as_ctypes(library.record))
        self._made = layout.reader("measurement", "command", "truth")
        places = {name: layout.cells[f"{name}.time"].offset for name in ("measurement", "command", "truth")}
        self.measurement, self.command = (
            np.ctypeslib.as_ctypes(library.record[places[name] : places[name] + size])
            for name, size in (("measurement", _MEASUREMENT.size), ("command", _COMMAND.size))
        )
        """where a step is given its measurement, and leaves its command"""
        self._truth, self._number = places["truth"], layout.cells["step"].offset
        self._memory[self._truth : self._truth + _TRUTH.size].view(np.float64)[:] = math.nan

    def read(self, number: int, measurement: Measurement, command: Command, truth: Truth | None) -> StepRecord:
        """Return the record of the newest step, which is not changed by later ones."""
        self._copy()
        if truth is not None:
            _TRUTH.pack(self._memory, truth, self._truth)
        _NUMBER.pack_into(self._memory.data, self._number, number)
        data = self._memory.tobytes()
        return made_of(self._made(data, measurement, command, truth), data)
