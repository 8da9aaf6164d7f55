"""How one vehicle model serves an estimator: its problem, and its way from measurements to states to an Estimate."""

from abc import ABC
from collections.abc import Mapping

from drawbar.codegen import Workspace
from drawbar.errors import HardwareError
from drawbar.estimation.settings import ScreeningSettings
from drawbar.optimal import EstimationProblem
from drawbar.signals import Measurement
from drawbar.vehicle.model import Model
from drawbar.vehicle.parameters import VehicleParameters


class EstimationModel(ABC):
    """The model-specific part of estimation; the filter or window around it is the same for every model.

    What it does at each sample is written in C, in the runtime's NAME_estimation.h; here is what that has to know.
    """

    name: str
    """of the model's headers"""
    problem: EstimationProblem
    screening: ScreeningSettings
    position_deviation: float
    """standard deviation of one coordinate of a fix, m"""
    constants: Mapping[str, float]
    """settings of the model's C by name"""

    def configure(self, workspace: Workspace) -> None:
        """Write the settings of model and screening into an estimator's workspace."""
        for name, value in self.constants.items():
            workspace.array(f"model.{name}")[:] = value
        for name, value in self.screening.model_dump().items():
            workspace.array(f"screening.{name}")[:] = value
        workspace.array("screening.deviation")[:] = self.position_deviation


def by_kind(model: Model, values: Mapping[str, float], kinds: Mapping[str, str]) -> tuple[float, ...]:
    """Return a value for each state, then each parameter of a model: that of its kind where it has one, else its own.

    Args:
        model: says which there are.
        values: by kind or name.
        kinds: by name.
    """
    return tuple(values[kinds.get(name, name)] for name in (*model.names["X"], *model.names["P"]))


def chain(vehicle: VehicleParameters) -> dict[str, float]:
    """Return the lengths that the trailer antenna's place depends on, as settings of the model's C, m."""
    return {
        "chain.hitch": vehicle.free_joint_offset,
        "chain.drawbar": vehicle.drawbar_length,
        "chain.back": vehicle.trailer_length - vehicle.trailer_antenna,
    }


def no_position(first: Measurement) -> HardwareError:
    """Return what to raise when an estimator cannot begin: the first measurement lacks a position."""
    return HardwareError(
        f"The first measurement lacks a position (tractor {first.tractor_x}, {first.tractor_y}; "
        f"trailer {first.trailer_x}, {first.trailer_y}); wait for a fix of both antennas to start."
    )
