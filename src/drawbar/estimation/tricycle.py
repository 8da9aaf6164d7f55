"""Estimation on the paper's model."""

import math

import numpy as np

from drawbar.estimation.antennas import Antennas
from drawbar.estimation.description import EstimationModel, known, measured, trailer_antenna, yaws_at_rest
from drawbar.estimation.settings import TricycleEstimatorSettings
from drawbar.geometry import Floats
from drawbar.optimal import Bound, EstimationProblem
from drawbar.signals import Command, Estimate, Measurement, Pose, SolverStatus
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise
from drawbar.vehicle.tricycle import tricycle


class TricycleEstimation(EstimationModel):
    """States x_t, y_t, theta, x_i, y_i, psi; parameters mu, kappa, eta, beta, v; both steering angles are inputs."""

    yaws = (2, 5)

    def __init__(
        self,
        vehicle: VehicleParameters,
        noise: SensorNoise,
        settings: TricycleEstimatorSettings,
        sample_time: float,
    ) -> None:
        """Declare the window problem for this vehicle and these sensors."""
        self._vehicle, self._first_slip = vehicle, settings.first_slip
        self._steering = (0.0, 0.0)
        self.screening, self.first_yaw_error = settings.screening, settings.first_yaw_error
        self.position_deviation = noise.position
        deviations = (
            *(noise.position,) * 4,
            noise.hitch_angle,
            noise.speed,
            noise.tractor_steering,
            noise.trailer_steering,
        )
        power = -1 if settings.weighting == "paper" else -2
        slip = Bound(lower=settings.slip_bounds.lower, upper=settings.slip_bounds.upper)
        self.problem = EstimationProblem(
            model=tricycle(vehicle),
            horizon=settings.window,
            sample_time=sample_time,
            weights=tuple(float(deviation**power) for deviation in deviations),
            prior_deviation=_ordered(settings.prior.model_dump()),
            process_deviation=_ordered(settings.drift.model_dump()),
            bounds=dict.fromkeys(("longitudinal_slip", "tractor_slip", "trailer_slip"), slip),
        )

    def at_rest(self, measurement: Measurement) -> Floats:
        """Return the state at rest that explains one measurement; see the base class."""
        theta, psi = yaws_at_rest(self._vehicle, measurement)
        hitch, speed = known(measurement.hitch_angle), known(measurement.speed)
        positions = (
            measurement.tractor_x,
            measurement.tractor_y,
            theta,
            measurement.trailer_x,
            measurement.trailer_y,
            psi,
        )
        return np.array([*positions, *(self._first_slip,) * 3, hitch, speed])

    def outputs(self, measurement: Measurement) -> tuple[float, ...]:
        """Return the measurement."""
        return measured(measurement)

    def antennas(self, state: list[float]) -> Antennas:
        """Return where both antennas are; the trailer's by yaws and joints, which ties it to the tractor's.

        Its own position is a state that would follow any fix.
        """
        x, y, theta, _, _, psi, *_, beta, _ = state
        return (x, y), trailer_antenna(self._vehicle, x, y, theta, theta - beta, psi)

    def steering_rates(self, state: list[float], command: Command) -> tuple[float, ...]:
        """Return nothing: the steering angles are inputs, and measured."""
        return ()

    def estimate(self, state: list[float], measurement: Measurement, status: SolverStatus) -> Estimate:
        """Return the Estimate; the steering angles are the newest measured ones, since no later output sees them."""
        x_t, y_t, theta, x_i, y_i, psi, mu, kappa, eta, beta, speed = state
        newest = (measurement.tractor_steering, measurement.trailer_steering)
        held = [new if math.isfinite(new) else old for new, old in zip(newest, self._steering, strict=True)]
        self._steering = (held[0], held[1])
        return Estimate(
            time=measurement.time,
            tractor=Pose(x=x_t, y=y_t, yaw=theta),
            trailer=Pose(x=x_i, y=y_i, yaw=psi),
            hitch_angle=beta,
            speed=speed,
            tractor_steering=held[0],
            trailer_steering=held[1],
            longitudinal_slip=mu,
            tractor_slip=kappa,
            trailer_slip=eta,
            steering_offset=0.0,
            tractor_crab=0.0,
            trailer_crab=0.0,
            status=status,
        )


def _ordered(values: dict[str, float]) -> tuple[float, ...]:
    """Return a prior or drift section in the order of the problem's states and parameters."""
    order = (
        "position",
        "position",
        "yaw",
        "position",
        "position",
        "yaw",
        "slip",
        "slip",
        "slip",
        "hitch_angle",
        "speed",
    )
    return tuple(values[name] for name in order)
