"""Bodies: error models and limits of both, on the product's models and on the paper's, over their operating ranges.

The first operating point is the middle of the ranges on a straight line, the others are the corners of the ranges of
speed, slip, steering and curvature. Curves to the right are left out: they mirror those to the left, and all sets here
are symmetric.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import product

import casadi as ca
import numpy as np

from drawbar.control.settings import TubeOperatingRange
from drawbar.control.tube.error_model import ErrorModel, Limit
from drawbar.control.tube.linearisation import CommandedModel, OperatingPoint, linearised
from drawbar.errors import TubeError
from drawbar.vehicle.articulated import articulated_tractor, articulated_trailer
from drawbar.vehicle.model import Model, by_name
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle_tractor, tricycle_trailer


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingConditions:
    """Where the errors are linearised: the vehicle, its set speed, and the ranges that are allowed for."""

    vehicle: VehicleParameters
    ranges: TubeOperatingRange
    speed: float
    """m/s"""
    sample_time: float
    """s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """How the errors of a body grow, and the limits they use up."""

    model: ErrorModel
    limits: tuple[Limit, ...]
    explaining: tuple[str, ...]
    """as many disturbances as states, which together can explain any error after one sample"""


def articulated_tractor_body(conditions: OperatingConditions, falling_short: float) -> Body:
    """Return the errors (lateral, yaw, steering) of the product's tractor under its steering command.

    Args:
        conditions: where the errors are linearised.
        falling_short: declared disturbance of the steering rate, rad/s.
    """
    vehicle, limit = conditions.vehicle, conditions.vehicle.tractor_steering_limit
    declared = articulated_tractor(vehicle)
    commanded = _lagging(declared, {"lateral": "y", "yaw": "yaw", "steering": "steering"}, vehicle.steering_lag)
    points = [
        OperatingPoint(
            states={"steering": steering},
            parameters={"longitudinal_slip": pace, "tractor_slip": slip, "speed": conditions.speed},
            command=steering,
        )
        for pace, slip, steering in _corners((conditions.ranges.speed, conditions.ranges.tractor_slip), (0.0, limit))
    ]
    model = linearised(commanded, points, conditions.sample_time)
    return Body(
        model=model,
        limits=_lagging_limits(conditions, model, limit, vehicle.tractor_steering_rate, falling_short),
        explaining=("tractor_crab", "steering_offset", "steering_rate"),
    )


def articulated_trailer_body(conditions: OperatingConditions, falling_short: float) -> Body:
    """Return the errors (articulation, steering) of the product's trailer under its command; as the tractor's."""
    vehicle, limit = conditions.vehicle, conditions.vehicle.trailer_steering_limit
    declared, sign = articulated_trailer(vehicle), vehicle.joint_sign
    names = {"articulation": "articulation", "steering": "steering"}
    points = [
        OperatingPoint(
            states={"articulation": steady_articulation(vehicle, curvature, joint), "steering": joint},
            parameters={
                "longitudinal_slip": pace,
                "speed": conditions.speed,
                "tractor_yaw_rate": pace * conditions.speed * curvature,
            },
            command=sign * joint,
        )
        for pace, curvature, joint in _corners(
            (conditions.ranges.speed,), (0.0, vehicle.curvature_limit), (0.0, limit, -limit)
        )
    ]
    model = linearised(_lagging(declared, names, vehicle.steering_lag, sign), points, conditions.sample_time)
    return Body(
        model=model,
        limits=_lagging_limits(conditions, model, limit, vehicle.trailer_steering_rate, falling_short),
        explaining=("tractor_yaw_rate", "steering_rate"),
    )


def tricycle_tractor_body(conditions: OperatingConditions) -> Body:
    """Return the errors (lateral, yaw) of the paper's tractor; its input is the steering angle itself."""
    limit = conditions.vehicle.tractor_steering_limit
    points = [
        OperatingPoint(
            states={},
            parameters={"longitudinal_slip": pace, "tractor_slip": slip, "speed": conditions.speed},
            command=steering,
        )
        for pace, slip, steering in _corners((conditions.ranges.speed, conditions.ranges.tractor_slip), (0.0, limit))
    ]
    model = linearised(_direct(tricycle_tractor(conditions.vehicle)), points, conditions.sample_time)
    return Body(model=model, limits=(_command_limit(model, limit),), explaining=("lateral_rate", "yaw_rate"))


def tricycle_trailer_body(conditions: OperatingConditions) -> Body:
    """Return the errors (lateral, yaw) of the paper's trailer; g_2 is a disturbance, so its model goes without it."""
    vehicle, steering_limit = conditions.vehicle, conditions.vehicle.trailer_steering_limit
    points = [
        OperatingPoint(
            states={},
            parameters={
                "longitudinal_slip": pace,
                "trailer_slip": slip,
                "hitch_angle": steady_articulation(vehicle, curvature, 0.0) - slip * steering,
                "speed": conditions.speed,
            },
            command=steering,
        )
        for pace, slip, curvature, steering in _corners(
            (conditions.ranges.speed, conditions.ranges.trailer_slip),
            (0.0, vehicle.curvature_limit),
            (0.0, steering_limit),
        )
    ]
    model = linearised(_direct(tricycle_trailer(vehicle)), points, conditions.sample_time)
    limit = _command_limit(model, steering_limit)
    return Body(model=model, limits=(limit,), explaining=("lateral_rate", "coupling"))


