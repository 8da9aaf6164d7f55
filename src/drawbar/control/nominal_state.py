"""Where the nominal problem starts, and how far the vehicle is from there (Mayne et al. 2005, section 3).

A nominal controller does not hold the vehicle to a timetable: what separates the nominal state from the estimate along
the path is no error. Before the two are compared the nominal state moves along the path to beside the estimate.
"""

import math

from drawbar.geometry import Floats, wrap


def beside(state: Floats, closest: Floats) -> Floats:
    """Return a state moved along the path to the estimate's closest point; its offset and heading to the path stay.

    Args:
        state: (n,): x, y (m), yaw (rad), and whatever else, which stays.
        closest: (4,): the path there: x, y (m), yaw (rad), curvature (1/m), taken as constant on the way.
    """
    x, y, yaw, curvature = closest.tolist()
    cosine, sine = math.cos(yaw), math.sin(yaw)
    east, north = float(state[0]) - x, float(state[1]) - y
    ahead, left = cosine * east + sine * north, cosine * north - sine * east
    outward = 1.0 - curvature * left
    # distances from the circle of curvature, without the difference of two large radii
    offset = (2.0 * left - curvature * (ahead * ahead + left * left)) / (1.0 + math.hypot(outward, curvature * ahead))
    moved = state.copy()
    moved[:3] = x - offset * sine, y + offset * cosine, state[2] - math.atan2(curvature * ahead, outward)
    return moved


def pose_deviation(estimated: Floats, nominal: Floats) -> Floats:
    """Return (n - 1,): lateral (m) and heading (rad) in the nominal heading's frame, then the remaining states.

    This frame is the paper's "linear time varying" remark. Both states are (n,): x, y (m), yaw (rad), and others.
    """
    east, north = (estimated[:2] - nominal[:2]).tolist()
    yaw = float(nominal[2])
    deviation: Floats = estimated[1:] - nominal[1:]
    deviation[0] = math.cos(yaw) * north - math.sin(yaw) * east
    deviation[1] = wrap(float(deviation[1]))
    return deviation


def plain_deviation(estimated: Floats, nominal: Floats) -> Floats:
    """Return the difference (n,) of states that are angles or lengths of the body itself; the first is a yaw's."""
    deviation: Floats = estimated - nominal
    deviation[0] = wrap(float(deviation[0]))
    return deviation
