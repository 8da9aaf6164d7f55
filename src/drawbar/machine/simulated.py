"""The simulated machine: moves the true world from sample to sample, reports it through faulty sensors."""

import math
from collections.abc import Callable

import numpy as np

from drawbar.errors import ConfigurationError, HardwareError
from drawbar.geometry import Floats
from drawbar.machine.base import Machine
from drawbar.machine.ground import Ground
from drawbar.machine.motion import LagMotion, Motion, ValveMotion
from drawbar.machine.plant import COMMANDS, EFFECTS
from drawbar.machine.sensing import Sensing
from drawbar.machine.settings import SimulatedMachineSettings, whole_steps
from drawbar.signals import Command, Measurement, Pose, Truth
from drawbar.vehicle.parameters import VehicleParameters

_BLOCK = 64
"""Samples whose randomness is drawn at once. Part of what a seed means: another value gives another run."""


class SimulatedMachine(Machine):
    """A tractor and trailer in a computer. Same settings and seed: the identical run.

    It starts at rest with the trailer straight behind it; its lengths are the vehicle's times `settings.lengths`.
    Raises ConfigurationError when the sample time is not a multiple of the integration step, the start is not finite,
    or no vehicle has such lengths.
    """

    def __init__(
        self,
        *,
        vehicle: VehicleParameters,
        settings: SimulatedMachineSettings,
        sample_time: float,
        start: Pose,
        seed: int,
        unknown: Callable[[], Floats] | None = None,
    ) -> None:
        """Place the machine.

        Args:
            vehicle: lengths as stated, and limits.
            settings: everything else.
            sample_time: s.
            start: of the tractor.
            seed: of everything random.
            unknown: gives what is added to mu, kappa, b, alpha_r, alpha_i during a sample, and that not even the truth
                tells.
        """
        self._vehicle = settings.lengths.applied_to(vehicle)
        self._settings, self._sample_time = settings, sample_time
        self._steps = _steps_per_sample(sample_time, settings.step)
        if not all(map(math.isfinite, (start.x, start.y, start.yaw))):
            raise ConfigurationError(f"the simulated machine cannot start at {start}; give finite m and rad")
        rng = np.random.default_rng(seed)
        self._ground = Ground(settings.ground, settings.events, settings.step, rng)
        self._sensing = Sensing(settings.sensors, settings.events, sample_time, rng)
        self._motion: Motion = (
            LagMotion(self._vehicle, settings, self._steps)
            if settings.low_level.kind == "lag"
            else ValveMotion(self._vehicle, settings)
        )
        self._state = self._motion.state
        self._state[:4] = start.x, start.y, start.yaw, start.yaw
        delay = whole_steps(settings.actuators.dead_time, settings.step) or 0
        self._commands = np.zeros((delay + self._steps, COMMANDS))
        self._unknown = unknown
        self._sample = 0
        self._fix = [math.nan] * 4
        self._newest = (0.0, 0.0, 0.0)
        self._begun = False
        self._draw()

    def read(self) -> Measurement:
        """Let one sample period pass under the newest command, and return what the sensors report then.

        The first measurement is that of the machine where it was placed.
        """
        if self._begun:
            self._let_pass()
        self._begun = True
        return self._sense()

    def write(self, command: Command) -> None:
        """Take over the command, which acts from now on.

        Raises HardwareError when the command is not finite or beyond the limits; then the last one goes on to act.
        """
        vehicle = self._vehicle
        _within("tractor_steering", command.tractor_steering, vehicle.tractor_steering_limit, "rad")
        _within("trailer_steering", command.trailer_steering, vehicle.trailer_steering_limit, "rad")
        _within("speed", command.speed, self._settings.hydrostat.full_speed, "m/s")
        joint = vehicle.joint_sign * command.trailer_steering
        self._newest = command.tractor_steering, joint, command.speed

    def stop(self) -> None:
        """Stop with the steering held."""
        self._newest = *self._newest[:2], 0.0

    def _let_pass(self) -> None:
        """Move on by one sample period."""
        self._commands[: -self._steps] = self._commands[self._steps :]
        self._commands[-self._steps :] = self._newest
        effects = self._effects[self._sample % _BLOCK].copy()
        if self._unknown is not None:
            effects[:, :5] += self._unknown()
        self._motion.advance(self._commands[: self._steps], effects)
        self._sample += 1
        if self._sample % _BLOCK == 0:
            self._draw()

    def truth(self) -> Truth:
        """Return the true state, and the slips that begin to act now; b includes the push of a side slope."""
        x, y, yaw, trailer_yaw, joint, steering, speed, *_ = self._state.tolist()
        mu, kappa, offset, tractor_crab, trailer_crab, *_ = self._effects[self._sample % _BLOCK, 0].tolist()
        trailer_x, trailer_y = _trailer_antenna(self._vehicle, x, y, yaw, trailer_yaw, joint)
        return Truth(
            time=self._sample * self._sample_time,
            tractor=Pose(x=x, y=y, yaw=yaw),
            trailer=Pose(x=trailer_x, y=trailer_y, yaw=trailer_yaw),
            speed=speed,
            tractor_steering=steering,
            trailer_steering=joint,
            longitudinal_slip=mu,
            tractor_slip=kappa,
            steering_offset=offset,
            tractor_crab=tractor_crab,
            trailer_crab=trailer_crab,
        )

    def _sense(self) -> Measurement:
        """Look at the world through the sensors."""
        row = self._sample % _BLOCK
        x, y, yaw, trailer_yaw, joint, steering, speed, *_ = self._state.tolist()
        errors = self._errors[row].tolist()
        antennas = (x, y, *_trailer_antenna(self._vehicle, x, y, yaw, trailer_yaw, joint))
        self._fix = [
            last if held else true + error
            for last, held, true, error in zip(self._fix, self._held[row], antennas, errors, strict=False)
        ]
        resolution = self._settings.sensors.steering_resolution
        return Measurement(
            time=self._sample * self._sample_time,
            tractor_x=self._fix[0],
            tractor_y=self._fix[1],
            trailer_x=self._fix[2],
            trailer_y=self._fix[3],
            hitch_angle=yaw - trailer_yaw - joint + errors[4],
            speed=speed + errors[5],
            tractor_steering=_rounded(steering + errors[6], resolution),
            trailer_steering=_rounded(joint + errors[7], resolution),
        )

    def _draw(self) -> None:
        """Draw the randomness of the next block of samples, always as much and in the same order."""
        samples = self._sample + np.arange(_BLOCK, dtype=np.float64)
        steps = self._sample * self._steps + np.arange(_BLOCK * self._steps, dtype=np.float64)
        effects = self._ground.block(self._settings.step * steps)
        self._effects = effects.reshape(_BLOCK, self._steps, EFFECTS)
        self._errors, self._held = self._sensing.block(self._sample_time * samples)


