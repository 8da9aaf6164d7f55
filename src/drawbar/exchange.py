"""The signals as C sees them: one structure for each of autopilot/signals.h, filled from and read into signals.py.

A structure is made once and used at every sample; to write one costs a microsecond or two.
"""

import ctypes
from operator import attrgetter
from struct import Struct

import numpy as np

from drawbar.errors import SolverError
from drawbar.geometry import Floats
from drawbar.signals import (
    BodyPlan,
    BodyReference,
    BodySteering,
    Command,
    Estimate,
    FixStatus,
    Measurement,
    Pose,
    SolverStatus,
)

_MEASUREMENT = Struct("9d")
_ESTIMATE = Struct("17d4i")
_COMMAND = Struct("4d")

_MEASURED = attrgetter(
    "time",
    "tractor_x",
    "tractor_y",
    "trailer_x",
    "trailer_y",
    "hitch_angle",
    "speed",
    "tractor_steering",
    "trailer_steering",
)
_POSE = ("x", "y", "yaw")
_ESTIMATED = attrgetter(
    "time",
    *(f"tractor.{name}" for name in _POSE),
    *(f"trailer.{name}" for name in _POSE),
    "hitch_angle",
    "speed",
    "tractor_steering",
    "trailer_steering",
    "longitudinal_slip",
    "tractor_slip",
    "trailer_slip",
    "steering_offset",
    "tractor_crab",
    "trailer_crab",
    "status",
    "tractor_fix",
    "trailer_fix",
)
_COMMANDED = attrgetter("time", "tractor_steering", "trailer_steering", "speed")


class CMeasurement(ctypes.Structure):
    """struct drawbar_measurement."""

    _fields_ = (("values", ctypes.c_double * 9),)

    def write(self, measurement: Measurement) -> None:
        """Take over the measurement."""
        _MEASUREMENT.pack_into(self, 0, *_MEASURED(measurement))


class CCommand(ctypes.Structure):
    """struct drawbar_command."""

    _fields_ = (("values", ctypes.c_double * 4),)

    def write(self, command: Command) -> None:
        """Take over the command."""
        _COMMAND.pack_into(self, 0, *_COMMANDED(command))

    def read(self) -> Command:
        """Return the command."""
        time, tractor, trailer, speed = self.values
        return Command(time=time, tractor_steering=tractor, trailer_steering=trailer, speed=speed)


class CEstimate(ctypes.Structure):
    """struct drawbar_estimate."""

    _fields_ = (("values", ctypes.c_double * 17), ("flags", ctypes.c_int32 * 4))

    def write(self, estimate: Estimate) -> None:
        """Take over the estimate."""
        _ESTIMATE.pack_into(self, 0, *_ESTIMATED(estimate), 0)

    def read(self) -> Estimate:
        """Return the estimate."""
        values = _ESTIMATE.unpack_from(self)
        return Estimate(
            time=values[0],
            tractor=Pose(x=values[1], y=values[2], yaw=values[3]),
            trailer=Pose(x=values[4], y=values[5], yaw=values[6]),
            hitch_angle=values[7],
            speed=values[8],
            tractor_steering=values[9],
            trailer_steering=values[10],
            longitudinal_slip=values[11],
            tractor_slip=values[12],
            trailer_slip=values[13],
            steering_offset=values[14],
            tractor_crab=values[15],
            trailer_crab=values[16],
            status=SolverStatus(values[17]),
            tractor_fix=FixStatus(values[18]),
            trailer_fix=FixStatus(values[19]),
        )


class CBodyReference(ctypes.Structure):
    """struct drawbar_body_reference."""

    _fields_ = (
        ("progress", ctypes.c_double),
        ("lateral_error", ctypes.c_double),
        ("closest", ctypes.c_double * 4),
        ("samples", ctypes.c_void_p),
    )

    def write(self, reference: BodyReference, stages: int = 0) -> None:
        """Take over the reference, with a copy of its samples.

        stages: how many samples C will read at least.

        Raises:
            SolverError: the reference has fewer samples, or they are not of four numbers each.
        """
        rows, *columns = reference.samples.shape
        if rows < stages or columns != [4]:
            raise SolverError(
                f"The reference's samples have the shape {reference.samples.shape}; the controller needs at least "
                f"({stages}, 4), one sample for each stage of its horizon. Give guidance and controller one horizon."
            )
        self.progress, self.lateral_error = reference.progress, reference.lateral_error
        self.closest[:] = reference.closest.tolist()
        self._samples = np.array(reference.samples, np.float64, order="C")
        self.samples = _address(self._samples)


class CBodyPlan(ctypes.Structure):
    """struct drawbar_body_plan."""

    _fields_ = (
        ("steering", ctypes.c_double),
        ("poses", ctypes.c_void_p),
        ("steerings", ctypes.c_void_p),
        ("deviation", ctypes.c_void_p),
        ("deviations", ctypes.c_int32),
        ("status", ctypes.c_int32),
    )

    def write(self, plan: BodyPlan) -> None:
        """Take over the plan, with copies of its arrays."""
        arrays = plan.poses, plan.steerings, plan.deviation
        self._arrays = [np.array(array, np.float64, order="C") for array in arrays]
        self.steering, self.status = plan.steering, plan.status
        self.poses, self.steerings, self.deviation = map(_address, self._arrays)
        self.deviations = plan.deviation.size

    def read(self, horizon: int) -> BodyPlan:
        """Return the plan over so many samples; its arrays are copies."""
        return BodyPlan(
            steering=self.steering,
            poses=_copied(self.poses, horizon + 1, 3),
            steerings=_copied(self.steerings, horizon),
            deviation=_copied(self.deviation, self.deviations),
            status=SolverStatus(self.status),
        )


class CBodySteering(ctypes.Structure):
    """struct drawbar_body_steering."""

    _fields_ = (("values", ctypes.c_double * 4), ("saturated", ctypes.c_int32))

    def read(self) -> BodySteering:
        """Return how the command came about."""
        nominal, ancillary, command, margin = self.values
        return BodySteering(
            nominal=nominal, ancillary=ancillary, command=command, margin=margin, saturated=bool(self.saturated)
        )


def _address(array: Floats) -> int:
    """Return where a writable array is, 0 for an empty one; array.ctypes.data takes several times as long."""
    return ctypes.addressof(ctypes.c_char.from_buffer(array.data)) if array.size else 0


def _copied(address: int, *shape: int) -> Floats:
    copy = np.empty(shape)
    ctypes.memmove(_address(copy), address, copy.nbytes)
    return copy
