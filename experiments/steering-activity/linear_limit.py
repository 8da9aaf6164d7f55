"""The least error that any linear estimator and controller leave on a straight, for a given activity of the steering.

On a straight the simulated machine is, for small errors, a linear system that white noise drives: its own integration
step is linearised and sampled, with side-slips and measurement noise as the machine draws them. Of all linear
controllers of these measurements, a Kalman filter of the true statistics with a linear quadratic regulator (LQG) makes
any weighted sum of variances least. Mean magnitudes of Gaussian signals are sqrt(2 / pi) of their standard deviations
s, and

    s_tractor + s_trailer + price (r_front + r_joint)          errors s, steering rates r

is a convex function of all linear controllers (each is a norm, affine in Youla's parameter). So an LQG whose weights
are the derivatives of this sum by the variances, 1 / s and price / r, is the best of all for that price; iterating on
the weights lowers the sum each time (a tangent lies above a concave function). Prices from low to high give the front.

A side slope moves steering offset and both side-slips by the same angle. A design that expects slopes takes that angle
for a random walk. Its cost on flat ground and that of its answers to sudden slopes add up, noise by noise, and no
linear controller has a lower sum: none is better in both.

Slips mu and kappa about their means act in proportion to speed and steering: of second order here, and left out.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import takewhile

import casadi as ca
import numpy as np

from drawbar.control.matrix_equations import regulator_gain, solve_lyapunov
from drawbar.estimation.settings import ArticulatedEstimatorSettings
from drawbar.geometry import Floats
from drawbar.machine.plant import COMMANDS, EFFECTS, STATES, plant_constants, plant_step
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise

SAMPLE_TIME = 0.2
"""s"""
PRICES = np.geomspace(0.003, 1.2, 36)
"""of steering, m per rad/s, from busy to calm"""
SLOPE, RAMP, ANSWER_TIME = math.radians(1.0), 1.0, 15.0
"""a side slope (rad) that begins within a time (s), and how long what it does is looked at, s"""
_AT_REST = 1e-3
"""steering rate below which a steering is as good as held, rad/s"""
_PLANT = (1, 2, 3, 5, 4)
"""of the plant's states: y, theta, psi, delta_t, joint"""
_SIZE = len(_PLANT) + 3
_STEERED, _DRIVEN = slice(3, 5), slice(5, 8)
_FORGETTING = 0.9999
"""of a random walk per sample, so that what no steering can change has a variance"""
_MEAN_MAGNITUDE = math.sqrt(2.0 / math.pi)
"""of a Gaussian, in standard deviations"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Straight:
    """A vehicle beside a straight, sampled: x+ = A x + B u + w, y = C x + v; u the commanded steering angles, rad.

    States y, theta, psi, delta_t, delta_i, b or the slope, alpha_r, alpha_i; outputs y of tractor and trailer, which
    are the two errors, then beta, delta_t and delta_i, as measured.
    """

    A: Floats
    B: Floats
    C: Floats
    Q: Floats
    """covariance of w"""
    R: Floats
    """covariance of v"""
    F: Floats
    """transition of the estimate's errors: A where the lag of the steering is known, else that of angles that stay"""

    @property
    def lead(self) -> float:
        """Return how far ahead of an angle the command is that moves it at a mean rate of one over a sample, s."""
        return SAMPLE_TIME / (1.0 - float(self.A[3, 3]))


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """What an estimator and controller come to: standard deviations, tractor and trailer."""

    errors: Floats
    """of the distances from the line, m"""
    rates: Floats
    """of the mean steering rates from sample to sample, rad/s"""
    estimates: Floats
    """of what the estimates of both distances are off by, m"""
    answer: Floats
    """root mean square of the distances in the time after a side slope has begun, without noise, m"""

    @property
    def error(self) -> float:
        """Return the mean distance from the line, mean of both bodies, cm."""
        return 100.0 * _MEAN_MAGNITUDE * float(self.errors.mean())

    @property
    def rate(self) -> float:
        """Return the mean steering rate, mean of both bodies, °/s."""
        return math.degrees(_MEAN_MAGNITUDE * float(self.rates.mean()))


def straight(
    speed: float,
    slope: float = 0.0,
    vehicle: VehicleParameters = VehicleParameters(),  # noqa: B008 -- frozen
    machine: SimulatedMachineSettings = SimulatedMachineSettings(),  # noqa: B008
) -> Straight:
    """Return the simulated machine at a commanded speed, m/s: how it moves, slides and measures.

    In the place of b is the angle of a side slope, which moves b, alpha_r and alpha_i alike: a random walk of `slope`,
    rad per sample, none on flat ground.
    """
    ground, sensors = machine.ground, machine.sensors
    crabs = ground.tractor_crab, ground.trailer_crab
    steps = SAMPLE_TIME / machine.step
    decays = np.array([_FORGETTING ** (1.0 / steps), *(math.exp(-machine.step / crab.time_constant) for crab in crabs)])
    variances = np.array(
        [slope**2 / steps, *(crab.deviation**2 * (1.0 - decays[1 + i] ** 2) for i, crab in enumerate(crabs))]
    )
    step, steer = _step(speed, vehicle, machine, decays)
    step[:5, 5] = step[:5, _DRIVEN].sum(axis=1)
    A, B, Q = _sampled(step, steer, np.diag([0.0] * 5 + variances.tolist()), round(steps))
    rounding = math.hypot(sensors.steering, sensors.steering_resolution / math.sqrt(12.0))
    R = np.diag(np.square([sensors.position, sensors.position, sensors.hitch_angle, rounding, rounding]))
    return Straight(A=A, B=B, C=_outputs(vehicle), Q=Q, R=R, F=A)


