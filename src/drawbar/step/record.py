"""The record of a step: one copy of C's struct drawbar_record, read into signals.

Predictions (planned poses and steerings) are recorded to 0.1 mm or 0.1 mrad (hosted_step.h); nothing that
is commanded, measured or estimated is rounded.
"""

from struct import Struct

import numpy as np

from drawbar.exchange import Layout, Members
from drawbar.geometry import Floats
from drawbar.signals import (
    Actuation,
    BodyPlace,
    BodyPlan,
    BodySteering,
    Command,
    Diagnostics,
    Estimate,
    Flag,
    GateVerdict,
    Measurement,
    Places,
    Plan,
    SolverStatus,
    SolveTimes,
    Status,
    StepRecord,
    Truth,
)
from drawbar.step.library import StepLibrary

_ESTIMATE, _DIAGNOSTICS, _STEERING = Layout(Estimate), Layout(Diagnostics), Layout(BodySteering)
_ACTUATION = Layout(Actuation)
_TOLD = Struct("6i")
"""the numbers at the end of the diagnostics"""
_REFERENCE, _PLAN, _TIMES = Struct("2d32x"), Struct("d32x2i"), Struct("6d")
"""of references and plans without their arrays, which are views"""
_SOLVERS, _GATES, _FLAGS = Members(SolverStatus), Members(GateVerdict), Members(Flag)


class RecordReader:
    """Reads the newest step out of a library."""

    def __init__(self, library: StepLibrary, horizon: int) -> None:
        """Take the library and the number of stages in its plans."""
        self._memory = library.record
        self._copy = library.function("get_record", np.ctypeslib.as_ctypes(library.record))
        self._steerings = _ESTIMATE.size + _DIAGNOSTICS.size
        self._told = self._steerings - _TOLD.size
        self._references = self._steerings + 2 * _STEERING.size
        self._plans = self._references + 2 * _REFERENCE.size
        self._times = self._plans + 2 * _PLAN.size
        self._actuation = self._times + _TIMES.size
        self._predictions = (self._actuation + _ACTUATION.size) // 8
        self._planned = self._predictions + 6 * (horizon + 1)
        if 8 * (self._planned + 2 * horizon) != library.record.size:
            raise AssertionError("struct drawbar_record and record.py differ")

    def read(self, number: int, measurement: Measurement, command: Command, truth: Truth | None) -> StepRecord:
        """Return the record of the newest step, which is not changed by later ones."""
        self._copy()
        data = self._memory.tobytes()
        numbers = np.frombuffer(data)
        poses = numbers[self._predictions : self._planned].reshape(2, -1, 3)
        steerings = numbers[self._planned :].reshape(2, -1)
        estimate = _ESTIMATE.unpack(data)
        status, flags, estimator, gate, _, _ = _TOLD.unpack_from(data, self._told)
        times = _TIMES.unpack_from(data, self._times)
        tractor = _plan(data, numbers, self._plans, poses[0], steerings[0])
        trailer = _plan(data, numbers, self._plans + _PLAN.size, poses[1], steerings[1])
        return StepRecord(
            step=number,
            measurement=measurement,
            estimate=estimate,
            reference=Places(
                time=estimate.time,
                tractor=_place(data, numbers, self._references),
                trailer=_place(data, numbers, self._references + _REFERENCE.size),
            ),
            plan=Plan(time=estimate.time, tractor=tractor, trailer=trailer),
            tractor_steering=_STEERING.unpack(data, self._steerings),
            trailer_steering=_STEERING.unpack(data, self._steerings + _STEERING.size),
            command=command,
            truth=truth,
            estimator_times=SolveTimes(prepare=times[0], feedback=times[1]),
            tractor_times=SolveTimes(prepare=times[2], feedback=times[3]),
            trailer_times=SolveTimes(prepare=times[4], feedback=times[5]),
            solver_failures=3 - (estimator, tractor.status, trailer.status).count(SolverStatus.SOLVED),
            gate=_GATES[gate],
            status=Status.OK if status < Status.REFUSED else Status(status),
            flags=_FLAGS[flags],
            actuation=_ACTUATION.unpack(data, self._actuation),
        )


def _place(data: bytes, numbers: Floats, offset: int) -> BodyPlace:
    progress, lateral_error = _REFERENCE.unpack_from(data, offset)
    at = offset // 8 + 2
    return BodyPlace(progress=progress, lateral_error=lateral_error, closest=numbers[at : at + 4])


def _plan(data: bytes, numbers: Floats, offset: int, poses: Floats, steerings: Floats) -> BodyPlan:
    steering, status, deviations = _PLAN.unpack_from(data, offset)
    at = offset // 8 + 1
    return BodyPlan(
        steering=steering,
        poses=poses,
        steerings=steerings,
        deviation=numbers[at : at + deviations],
        status=_SOLVERS[status],
    )
