"""Description of a vehicle model for an estimator: its problem, and the way from measurements to an Estimate."""

from abc import ABC
from collections.abc import Mapping

from drawbar.codegen import Workspace
from drawbar.estimation.settings import ScreeningSettings
from drawbar.optimal import EstimationProblem
from drawbar.settings import Settings
from drawbar.vehicle.measured import MEASURED
from drawbar.vehicle.sensors import SensorNoise

_SENSORS = {variable.name: variable.name for variable in MEASURED} | dict.fromkeys(
    ("tractor_x", "tractor_y", "trailer_x", "trailer_y"), "position"
)
"""key of SensorNoise for each measured output"""


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


def sensor_deviations(noise: SensorNoise) -> dict[str, float]:
    """Return the standard deviation of every measured output by its name, in the output's unit."""
    return by_variable(noise, _SENSORS)


def by_variable(section: Settings, keys: Mapping[str, str]) -> dict[str, float]:
    """Return the values of a configuration's section by name of the model's variables.

    Args:
        section: standard deviations.
        keys: the section's key for each variable.
    """
    return {name: getattr(section, key) for name, key in keys.items()}
