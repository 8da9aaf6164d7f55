"""Estimation on the exact chain (the product's default)."""

import math

import numpy as np

from drawbar.estimation.description import EstimationModel, known, measured, yaws_at_rest
from drawbar.estimation.settings import ArticulatedEstimatorSettings, SlipBounds
from drawbar.geometry import Floats
from drawbar.optimal import Bound, EstimationProblem
from drawbar.signals import Estimate, Measurement, Pose, SolverStatus
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise


class ArticulatedEstimation(EstimationModel):
    """States x_t, y_t, theta, psi, delta_t, delta_i; parameters mu, kappa, b, alpha_i, v, alpha_r."""

    def __init__(
        self,
        vehicle: VehicleParameters,
        noise: SensorNoise,
        settings: ArticulatedEstimatorSettings,
        sample_time: float,
    ) -> None:
        """Declare the window problem for this vehicle and these sensors."""
        self._vehicle, self._first_slip = vehicle, settings.first_slip
        rates = (settings.steering_rate,) * 2
        deviations = (
            *(noise.position,) * 4,
            noise.hitch_angle,
            noise.speed,
            noise.tractor_steering,
            noise.trailer_steering,
        )
        angle = Bound(lower=-settings.angle_bound, upper=settings.angle_bound)
        self.problem = EstimationProblem(
            model=articulated(vehicle),
            horizon=settings.window,
            sample_time=sample_time,
            weights=tuple(deviation**-2 for deviation in (*deviations, *rates)),
            prior_deviation=_ordered(settings.prior.model_dump()),
            process_deviation=_ordered(settings.drift.model_dump()),
            bounds={
                "longitudinal_slip": _bound(settings.longitudinal_slip_bounds),
                "tractor_slip": _bound(settings.tractor_slip_bounds),
                "steering_offset": angle,
                "trailer_crab": angle,
                "tractor_crab": angle,
            },
        )

    def first_guess(self, measurement: Measurement) -> Floats:
        """Return the state at rest that explains the first measurement; see the base class."""
        theta, psi = yaws_at_rest(self._vehicle, measurement)
        position = (measurement.tractor_x, measurement.tractor_y)
        steering = known(measurement.tractor_steering), known(measurement.trailer_steering)
        slips = (self._first_slip, self._first_slip)
        return np.array([*position, theta, psi, *steering, *slips, 0.0, 0.0, known(measurement.speed), 0.0])

    def outputs(self, measurement: Measurement) -> tuple[float, ...]:
        """Return the measurement, and zero for both steering rates: they are noise."""
        return (*measured(measurement), 0.0, 0.0)

    def estimate(self, state: list[float], measurement: Measurement, status: SolverStatus) -> Estimate:
        """Return the Estimate; the trailer's antenna follows from the chain."""
        x, y, theta, psi, delta_t, delta_i, mu, kappa, offset, trailer_crab, speed, crab = state
        vehicle = self._vehicle
        phi = psi + delta_i
        a, d, back = (
            vehicle.free_joint_offset,
            vehicle.drawbar_length,
            vehicle.trailer_length - vehicle.trailer_antenna,
        )
        trailer_x = x - a * math.cos(theta) - d * math.cos(phi) - back * math.cos(psi)
        trailer_y = y - a * math.sin(theta) - d * math.sin(phi) - back * math.sin(psi)
        return Estimate(
            time=measurement.time,
            tractor=Pose(x=x, y=y, yaw=theta),
            trailer=Pose(x=trailer_x, y=trailer_y, yaw=psi),
            hitch_angle=theta - phi,
            speed=speed,
            tractor_steering=delta_t,
            trailer_steering=delta_i,
            longitudinal_slip=mu,
            tractor_slip=kappa,
            trailer_slip=1.0,
            steering_offset=offset,
            tractor_crab=crab,
            trailer_crab=trailer_crab,
            status=status,
        )


def _ordered(values: dict[str, float]) -> tuple[float, ...]:
    """Return a prior or drift section in the order of the problem's states and parameters."""
    order = (
        "position",
        "position",
        "yaw",
        "yaw",
        "steering",
        "steering",
        "longitudinal_slip",
        "tractor_slip",
    )
    return tuple(values[name] for name in (*order, "steering_offset", "crab", "speed", "crab"))


def _bound(bounds: SlipBounds) -> Bound:
    return Bound(lower=bounds.lower, upper=bounds.upper)
