"""Deviation of each estimate of an estimator: kept beside a run, since no control step needs it."""

from collections.abc import Callable

import numpy as np

from drawbar.config import Configuration
from drawbar.errors import ConfigurationError
from drawbar.estimation.deviation import newest_deviation
from drawbar.estimation.settings import IdealEstimatorSettings
from drawbar.geometry import Floats
from drawbar.step.autopilot import Autopilot
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.tricycle import tricycle

DEVIATION = "deviation."
"""with which the names of its columns begin"""
_MODELS = {"articulated": articulated, "tricycle": tricycle}


class RecordedDeviation:
    """Keeps the standard deviations of an estimator's states and parameters at every sample."""

    def __init__(self, autopilot: Autopilot, configuration: Configuration) -> None:
        """Take the autopilot and the configuration that it was built from.

        Raises:
            ConfigurationError: the estimator has no standard deviation.
        """
        settings = configuration.estimator
        if isinstance(settings, IdealEstimatorSettings):
            raise ConfigurationError(
                f'estimator.model = "{settings.model}" has no standard deviation; ask for no column deviation.NAME of '
                "it, or estimate"
            )
        model = _MODELS[settings.model](configuration.vehicle)
        self._names = [variable.name for variable in (*model.states, *model.parameters)]
        estimator = autopilot.library.components["estimator"].live
        self._deviation: Callable[[], Floats] = lambda: newest_deviation(estimator)
        if settings.method == "extended_kalman":
            root = estimator.array("filter.R")  # of the covariance: the transpose of a square root
            self._deviation = lambda: np.asarray(np.linalg.norm(root, axis=0))
        self._deviations: list[Floats] = []

    def keep(self) -> None:
        """Keep how sure the newest estimate is; to be called between a step's two phases."""
        self._deviations.append(self._deviation())

    def column(self, name: str) -> Floats:
        """Return the standard deviation of one state or parameter at each of n samples, (n,) in its own unit.

        NaN where the model has none of this name.
        """
        if name not in self._names:
            return np.full(len(self._deviations), np.nan)
        return np.array(self._deviations)[:, self._names.index(name)]