def _steps_per_sample(sample_time: float, step: float) -> int:
    steps = whole_steps(sample_time, step)
    if not steps:
        raise ConfigurationError(
            f"the sample time {sample_time} s is not a positive multiple of the simulated machine's step of "
            f"{step} s; change that step so that it divides the sample time"
        )
    return steps


def _within(name: str, value: float, limit: float, unit: str) -> None:
    """Refuse a command beyond ±limit, or not a number."""
    if not (abs(value) <= limit):
        raise HardwareError(
            f"the simulated machine was commanded {name} = {value} {unit}; it accepts finite values within "
            f"±{limit:.6g} {unit}. Pass commands through the command gate, or change the limits"
        )


def _trailer_antenna(
    vehicle: VehicleParameters, x: float, y: float, theta: float, psi: float, joint: float
) -> tuple[float, float]:
    """Return the position of the trailer's antenna, m; joint = phi - psi."""
    phi, length = psi + joint, vehicle.trailer_length - vehicle.trailer_antenna
    a, d = vehicle.free_joint_offset, vehicle.drawbar_length
    return (
        x - a * math.cos(theta) - d * math.cos(phi) - length * math.cos(psi),
        y - a * math.sin(theta) - d * math.sin(phi) - length * math.sin(psi),
    )


def _rounded(angle: float, resolution: float) -> float:
    return resolution * round(angle / resolution)
