"""The record of a step: one copy of C's struct drawbar_record, read into signals."""

from struct import Struct

import numpy as np

from drawbar.exchange import Layout
from drawbar.geometry import Floats
from drawbar.signals import (
    Actuation,
    BodyPlan,
    BodyReference,
    BodySteering,
    Command,
    Diagnostics,
    Estimate,
    Flag,
    GateVerdict,
    Measurement,
    Plan,
    Reference,
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
_REFERENCE, _PLAN, _TIMES = Struct("6d"), Struct("5d2i"), Struct("6d")
_BODIES = (0, 1)


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
        arrays = self._actuation + _ACTUATION.size
        shapes = ((2, horizon + 1, 4), (2, horizon + 1, 3), (2, horizon))
        self._samples, self._poses, self._planned = shapes
        sizes = [8 * int(np.prod(shape)) for shape in shapes]
        self._offsets = (arrays, arrays + sizes[0], arrays + sizes[0] + sizes[1])
        if arrays + sum(sizes) != library.record.size:
            raise AssertionError("struct drawbar_record and record.py differ")

    def read(self, number: int, measurement: Measurement, command: Command, truth: Truth | None) -> StepRecord:
        """Return the record of the newest step, which is not changed by later ones."""
        self._copy()
        data = self._memory.tobytes()
        estimate = _ESTIMATE.unpack(data)
        status, flags, estimator, gate, _, _ = _TOLD.unpack_from(data, self._told)
        times = _TIMES.unpack_from(data, self._times)
        references, plans = self._read_references(data), self._read_plans(data)
        tractor, trailer = (_STEERING.unpack(data, self._steerings + body * _STEERING.size) for body in _BODIES)
        statuses = (estimator, plans[0].status, plans[1].status)
        return StepRecord(
            step=number,
            measurement=measurement,
            estimate=estimate,
            reference=Reference(time=estimate.time, tractor=references[0], trailer=references[1]),
            plan=Plan(time=estimate.time, tractor=plans[0], trailer=plans[1]),
            tractor_steering=tractor,
            trailer_steering=trailer,
            command=command,
            truth=truth,
            estimator_times=SolveTimes(prepare=times[0], feedback=times[1]),
            tractor_times=SolveTimes(prepare=times[2], feedback=times[3]),
            trailer_times=SolveTimes(prepare=times[4], feedback=times[5]),
            solver_failures=sum(each != SolverStatus.SOLVED for each in statuses),
            gate=GateVerdict(gate),
            status=Status.OK if status < Status.REFUSED else Status(status),
            flags=Flag(flags),
            actuation=_ACTUATION.unpack(data, self._actuation),
        )

    def _array(self, data: bytes, which: int, shape: tuple[int, ...]) -> Floats:
        count = shape[0] * shape[1] * (shape[2] if len(shape) > 2 else 1)
        return np.frombuffer(data, np.float64, count, self._offsets[which]).reshape(shape)

    def _read_references(self, data: bytes) -> list[BodyReference]:
        samples = self._array(data, 0, self._samples)
        found = []
        for body in _BODIES:
            at = self._references + body * _REFERENCE.size
            progress, lateral_error, *_ = _REFERENCE.unpack_from(data, at)
            closest = np.frombuffer(data, np.float64, 4, at + 16)
            found.append(
                BodyReference(progress=progress, lateral_error=lateral_error, closest=closest, samples=samples[body])
            )
        return found

    def _read_plans(self, data: bytes) -> list[BodyPlan]:
        poses, planned = self._array(data, 1, self._poses), self._array(data, 2, self._planned)
        found = []
        for body in _BODIES:
            at = self._plans + body * _PLAN.size
            steering, _, _, _, _, status, deviations = _PLAN.unpack_from(data, at)
            found.append(
                BodyPlan(
                    steering=steering,
                    poses=poses[body],
                    steerings=planned[body],
                    deviation=np.frombuffer(data, np.float64, deviations, at + 8),
                    status=SolverStatus(status),
                )
            )
        return found
