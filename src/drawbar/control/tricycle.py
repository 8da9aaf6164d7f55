"""The paper's two nominal controllers: positions tracked on the tricycle model."""

from drawbar.control.settings import TricycleControllerSettings
from drawbar.control.subsystem import SubsystemController, coupling_settings
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


class TricycleTractor(SubsystemController):
    """Tractor: f_1 of the paper; the steering reference is the last measured angle."""

    def __init__(
        self,
        vehicle: VehicleParameters,
        settings: TricycleControllerSettings,
        sample_time: float,
        tube: SubsystemTube,
    ) -> None:
        """Compile the controller for this vehicle, with what the tube leaves of the bound."""
        problem = _problem(tricycle_tractor(vehicle), settings, sample_time, tube)
        super().__init__(problem, tube, "tricycle_tractor.h", {})


class TricycleTrailer(SubsystemController):
    """Trailer: f_2 of the paper, with g_2 as the coupling says."""

    def __init__(
        self,
        vehicle: VehicleParameters,
        settings: TricycleControllerSettings,
        sample_time: float,
        tube: SubsystemTube,
    ) -> None:
        """Compile the controller for this vehicle, with what the tube leaves of the bound."""
        super().__init__(
            _problem(tricycle_trailer(vehicle), settings, sample_time, tube),
            tube,
            "tricycle_trailer.h",
            coupling_settings(settings.coupling) | {"leverage": vehicle.hitch_length / vehicle.wheelbase},
        )
