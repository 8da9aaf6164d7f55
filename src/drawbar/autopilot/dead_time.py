"""Dead-time compensation: plan from where the commands under way will have taken the vehicle.

What was commanded within the last dead time is known and still to act. The estimate is integrated through it with the
vehicle's model, and all that comes after the estimator works on the state that the next command will find (Smith 1957;
Findeisen and Allgöwer 2004 for predictive control).
"""

import math
from dataclasses import replace

import casadi as ca
import numpy as np

from drawbar.codegen import CompiledFunction
from drawbar.signals import Command, Estimate, Pose
from drawbar.vehicle.model import Model, integrate, symbols, variables
from drawbar.vehicle.parameters import VehicleParameters

_STEPS = 4
"""Runge-Kutta steps per command"""
_STEERING = ("tractor_steering", "trailer_steering")


class DeadTimePredictor:
    """Remembers the commands under way and moves estimates forward through them.

    The speed stays as it is estimated: a drive is slower than any dead time. Without dead time nothing is computed.
    """

    def __init__(self, vehicle: VehicleParameters, model: Model, sample_time: float) -> None:
        """Compile the prediction.

        Args:
            vehicle: lag, rates, sign and dead time of the actuators.
            model: of the whole vehicle, articulated or tricycle.
            sample_time: s.

        Raises:
            CompilerError: no compiler, or it refused the code.
        """
        self._dead_time, self._sign, self._sample_time = vehicle.dead_time, vehicle.joint_sign, sample_time
        count = math.ceil(round(vehicle.dead_time / sample_time, 9))
        self._durations = [vehicle.dead_time - (count - 1) * sample_time, *[sample_time] * (count - 1)][:count]
        nothing = Command(time=math.nan, tractor_steering=math.nan, trailer_steering=math.nan, speed=math.nan)
        self._under_way = [nothing] * count
        if count:
            self._model = actuated(vehicle, model)
            self._move = CompiledFunction(motion(self._model))

    def ahead(self, estimate: Estimate) -> Estimate:
        """Return the estimate for the moment at which the next command begins to act."""
        if not self._durations:
            return estimate
        values = _by_name(estimate)
        state, target, parameters, duration = self._move.inputs
        after, output = self._move.outputs
        state[:] = [values[variable.name] for variable in self._model.states]
        parameters[:] = [values[variable.name] for variable in self._model.parameters]
        now = np.array([values[name] for name in _STEERING])
        for duration[0], command in zip(self._durations, self._under_way, strict=True):
            commanded = np.array([command.tractor_steering, self._sign * command.trailer_steering])
            target[:] = np.where(np.isnan(commanded), now, commanded)  # before any command the wheels stay as they are
            self._move()
            state[:] = after
        for variables_, results in ((self._model.outputs, output), (self._model.states, after)):
            values |= {variable.name: value for variable, value in zip(variables_, results.tolist(), strict=True)}
        return replace(
            estimate,
            time=estimate.time + self._dead_time,
            tractor=Pose(x=values["tractor_x"], y=values["tractor_y"], yaw=values["tractor_yaw"]),
            trailer=Pose(x=values["trailer_x"], y=values["trailer_y"], yaw=values["trailer_yaw"]),
            hitch_angle=values["hitch_angle"],
            tractor_steering=values["tractor_steering"],
            trailer_steering=values["trailer_steering"],
        )

    def sent(self, command: Command) -> Command:
        """Remember the newest command, and return the one that acts during most of the sample that now begins.

        All its values are NaN as long as no command has arrived at the actuators.
        """
        self._under_way.append(command)
        first = self._under_way.pop(0)
        return self._under_way[0] if self._durations and self._durations[0] < 0.5 * self._sample_time else first


def actuated(vehicle: VehicleParameters, model: Model) -> Model:
    """Return the model with its actuators: the inputs are what both steering angles are driven to, rad.

    The angles follow with the actuators' lag and within their rates. They are states of the new model, if they were
    not already: the articulated model takes their rates as inputs, the tricycle the angles themselves.
    """
    target, names = ca.SX.sym("target", 2), [variable.name for variable in model.states]
    inner = all(name in names for name in _STEERING)
    steering = variables(tractor_steering="rad", trailer_steering="rad")
    angles = ca.vertcat(*(model.x[names.index(name)] for name in _STEERING)) if inner else symbols(steering)
    limit = ca.vertcat(vehicle.tractor_steering_rate, vehicle.trailer_steering_rate)
    rates = ca.fmin(ca.fmax((target - angles) / vehicle.steering_lag, -limit), limit)
    derivative, output = ca.substitute([model.derivative, model.output], [model.u], [rates if inner else angles])
    return replace(
        model,
        name=f"actuated_{model.name}",
        states=model.states if inner else (*model.states, *steering),
        inputs=variables(tractor_target="rad", trailer_target="rad"),
        x=model.x if inner else ca.vertcat(model.x, angles),
        u=target,
        derivative=derivative if inner else ca.vertcat(derivative, rates),
        output=output,
    )


def motion(model: Model) -> ca.Function:
    """Return F(x, u, p, duration) -> x after the duration (s) with u held, and the model's outputs then."""
    duration = ca.SX.sym("duration")
    scaled = replace(  # in units of the duration every motion takes 1
        model,
        derivative=duration * model.derivative,
        parameters=(*model.parameters, *variables(duration="s")),
        p=ca.vertcat(model.p, duration),
    )
    after = integrate(scaled, 1.0, _STEPS)
    output = ca.substitute(model.output, model.x, after)
    return ca.Function(model.name, [model.x, model.u, model.p, duration], [after, output])


def _by_name(estimate: Estimate) -> dict[str, float]:
    """Return the estimate by the names of the models' states and parameters."""
    tractor, trailer = estimate.tractor, estimate.trailer
    return {
        "tractor_x": tractor.x,
        "tractor_y": tractor.y,
        "tractor_yaw": tractor.yaw,
        "trailer_x": trailer.x,
        "trailer_y": trailer.y,
        "trailer_yaw": trailer.yaw,
        "tractor_steering": estimate.tractor_steering,
        "trailer_steering": estimate.trailer_steering,
        "longitudinal_slip": estimate.longitudinal_slip,
        "tractor_slip": estimate.tractor_slip,
        "trailer_slip": estimate.trailer_slip,
        "steering_offset": estimate.steering_offset,
        "tractor_crab": estimate.tractor_crab,
        "trailer_crab": estimate.trailer_crab,
        "hitch_angle": estimate.hitch_angle,
        "speed": estimate.speed,
    }