def assumed_straight(
    speed: float,
    estimator: ArticulatedEstimatorSettings,
    noise: SensorNoise = SensorNoise(),  # noqa: B008
    vehicle: VehicleParameters = VehicleParameters(),  # noqa: B008
    machine: SimulatedMachineSettings = SimulatedMachineSettings(),  # noqa: B008
) -> Straight:
    """Return the same vehicle as an estimator of these settings takes it to be: drifting ground, uncertain steering."""
    drift, steps = estimator.drift, SAMPLE_TIME / machine.step
    step, steer = _step(speed, vehicle, machine, np.full(3, _FORGETTING ** (1.0 / steps)))
    A, B, _ = _sampled(step, steer, np.zeros((_SIZE, _SIZE)), round(steps))
    deviations = (
        drift.position,
        drift.yaw,
        drift.yaw,
        *2 * (drift.steering,),
        drift.steering_offset,
        *2 * (drift.crab,),
    )
    together = np.array([0.0] * 5 + [drift.slope] * 3)
    Q = np.diag(np.square(deviations)) + np.outer(together, together)
    steering = noise.tractor_steering, noise.trailer_steering
    R = np.diag(np.square([noise.position, noise.position, noise.hitch_angle, *steering]))
    known = Straight(A=A, B=B, C=_outputs(vehicle), Q=Q, R=R, F=A)
    F, by_rate = _by_rates(known)
    return replace(known, F=F, Q=Q + estimator.steering_rate**2 * by_rate @ by_rate.T)


def _sampled(step: Floats, steer: Floats, noise: Floats, steps: int) -> tuple[Floats, Floats, Floats]:
    """Return A, B and Q of a sample of so many integration steps."""
    A, B, Q = np.eye(_SIZE), np.zeros((_SIZE, 2)), np.zeros((_SIZE, _SIZE))
    for _ in range(steps):
        A, B, Q = step @ A, step @ B + steer, step @ Q @ step.T + noise
    return A, B, Q


def _step(
    speed: float, vehicle: VehicleParameters, machine: SimulatedMachineSettings, decays: Floats
) -> tuple[Floats, Floats]:
    """Return one integration step of the simulated plant about driving straight on: of the states, of the commands."""
    state, inputs = ca.SX.sym("x", STATES), ca.SX.sym("i", COMMANDS + EFFECTS)
    numbers = plant_constants(vehicle, machine)
    after = plant_step()(state, inputs, numbers)
    about = np.zeros(STATES), np.zeros(COMMANDS + EFFECTS)
    about[0][6:8] = speed, speed / machine.hydrostat.full_speed
    about[1][2:5] = speed, machine.ground.longitudinal_slip.mean, machine.ground.tractor_slip.mean
    jacobians = ca.Function("jacobians", [state, inputs], [ca.jacobian(after, state), ca.jacobian(after, inputs)])
    moved, driven = (np.array(each) for each in jacobians(*about))
    step, steer = np.zeros((_SIZE, _SIZE)), np.zeros((_SIZE, 2))
    step[:5, :5], step[:5, _DRIVEN] = moved[np.ix_(_PLANT, _PLANT)], driven[np.ix_(_PLANT, (5, 6, 7))]
    step[_DRIVEN, _DRIVEN] = np.diag(decays)
    steer[:5] = driven[np.ix_(_PLANT, (0, 1))]
    return step, steer


def _outputs(vehicle: VehicleParameters) -> Floats:
    a, d = vehicle.free_joint_offset, vehicle.drawbar_length
    C = np.zeros((5, _SIZE))
    C[0, 0] = 1.0
    C[1, :5] = 1.0, -a, vehicle.trailer_point - vehicle.trailer_length - d, 0.0, -d
    C[2, 1:5] = 1.0, -1.0, 0.0, -1.0
    C[3:, _STEERED] = np.eye(2)
    return C


def _by_rates(straight: Straight) -> tuple[Floats, Floats]:
    """Return A and B with both mean steering rates (rad/s) for inputs: the commands that bring them about put in."""
    steered = np.eye(_SIZE)[_STEERED]
    return straight.A + straight.B @ steered, straight.lead * straight.B


def kalman_gain(straight: Straight) -> Floats:
    """Return the gain K of the steady filter, estimate = prediction + K (y - C prediction)."""
    predictor = regulator_gain(straight.F.T, straight.C.T, straight.Q, straight.R).T
    errors = straight.F - predictor @ straight.C
    P = solve_lyapunov(errors, straight.Q + predictor @ straight.R @ predictor.T)
    return np.linalg.solve(straight.C @ P @ straight.C.T + straight.R, straight.C @ P).T


