"""The paper's centralised controller (CeNMPC): both positions tracked on the whole tricycle model."""

from drawbar.codegen import Unit
from drawbar.control.centralised import centralised_unit
from drawbar.control.settings import TricycleControllerSettings
from drawbar.control.tube.tube import Tubes
from drawbar.optimal import Bound, ControlProblem
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle

_POSITIONS = ("tractor_x", "tractor_y", "trailer_x", "trailer_y")
_STEERINGS = ("tractor_steering", "trailer_steering")
_GIVEN = {"hitch_angle": 0.0, "speed": 0.0}
"""parameters here, which no input changes"""


def centralised_tricycle_unit(
    vehicle: VehicleParameters, settings: TricycleControllerSettings, sample_time: float, tubes: Tubes
) -> Unit:
    """Return costs Q, R, S of both bodies in one problem; steering references are the last measured angles."""
    q, s, r = settings.position_weight, settings.terminal_weight, settings.steering_weight
    front, rear = (tube.bounds["command"].tightened for tube in (tubes.tractor, tubes.trailer))
    problem = ControlProblem(
        model=tricycle(vehicle),
        horizon=settings.horizon,
        sample_time=sample_time,
        weights=dict.fromkeys(_POSITIONS, q) | dict.fromkeys(_STEERINGS, r) | _GIVEN,
        terminal_weights=dict.fromkeys(_POSITIONS, s) | _GIVEN,
        bounds={
            "tractor_steering": Bound(lower=-front, upper=front),
            "trailer_steering": Bound(lower=-rear, upper=rear),
        },
    )
    return centralised_unit("centralised_tricycle.h", problem, tubes)