def steady_articulation(vehicle: VehicleParameters, curvature: float, joint: float) -> float:
    """Return gamma (rad) of steady turning: sin gamma - a k cos gamma = k (L_i + d cos J).

    Raises:
        TubeError: the trailer is too long to follow this curve steadily.
    """
    length = vehicle.trailer_length + vehicle.drawbar_length * math.cos(joint)
    lever, reach = curvature * vehicle.free_joint_offset, curvature * length
    if not abs(reach) < math.hypot(1.0, lever):
        limit = 1.0 / math.sqrt(length**2 - vehicle.free_joint_offset**2)
        raise TubeError(
            f"no trailer with vehicle.trailer_length = {vehicle.trailer_length:g} m follows curves of "
            f"vehicle.curvature_limit = {curvature:g} 1/m steadily, it folds up behind the tractor; lower "
            f"curvature_limit to {math.floor(1e4 * limit) / 1e4:g} 1/m at most"
        )
    return math.atan(lever) + math.asin(reach / math.hypot(1.0, lever))


def _corners(ranges: tuple[tuple[float, float], ...], *from_straight: tuple[float, ...]) -> list[tuple[float, ...]]:
    """Return the middle of the ranges with the first of each of the others, then all corners."""
    middle = (*(0.5 * (low + high) for low, high in ranges), *(values[0] for values in from_straight))
    return [middle, *product(*ranges, *from_straight)]


def _lagging(model: Model, errors: Mapping[str, str], lag: float, sign: int = 1) -> CommandedModel:
    """Return a model whose steering follows its command as a first-order lag (s)."""
    command, steering = ca.SX.sym("command"), by_name(model.states, model.x)["steering"]
    derivative = ca.substitute(model.derivative, model.u, (sign * command - steering) / lag)
    return CommandedModel(model=model, errors=errors, command=command, derivative=derivative)


def _direct(model: Model) -> CommandedModel:
    """Return the paper's model of a body, whose input is its steering angle."""
    return CommandedModel(
        model=model, errors={"lateral": "y", "yaw": "yaw"}, command=model.u, derivative=model.derivative
    )


def _command_limit(model: ErrorModel, limit: float) -> Limit:
    n = len(model.states)
    return Limit(name="command", unit="rad", value=limit, reach=limit, state=np.zeros(n), command=1.0)


def falling_short_by(body: Body, conditions: OperatingConditions, falling_short: float) -> Body:
    """Return a body of the articulated model with another declared disturbance of its steering rate, rad/s."""
    *others, rate = body.limits
    reach = followed_rate(rate.value, falling_short, conditions.vehicle.steering_lag, conditions.sample_time)
    return replace(body, limits=(*others, replace(rate, reach=reach)))


def _lagging_limits(
    conditions: OperatingConditions, model: ErrorModel, limit: float, rate: float, falling_short: float
) -> tuple[Limit, ...]:
    """Return the limits of command, steering angle and steering rate, the mean rate over a sample."""
    steering = np.eye(len(model.states))[-1]
    command = _command_limit(model, limit)
    return (
        command,
        # an angle that lags behind commands within a bound stays within it by itself
        replace(command, name="steering"),
        Limit(
            name="steering_rate",
            unit="rad/s",
            value=rate,
            reach=followed_rate(rate, falling_short, conditions.vehicle.steering_lag, conditions.sample_time),
            state=(model.A[0, -1] - steering) / conditions.sample_time,
            command=float(model.B[0, -1]) / conditions.sample_time,
        ),
    )


def followed_rate(rate: float, falling_short: float, lag: float, sample_time: float) -> float:
    """Return the mean rate (rad/s) over a sample that a lagging cylinder follows but for a disturbance of its rate.

    A command held over the sample asks for most of its way at the start: the cylinder's rate is exceeded there first,
    and from then on the angle falls short at the sample's end.

    Args:
        rate: fastest that the cylinder moves, rad/s.
        falling_short: largest disturbance of the rate, rad/s.
        lag: time constant, s.
        sample_time: s.
    """
    decay = math.exp(-sample_time / lag)
    allowed = falling_short * lag * (1.0 - decay)

    def excess(mean: float) -> float:
        change = mean * sample_time / (1.0 - decay)
        limited = min(max(change / rate - lag, 0.0), sample_time)
        reached = change - (change - rate * limited) * math.exp((limited - sample_time) / lag)
        return mean * sample_time - reached - allowed

    exact = rate * lag * (1.0 - decay) / sample_time
    return _zero(excess, exact, exact + rate + 2.0 * falling_short) if falling_short else exact


def _zero(function: Callable[[float], float], low: float, high: float) -> float:
    """Return where an increasing function is zero, by bisection to the last bit: scipy.optimize is slow to import."""
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (middle, high) if function(middle) < 0.0 else (low, middle)
    return high
