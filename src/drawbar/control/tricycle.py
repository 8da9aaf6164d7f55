"""Tricycle controllers, the paper's two: positions tracked on the tricycle model."""

from drawbar.codegen import Unit
from drawbar.control.settings import TricycleControllerSettings
from drawbar.control.subsystem import coupling_settings, subsystem_unit
from drawbar.control.tube.tube import SubsystemTube
from drawbar.optimal import Bound, ControlProblem
from drawbar.vehicle.model import Model
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle_tractor, tricycle_trailer


def _problem(
    model: Model, settings: TricycleControllerSettings, sample_time: float, tube: SubsystemTube
) -> ControlProblem:
    q, s, r = settings.position_weight, settings.terminal_weight, settings.steering_weight
    limit = tube.bounds["command"].tightened
    return ControlProblem(
        model=model,
        horizon=settings.horizon,
        sample_time=sample_time,
        weights={"x": q, "y": q, "steering": r},
        terminal_weights={"x": s, "y": s},
        bounds={"steering": Bound(lower=-limit, upper=limit)},
    )


def tricycle_tractor_unit(
    vehicle: VehicleParameters, settings: TricycleControllerSettings, sample_time: float, tube: SubsystemTube
) -> Unit:
    """Return the tractor's controller, f_1 of the paper; the steering reference is the last measured angle."""
    problem = _problem(tricycle_tractor(vehicle), settings, sample_time, tube)
    return subsystem_unit("tractor", problem, tube, "tricycle_tractor.h", {})


def tricycle_trailer_unit(
    vehicle: VehicleParameters, settings: TricycleControllerSettings, sample_time: float, tube: SubsystemTube
) -> Unit:
    """Return the trailer's controller, f_2 of the paper, with g_2 by the coupling."""
    problem = _problem(tricycle_trailer(vehicle), settings, sample_time, tube)
    own = coupling_settings(settings.coupling) | {"leverage": vehicle.hitch_length / vehicle.wheelbase}
    return subsystem_unit("trailer", problem, tube, "tricycle_trailer.h", own)
