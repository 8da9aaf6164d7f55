"""How sure an estimator is of each of its estimates: kept beside a run, since no control step needs it."""

import numpy as np

from drawbar.config import Configuration
from drawbar.errors import ConfigurationError
from drawbar.estimation.estimator import Estimator
from drawbar.estimation.extended_kalman import ExtendedKalmanFilter
from drawbar.estimation.moving_horizon import MovingHorizonEstimator
from drawbar.geometry import Floats
from drawbar.signals import Command, Estimate, Measurement, SolveTimes
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.tricycle import tricycle

_MODELS = {"articulated": articulated, "tricycle": tricycle}


class RecordedDeviation(Estimator):
    """An estimator that also keeps the standard deviations of its states and parameters at every sample."""

    def __init__(self, estimator: Estimator, configuration: Configuration) -> None:
        """Take the estimator and the configuration that it was built from.

        Raises:
            ConfigurationError: the estimator knows no standard deviation.
        """
        if not isinstance(estimator, MovingHorizonEstimator | ExtendedKalmanFilter):
            raise ConfigurationError(
                f'estimator.model = "{configuration.estimator.model}" has no standard deviation; ask for no '
                "column deviation.NAME of it, or estimate"
            )
        model = _MODELS[configuration.estimator.model](configuration.vehicle)
        self._estimator = estimator
        self._names = [variable.name for variable in (*model.states, *model.parameters)]
        self._deviations: list[Floats] = []

    def update(self, measurement: Measurement) -> Estimate:
        """Return the estimate, and keep how sure it is."""
        estimate = self._estimator.update(measurement)
        self._deviations.append(self._estimator.deviation)
        return estimate

    def prepare(self, command: Command | None = None) -> None:
        """Let the estimator prepare."""
        self._estimator.prepare(command)

    @property
    def times(self) -> SolveTimes:
        """Wall-clock time of the estimator's last two phases, s."""
        return self._estimator.times

    def column(self, name: str) -> Floats:
        """Return the standard deviation of one state or parameter at each of n samples, (n,) in its own unit.

        NaN where the model has none of this name.
        """
        if name not in self._names:
            return np.full(len(self._deviations), np.nan)
        return np.array(self._deviations)[:, self._names.index(name)]