def regulator(straight: Straight, lateral: Floats, steering: Floats) -> Floats:
    """Return G, u = G estimate, for weights on both squared errors and on both squared steering rates."""
    A, B = _by_rates(straight)
    rates = regulator_gain(A, B, straight.C[:2].T @ np.diag(lateral) @ straight.C[:2], np.diag(steering))
    return np.eye(_SIZE)[_STEERED] - straight.lead * rates


def closed_loop(world: Straight, design: Straight, K: Floats, G: Floats) -> tuple[Floats, Floats]:
    """Return transition and noise covariance of (state, estimate) where the world is steered by a design's K and G.

    Both are of the moment at which a sample has been taken in and nothing is commanded yet.
    """
    moved, believed = world.B @ G, design.A + design.B @ G
    seen = K @ world.C
    transition = np.block([[world.A, moved], [seen @ world.A, believed + K @ (world.C @ moved - design.C @ believed)]])
    enters = np.vstack([np.eye(_SIZE), seen])
    noise = enters @ world.Q @ enters.T
    noise[_SIZE:, _SIZE:] += K @ world.R @ K.T
    return transition, noise


def evaluated(world: Straight, design: Straight, K: Floats, G: Floats) -> Point:
    """Return what a design comes to in a world, from the stationary covariance of its closed loop."""
    X = solve_lyapunov(*closed_loop(world, design, K, G))
    errors, nothing = world.C[:2], np.zeros((2, _SIZE))
    rates = np.hstack([(world.A - np.eye(_SIZE))[_STEERED], (world.B @ G)[_STEERED]]) / SAMPLE_TIME
    looks = np.hstack([errors, nothing]), rates, np.hstack([errors, -errors])
    of_errors, of_rates, of_estimates = (np.sqrt(np.diag(look @ X @ look.T)) for look in looks)
    answer = np.sqrt(np.mean(np.square(slope_answer(world, design, K, G)), axis=0))
    return Point(errors=of_errors, rates=of_rates, estimates=of_estimates, answer=answer)


def slope_answer(world: Straight, design: Straight, K: Floats, G: Floats) -> Floats:
    """Return both distances (n, 2), m, in the ANSWER_TIME after a side slope has begun that grows within RAMP."""
    transition, _ = closed_loop(world, design, K, G)
    state, found = np.zeros(2 * _SIZE), []
    for sample in range(round(ANSWER_TIME / SAMPLE_TIME)):
        state[5] = SLOPE * min((sample + 0.5) * SAMPLE_TIME / RAMP, 1.0)
        state = transition @ state
        found.append(world.C[:2] @ state[:_SIZE])
    return np.array(found)


def best(world: Straight, design: Straight, price: float) -> Point:
    """Return what the regulator on the design's filter comes to in the world that fits a price of steering best.

    Where the design is the world itself, no linear controller has a lower sum for this price.
    """
    K = kalman_gain(design)
    lateral, steering = np.full(2, 100.0), np.full(2, 10.0 * price)
    for _ in range(200):
        point = evaluated(world, design, K, regulator(design, lateral, steering))
        former = np.concatenate([lateral, steering])
        lateral, steering = 1.0 / point.errors, price / point.rates
        settled = np.allclose(np.concatenate([lateral, steering]), former, rtol=1e-5, atol=0.0)
        if settled or point.rates.min() < _AT_REST:
            break
    return point


@dataclass(frozen=True, slots=True)
class Front:
    """The least error for every steering rate, between points."""

    points: tuple[Point, ...]

    def error_at(self, rate: float) -> float:
        """Return the least error (cm) at a steering rate (°/s); NaN outside the points."""
        return self._between([point.rate for point in self.points], [point.error for point in self.points], rate)

    def rate_at(self, error: float) -> float:
        """Return the least steering rate (°/s) at an error (cm); NaN outside the points."""
        return self._between([point.error for point in self.points], [point.rate for point in self.points], error)

    def answer_at(self, rate: float) -> tuple[float, float]:
        """Return both distances after a side slope has begun, root mean squares, cm, at a steering rate (°/s)."""
        rates = [point.rate for point in self.points]
        tractor, trailer = np.transpose([100.0 * point.answer for point in self.points]).tolist()
        return self._between(rates, tractor, rate), self._between(rates, trailer, rate)

    @staticmethod
    def _between(given: list[float], wanted: list[float], at: float) -> float:
        order = np.argsort(given)
        x, y = np.log(given)[order], np.log(wanted)[order]
        return float(np.exp(np.interp(math.log(at), x, y, left=np.nan, right=np.nan)))


def front(world: Straight, design: Straight, prices: Iterable[float] = PRICES) -> Front:
    """Return the front of a design in a world, up to prices at which one of the bodies had better not steer."""
    points = (best(world, design, float(price)) for price in prices)
    return Front(tuple(takewhile(lambda point: point.rates.min() >= _AT_REST, points)))
