"""The signals as C sees them: one structure for each of autopilot/signals.h, filled from and read into signals.py.

A structure is made once and used at every sample; to write one costs a microsecond or two.
"""

import ctypes
from operator import attrgetter
from struct import Struct

import numpy as np

from drawbar.geometry import Floats
from drawbar.signals import BodyReference, Command, Estimate, FixStatus, Measurement, Pose, SolverStatus

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

    def write(self, reference: BodyReference) -> None:
        """Take over the reference, whose samples stay where they are: it must outlive their use."""
        self.progress, self.lateral_error = reference.progress, reference.lateral_error
        self.closest[:] = reference.closest.tolist()
        self._owner = np.ascontiguousarray(reference.samples)
        self.samples = self._owner.ctypes.data


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

    def point_to(self, *, poses: Floats, steerings: Floats) -> None:
        """Let the plan be that of these arrays (N+1, 3) and (N,), which stay where they are."""
        self._owners = (poses, steerings)
        self.poses, self.steerings = poses.ctypes.data, steerings.ctypes.data
