"""The estimators and the dead-time prediction, each by itself."""

import numpy as np
from alone import Alone, Solver
from c_signals import given, room, taken

from drawbar.codegen import Unit
from drawbar.estimation.dead_time import found_dead_time_unit
from drawbar.estimation.description import EstimationModel
from drawbar.estimation.deviation import newest_deviation
from drawbar.estimation.extended_kalman import extended_kalman_unit
from drawbar.estimation.moving_horizon import moving_horizon_unit
from drawbar.geometry import Floats
from drawbar.signals import Actuation, Command, Estimate, Measurement, SolverStatus
from drawbar.vehicle.model import Model
from drawbar.vehicle.parameters import VehicleParameters


class Estimator(Alone):
    """What all estimators offer to the control step."""

    def __init__(self, unit: Unit, first: Measurement) -> None:
        """Start from the first measurement."""
        super().__init__(unit)
        self.begun = SolverStatus(self.call("begin", given(first)))

    def update(self, measurement: Measurement) -> Estimate:
        """Return the estimate at the measurement's time."""
        estimate = room(Estimate)
        self.call("update", given(measurement), estimate, self.resources)
        return taken(Estimate, estimate)

    def expected(self) -> Estimate:
        """Return the estimate that is expected at the next measurement."""
        estimate = room(Estimate)
        self.call("expected", estimate)
        return taken(Estimate, estimate)

    def prepare(self, acting: Command | None = None) -> SolverStatus:
        """Do what can be done before the next measurement; the command that acts until then is told, or not."""
        return SolverStatus(self.call("ready", None if acting is None else given(acting)))

    def skip(self, acting: Command | None = None) -> SolverStatus:
        """Let a sample pass that was left out."""
        return SolverStatus(self.call("skip", None if acting is None else given(acting)))


class MovingHorizonEstimator(Estimator):
    """The window's estimator."""

    def __init__(self, model: EstimationModel, first: Measurement) -> None:
        """Start from the first measurement."""
        super().__init__(moving_horizon_unit(model), first)
        self.solver = Solver(self.live, model.problem)

    @property
    def deviation(self) -> Floats:
        """Standard deviations of states and parameters as they are now."""
        return newest_deviation(self.live)


class ExtendedKalmanFilter(Estimator):
    """The filter."""

    def __init__(self, model: EstimationModel, first: Measurement) -> None:
        """Start from the first measurement."""
        super().__init__(extended_kalman_unit(model), first)
        self.state: Floats = self.live.array("filter.x")
        self.root: Floats = self.live.array("filter.R").T
        """a square root S of the state's covariance S S', lower triangular"""

    @property
    def deviation(self) -> Floats:
        """Standard deviations of the state as it is now."""
        return np.linalg.norm(self.root, axis=1)


class DeadTimePredictor(Alone):
    """Moves estimates through the commands under way."""

    def __init__(
        self, vehicle: VehicleParameters, model: Model, sample_time: float, body_lag_per_speed: float = 0.0
    ) -> None:
        """Compile the prediction of a vehicle with a dead time, whose tractor turns later per speed, s^2/m."""
        unit = found_dead_time_unit(
            vehicle, model, sample_time, body_lag_per_speed=body_lag_per_speed, steering_leap=0.2
        )
        super().__init__(unit)

    def ahead(self, estimate: Estimate) -> Estimate:
        """Return the estimate for the moment at which the next command begins to act."""
        then = room(Estimate)
        self.call("ahead", given(estimate), then)
        return taken(Estimate, then)

    def known(self, actuation: Actuation) -> None:
        """Reckon with what is known of the actuators."""
        self.call("actuation", given(actuation))

    def measured(self, last: Estimate, measurement: Measurement) -> tuple[float, Actuation]:
        """Return the angle with which the front wheels turn the tractor now, rad, and what is told of its lag."""
        passed, told = given(measurement), room(Actuation)
        self.call("measured", given(last), passed, told)
        return taken(Measurement, passed).tractor_steering, taken(Actuation, told)

    def sent(self, command: Command) -> Command:
        """Remember the newest command, and return the one that acts until the next."""
        acting = room(Command)
        self.call("sent", given(command), acting)
        return taken(Command, acting)
