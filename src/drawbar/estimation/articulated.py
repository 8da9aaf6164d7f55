"""Estimation on the exact chain (the product's default)."""

import math
from dataclasses import replace
from typing import Any

import casadi as ca

from drawbar.estimation.description import EstimationModel, by_variable, sensor_deviations
from drawbar.estimation.settings import DRIFT_TIME, ArticulatedEstimatorSettings, SlipBounds
from drawbar.geometry import GRAVITY
from drawbar.optimal import Bound, EstimationProblem
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.chain import chain_settings
from drawbar.vehicle.measured import MEASURED
from drawbar.vehicle.model import Model, by_name, constant, variables
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise

_CRAB = {"trailer_crab": "rad", "tractor_crab": "rad"}
_TURN = {"tractor_yaw": "rad", "tractor_yaw_rate": "rad/s"}
_RATES = ("tractor_steering_rate", "trailer_steering_rate")
_KEYS = (
    dict.fromkeys(("tractor_x", "tractor_y"), "position")
    | dict.fromkeys(("tractor_yaw", "trailer_yaw"), "yaw")
    | dict.fromkeys(("tractor_steering", "trailer_steering"), "steering")
    | {name: name for name in ("longitudinal_slip", "tractor_slip", "steering_offset", "speed")}
    | dict.fromkeys(_CRAB, "crab")
)
"""which value of a prior or drift section each state and parameter has"""
_ON_A_SLOPE = ("steering_offset", *_CRAB)
"""what a side slope moves, all by the same angle"""


class ArticulatedEstimation(EstimationModel):
    """States and parameters of the chain, see vehicle/articulated.py; the steering rates are its inputs."""

    name = "articulated"

    def __init__(
        self,
        vehicle: VehicleParameters,
        noise: SensorNoise,
        settings: ArticulatedEstimatorSettings,
        sample_time: float,
    ) -> None:
        """Declare the window problem for this vehicle and these sensors."""
        self.screening, self.position_deviation = settings.screening, noise.position
        self.constants = _constants(vehicle, settings, sample_time)
        aged = math.sqrt(sample_time / DRIFT_TIME)
        drift = {name: aged * value for name, value in by_variable(settings.drift, _KEYS).items()}
        model, acting = _on_slide(articulated(vehicle))
        model = _with_turn_and_crab(model, acting)
        angle = Bound(lower=-settings.angle_bound, upper=settings.angle_bound)
        self.problem = EstimationProblem(
            model=model,
            horizon=settings.window,
            sample_time=sample_time,
            weights={name: deviation**-2 for name, deviation in _deviations(noise, settings).items()},
            prior_deviation=by_variable(settings.prior, _KEYS),
            process_deviation=drift,
            common_deviation=dict.fromkeys(_ON_A_SLOPE, aged * settings.drift.slope),
            acting=acting,
            bounds={
                "longitudinal_slip": _bound(settings.longitudinal_slip_bounds),
                "tractor_slip": _bound(settings.tractor_slip_bounds),
                **dict.fromkeys(_ON_A_SLOPE, angle),
            },
        )


def _constants(
    vehicle: VehicleParameters, settings: ArticulatedEstimatorSettings, sample_time: float
) -> dict[str, float]:
    """Return the settings of the estimator's header, by name."""
    return chain_settings(vehicle) | {
        "trailer_length": vehicle.trailer_length,
        "first_slip": settings.first_slip,
        "first_yaw_error": settings.first_yaw_error,
        "sample_time": sample_time,
        "tractor_lag": vehicle.steering_lag,
        "trailer_lag": vehicle.steering_lag,
        "tractor_rate": vehicle.tractor_steering_rate,
        "trailer_rate": vehicle.trailer_steering_rate,
        "joint_sign": vehicle.joint_sign,
        **{f"slide.{name}": value for name, value in settings.slide},
    }


def _deviations(noise: SensorNoise, settings: ArticulatedEstimatorSettings) -> dict[str, float]:
    """Return the standard deviations of the model's outputs, by name."""
    return (
        sensor_deviations(noise)
        | {"tractor_yaw": noise.yaw, "tractor_yaw_rate": noise.yaw_rate}
        | dict.fromkeys(_CRAB, settings.crab)
        | dict.fromkeys(_RATES, settings.steering_rate)
    )


def _on_slide(model: Model) -> tuple[Model, dict[str, Any]]:
    """Return the model with three more constants, and what then acts in the place of side-slips and steering offset.

    The ground draws every axle in one direction of the world, and out of its curve (slide.h). Side-slips and steering
    offset are then what is left beside it.
    """
    slide = [constant(f"slide_{direction}", "rad", 0.0) for direction in ("east", "north")]
    creep = constant("creep", "rad", 0.0)
    east, north = (each.symbol for each in slide)
    states, known = by_name(model.states, model.x), by_name(model.parameters, model.p)
    speed = known["longitudinal_slip"] * known["speed"]
    turns = _turns(model, states, known)

    def across(body: str) -> Any:
        yaw = states[f"{body}_yaw"]
        return north * ca.cos(yaw) - east * ca.sin(yaw) - creep.symbol * speed * turns[body] / GRAVITY

    drawn = {"steering_offset": "tractor", "tractor_crab": "tractor", "trailer_crab": "trailer"}
    acting = {name: known[name] + across(body) for name, body in drawn.items()}
    return replace(model, constants=(*model.constants, *slide, creep)), acting


def _turns(model: Model, states: dict[str, Any], known: dict[str, Any]) -> dict[str, Any]:
    """Return both bodies' yaw rates, rad/s: the trailer's joint at rest, axles without side-slip."""
    lengths = {each.name: each.symbol for each in model.constants}
    speed = known["longitudinal_slip"] * known["speed"]
    angle = known["tractor_slip"] * states["tractor_steering"] + known["steering_offset"] - known["tractor_crab"]
    tractor = speed * ca.tan(angle) / lengths["wheelbase"]
    gamma, joint = states["tractor_yaw"] - states["trailer_yaw"], states["trailer_steering"]
    aside = speed * ca.sin(gamma) - lengths["free_joint_offset"] * tractor * ca.cos(gamma)
    trailer = aside / (lengths["trailer_length"] + lengths["drawbar_length"] * ca.cos(joint))
    return {"tractor": tractor, "trailer": trailer}


def _with_turn_and_crab(model: Model, acting: dict[str, Any]) -> Model:
    """Return the model with the tractor's yaw, its yaw rate and both crab angles as outputs too, before the rates.

    On the whole, axles do not slip sideways.
    """
    known, split = by_name(model.parameters, model.p), len(MEASURED)
    yaw = by_name(model.states, model.x)["tractor_yaw"]
    turn = by_name(model.states, model.derivative)["tractor_yaw"]
    turn = ca.substitute(turn, ca.vertcat(*(known[name] for name in acting)), ca.vertcat(*acting.values()))
    return replace(
        model,
        outputs=(*model.outputs[:split], *variables(**_TURN, **_CRAB), *model.outputs[split:]),
        output=ca.vertcat(model.output[:split], yaw, turn, *(known[name] for name in _CRAB), model.output[split:]),
    )


def _bound(bounds: SlipBounds) -> Bound:
    return Bound(lower=bounds.lower, upper=bounds.upper)
