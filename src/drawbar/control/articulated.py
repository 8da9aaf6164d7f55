"""Articulated controllers, the product's two: lateral errors of both antennas along a preview of the path."""

import math

from drawbar.codegen import Unit
from drawbar.control.actuator import actuator_settings
from drawbar.control.off_tracking import sharing_settings
from drawbar.control.settings import ArticulatedControllerSettings
from drawbar.control.steering_bounds import steering_bounds
from drawbar.control.subsystem import coupling_settings, subsystem_unit
from drawbar.control.tube.tube import SubsystemTube
from drawbar.optimal import ControlProblem
from drawbar.vehicle.articulated import articulated_tractor, articulated_trailer
from drawbar.vehicle.chain import chain_settings
from drawbar.vehicle.model import Model
from drawbar.vehicle.parameters import VehicleParameters


def articulated_tractor_unit(
    vehicle: VehicleParameters, settings: ArticulatedControllerSettings, sample_time: float, tube: SubsystemTube
) -> Unit:
    """Return the tractor's controller: slip, crab, a steering of limited rate, held near the path's own curvature."""
    weights = settings.tractor
    errors = {"lateral_error": weights.lateral, "heading_error": weights.heading, "steering": weights.steering}
    model = articulated_tractor(vehicle)
    problem = _problem(model, settings.horizon, sample_time, errors, weights.steering_rate, tube)
    actuator = actuator_settings(tube, lag=vehicle.steering_lag, sample_time=sample_time)
    sharing = sharing_settings(vehicle, settings.sharing, sample_time)
    own = {**chain_settings(vehicle), **actuator, **sharing, "rate_weight": weights.steering_rate}
    return subsystem_unit("tractor", problem, tube, "articulated_tractor.h", own)


def articulated_trailer_unit(
    vehicle: VehicleParameters, settings: ArticulatedControllerSettings, sample_time: float, tube: SubsystemTube
) -> Unit:
    """Return the trailer's controller, on the chain behind a tractor whose motion is given by the coupling."""
    weights = settings.trailer
    errors = {"lateral_error": weights.lateral, "steering": weights.steering}
    model = articulated_trailer(vehicle)
    problem = _problem(model, settings.horizon, sample_time, errors, weights.steering_rate, tube)
    actuator = actuator_settings(tube, lag=vehicle.steering_lag, sample_time=sample_time, sign=vehicle.joint_sign)
    motion = {
        "interval": sample_time,
        "smoothing": -math.expm1(-sample_time / settings.yaw_rate_lag),
        "return_length": settings.return_length,
    }
    sharing = sharing_settings(vehicle, settings.sharing, sample_time)
    own = {**chain_settings(vehicle), **actuator, **sharing, **coupling_settings(settings.coupling), **motion}
    return subsystem_unit("trailer", problem, tube, "articulated_trailer.h", own)


def _problem(
    model: Model, horizon: int, sample_time: float, errors: dict[str, float], rate: float, tube: SubsystemTube
) -> ControlProblem:
    """Return the problem of one body: its errors and its steering rate cost, its steering keeps within the tube."""
    return ControlProblem(
        model=model,
        horizon=horizon,
        sample_time=sample_time,
        weights=errors | {"steering_rate": rate},
        terminal_weights=errors,
        bounds=steering_bounds(tube.bounds["steering"].tightened, tube.bounds["steering_rate"].tightened),
    )
