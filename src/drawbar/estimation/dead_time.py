"""Dead-time compensation: plan from where the commands under way will have taken the vehicle.

What was commanded within the last dead time is known and still to act. The estimate is integrated through it with the
vehicle's model, and all that comes after the estimator works on the state that the next command will find (Smith 1957;
Findeisen and Allgöwer 2004 for predictive control). Here the model is put into C; dead_time.h does
the rest.
"""

import math
from dataclasses import replace
from typing import Any

import casadi as ca

from drawbar.codegen import Unit
from drawbar.codegen.emit import Output, emit, emit_indices, index_name
from drawbar.codegen.statements import Input
from drawbar.vehicle.integrators import runge_kutta
from drawbar.vehicle.model import Model, by_name, constant, symbols, variables
from drawbar.vehicle.parameters import VehicleParameters

_STEPS = 4
"""Runge-Kutta steps per command"""
_ROOM = 17
"""Commands for which there is always room, one more than can be under way: their number is data up to here"""
_STEERING = ("tractor_steering", "trailer_steering")
_MOVED = (
    *(f"{body}_{coordinate}" for body in ("tractor", "trailer") for coordinate in ("x", "y", "yaw")),
    "hitch_angle",
    *_STEERING,
)
"""What of an estimate the motion changes; whatever else the model has is taken for constant"""
_UNIT = """
#define LANES 1
#define MOST_COMMANDS {room}
#define FIRST_LAG {lag}
#define MOTION_STEPS {steps}
#define STATES {states}
#define INPUTS {inputs}
#define PARAMETERS {parameters}
#define OUTPUTS {outputs}
#define CONSTANTS {constants}
{indices}#include "dead_time.h"
static void take_estimate(struct component *work, const struct drawbar_estimate *estimate)
{{
    {take}
}}
static void give_estimate(const struct component *work, struct drawbar_estimate *estimate)
{{
    {give}
}}
{motion}
"""


def dead_time_unit(vehicle: VehicleParameters, model: Model, sample_time: float) -> Unit | None:
    """Return what remembers the commands under way and moves estimates forward through them; None without dead time.

    The speed stays as it is estimated: a drive is slower than any dead time.

    Args:
        vehicle: lag, rates, sign and dead time of the actuators.
        model: of the whole vehicle, articulated or tricycle.
        sample_time: s.
    """
    if not _samples(vehicle, sample_time):
        return None
    return found_dead_time_unit(vehicle, model, sample_time)


def found_dead_time_unit(
    vehicle: VehicleParameters,
    model: Model,
    sample_time: float,
    *,
    body_lag_per_speed: float = 0.0,
    steering_leap: float = math.inf,
) -> Unit:
    """Return the same for dead times and lags that are found during the run, the vehicle's until then.

    body_lag_per_speed: by how much the tractor turns later than its wheels stand, per speed, on firm ground, before a
        yaw-rate sensor shows it; on ground that creeps it is more. 0: not at all, on any ground. s^2/m
    steering_leap: by how much the front wheels' angle may change from one sample to the next before a second one must
        confirm it, rad.
    """
    driven = actuated(vehicle, model)
    settings = {
        "dead_time": vehicle.dead_time,
        "stated_lag": vehicle.steering_lag,
        "stated_rate": vehicle.tractor_steering_rate,
        "body.per_speed": body_lag_per_speed,
        "body.wheelbase": vehicle.wheelbase,
        "body.sample_time": sample_time,
        "body.most_change": steering_leap,
        "sign": vehicle.joint_sign,
        "constants": [each.value for each in driven.constants],
    }
    source = _source(driven, len(model.constants), max(_samples(vehicle, sample_time) + 1, _ROOM))
    return Unit(name="predictor", source=source, configure=lambda workspace: workspace.write(settings))


def _samples(vehicle: VehicleParameters, sample_time: float) -> int:
    """Return the samples within which all of the stated dead time passes."""
    return math.ceil(round(vehicle.dead_time / sample_time, 9))


def actuated(vehicle: VehicleParameters, model: Model) -> Model:
    """Return the model with its actuators: the inputs are what both steering angles are driven to, rad.

    The angles follow with the actuators' lag and within their rates. They are states of the new model, if they were
    not already: the articulated model takes their rates as inputs, the tricycle the angles themselves.
    """
    target, states = ca.SX.sym("target", 2), by_name(model.states, model.x)
    inner = all(name in states for name in _STEERING)
    steering = variables(tractor_steering="rad", trailer_steering="rad")
    angles = ca.vertcat(*(states[name] for name in _STEERING)) if inner else symbols(steering)
    lags = [constant(f"{name}_lag", "s", vehicle.steering_lag) for name in _STEERING]
    lag = ca.vertcat(*(each.symbol for each in lags))
    limits = [constant(f"{name}_rate", "rad/s", getattr(vehicle, f"{name}_rate")) for name in _STEERING]
    limit = ca.vertcat(*(each.symbol for each in limits))
    rates = ca.fmin(ca.fmax((target - angles) / lag, -limit), limit)
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
        constants=(*model.constants, *lags, *limits),
    )


def _source(model: Model, lag: int, room: int) -> str:
    """Return the C unit of the prediction with an actuated model.

    lag: place among its constants where the actuators' lags, and then their rates, begin.
    room: how many commands are remembered.
    """
    x, p, y = (_places(model, letter) for letter in "XPY")
    given = y | x  # a state rather than its measurement
    return _UNIT.format(
        room=room,
        lag=lag,
        steps=_STEPS,
        states=len(model.states),
        inputs=len(model.inputs),
        parameters=len(model.parameters),
        outputs=len(model.outputs),
        constants=len(model.constants),
        indices=emit_indices(model.names),
        take="\n    ".join(f"{place} = {_field(name)};" for name, place in (x | p).items()),
        give="\n    ".join(f"{_field(name)} = {given[name]};" for name in _MOVED),
        motion=_motion(model),
    )


def _motion(model: Model) -> str:
    """Return C: `motion` moves x in one step through a duration (s), u held, and `outputs` makes the outputs y."""
    duration = ca.SX.sym("duration")
    scaled = replace(  # in units of the duration every motion takes 1
        model,
        derivative=duration * model.derivative,
        parameters=(*model.parameters, *variables(duration="s")),
        p=ca.vertcat(model.p, duration),
    )
    after = runge_kutta(scaled, 1.0, 1)
    arguments: dict[str, Any] = {"x": model.x, "u": model.u, "p": model.p, "duration": duration}
    results = {"motion": ("x", after), "outputs": ("y", model.output)}
    inputs = [Input(place=f"work->{name}[{{k}}][{{i}}]", rows="1", symbol=symbol) for name, symbol in arguments.items()]
    inputs.append(Input(place="work->constants[{i}]", rows="", symbol=model.c))
    return "".join(
        emit(function, inputs, [Output(place=f"work->{name}[k]", rows="1", value=value)], "struct component *work")
        for function, (name, value) in results.items()
    )


def _places(model: Model, letter: str) -> dict[str, str]:
    """Return the C expressions of the places of a vector's elements, by what these are called."""
    return {name: f"work->{letter.lower()}[0][{index_name(letter, name)}]" for name in model.names[letter]}


def _field(name: str) -> str:
    """Return the C expression of what a model calls so, in an estimate."""
    body, _, coordinate = name.partition("_")
    return f"estimate->{body}.{coordinate}" if coordinate in ("x", "y", "yaw") else f"estimate->{name}"
