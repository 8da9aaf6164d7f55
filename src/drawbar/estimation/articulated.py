"""Estimation on the exact chain (the product's default)."""

import math
from dataclasses import replace

import casadi as ca
import numpy as np

from drawbar.estimation.antennas import Antennas
from drawbar.estimation.description import EstimationModel, known, measured, trailer_antenna, yaws_at_rest
from drawbar.estimation.settings import ArticulatedEstimatorSettings, SlipBounds
from drawbar.geometry import Floats
from drawbar.optimal import Bound, EstimationProblem
from drawbar.signals import Command, Estimate, Measurement, Pose, SolverStatus
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.model import Model, variables
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import MEASURED, SensorNoise


class ArticulatedEstimation(EstimationModel):
    """States x_t, y_t, theta, psi, delta_t, delta_i; parameters mu, kappa, b, alpha_i, v, alpha_r."""

    yaws = (2, 3)

    def __init__(
        self,
        vehicle: VehicleParameters,
        noise: SensorNoise,
        settings: ArticulatedEstimatorSettings,
        sample_time: float,
    ) -> None:
        """Declare the window problem for this vehicle and these sensors."""
        self._vehicle, self._first_slip, self._sample_time = vehicle, settings.first_slip, sample_time
        self.screening, self.first_yaw_error = settings.screening, settings.first_yaw_error
        self.position_deviation = noise.position
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
            model=_with_crab(articulated(vehicle)),
            horizon=settings.window,
            sample_time=sample_time,
            weights=tuple(deviation**-2 for deviation in (*deviations, *(settings.crab,) * 2, *rates)),
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

    def at_rest(self, measurement: Measurement) -> Floats:
        """Return the state at rest that explains one measurement; see the base class."""
        theta, psi = yaws_at_rest(self._vehicle, measurement)
        position = (measurement.tractor_x, measurement.tractor_y)
        steering = known(measurement.tractor_steering), known(measurement.trailer_steering)
        slips = (self._first_slip, self._first_slip)
        return np.array([*position, theta, psi, *steering, *slips, 0.0, 0.0, known(measurement.speed), 0.0])

    def outputs(self, measurement: Measurement) -> tuple[float, ...]:
        """Return the measurement; zero for both crab angles while a fix is missing; zero for both steering rates.

        With both fixes the crab angles show, and to pull them to zero would hide a side slope; without, nothing holds
        them but the belief that they fade. Commands take the place of the rates' zeros as soon as they are known.
        """
        seen = measured(measurement)
        crab = 0.0 if math.isnan(sum(seen[:4])) else math.nan
        return (*seen, crab, crab, 0.0, 0.0)

    def antennas(self, state: list[float]) -> Antennas:
        """Return where both antennas are; the trailer's follows from the chain."""
        x, y, theta, psi, _, delta_i = state[:6]
        return (x, y), trailer_antenna(self._vehicle, x, y, theta, psi + delta_i, psi)

    def steering_rates(self, state: list[float], command: Command) -> tuple[float, ...]:
        """Return the mean rates of both lagging, rate-limited actuators until the next sample, rad/s."""
        vehicle, interval = self._vehicle, self._sample_time
        joint = vehicle.joint_sign * command.trailer_steering
        return (
            mean_rate(
                command.tractor_steering - state[4], vehicle.steering_lag, vehicle.tractor_steering_rate, interval
            ),
            mean_rate(joint - state[5], vehicle.steering_lag, vehicle.trailer_steering_rate, interval),
        )

    def estimate(self, state: list[float], measurement: Measurement, status: SolverStatus) -> Estimate:
        """Return the Estimate; the trailer's antenna follows from the chain."""
        x, y, theta, psi, delta_t, delta_i, mu, kappa, offset, trailer_crab, speed, crab = state
        trailer_x, trailer_y = trailer_antenna(self._vehicle, x, y, theta, psi + delta_i, psi)
        return Estimate(
            time=measurement.time,
            tractor=Pose(x=x, y=y, yaw=theta),
            trailer=Pose(x=trailer_x, y=trailer_y, yaw=psi),
            hitch_angle=theta - psi - delta_i,
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


def _with_crab(model: Model) -> Model:
    """Return the model with both crab angles as outputs, before the rates: on the whole, axles do not slip sideways."""
    crab, split = variables(trailer_crab="rad", tractor_crab="rad"), len(MEASURED)
    return replace(
        model,
        outputs=(*model.outputs[:split], *crab, *model.outputs[split:]),
        output=ca.vertcat(model.output[:split], model.p[3], model.p[5], model.output[split:]),
    )


def mean_rate(error: float, lag: float, limit: float, interval: float) -> float:
    """Return by how much per second a lagging, rate-limited actuator moves within an interval, rad/s.

    error: command minus present angle, rad; lag and interval in s; limit in rad/s.
    """
    distance = abs(error)
    limited = min(max(distance / limit - lag, 0.0), interval)
    remaining = distance - limit * limited
    moved = limit * limited - remaining * math.expm1(-(interval - limited) / lag)
    return math.copysign(moved, error) / interval


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
