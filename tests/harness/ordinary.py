"""Measurements and estimates of which a test names only what matters to it: other sensors and angles are 0, slips 1."""

from typing import Any

from drawbar.signals import Estimate, Measurement, Pose, SolverStatus

AT = Pose(x=0.0, y=0.0, yaw=0.0)
_SENSORS = ("hitch_angle", "speed", "tractor_steering", "trailer_steering")
_ANGLES = (*_SENSORS, "steering_offset", "tractor_crab", "trailer_crab")
_SLIPS = ("longitudinal_slip", "tractor_slip", "trailer_slip")


def measured(*antennas: float, time: float = 0.0, **named: Any) -> Measurement:
    """Return a measurement; antennas: x and y of the tractor's, of the trailer's, m, without any (0, 0) and (-2, 0)."""
    places = zip(("tractor_x", "tractor_y", "trailer_x", "trailer_y"), antennas or (0.0, 0.0, -2.0, 0.0), strict=True)
    return Measurement(time=time, **{**dict.fromkeys(_SENSORS, 0.0), **dict(places), **named})


def believed(tractor: Pose = AT, trailer: Pose = AT, *, time: float = 0.0, **named: Any) -> Estimate:
    """Return an estimate that was solved."""
    others = {**dict.fromkeys(_ANGLES, 0.0), **dict.fromkeys(_SLIPS, 1.0), "status": SolverStatus.SOLVED, **named}
    return Estimate(time=time, tractor=tractor, trailer=trailer, **others)
