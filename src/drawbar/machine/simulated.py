"""The simulated machine: moves the true world from sample to sample, reports it through faulty sensors."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from drawbar.codegen import CompiledRecurrence
from drawbar.errors import ConfigurationError, HardwareError
from drawbar.geometry import Floats, arm_offset
from drawbar.machine.attitude import ANGLES, Attitude
from drawbar.machine.base import Machine
from drawbar.machine.floating import Floating
from drawbar.machine.ground import Ground
from drawbar.machine.history import History, Moment
from drawbar.machine.plant import COMMANDS, EFFECTS, plant_constants, plant_step
from drawbar.machine.sensing import Sensing
from drawbar.machine.settings import (
    AttitudeSensorSettings,
    SimulatedMachineSettings,
    whole_steps,
)
from drawbar.machine.terrain import Terrain
from drawbar.signals import Command, FixQuality, Measurement, Pose, Truth
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
        self._plant = CompiledRecurrence(plant_step(), self._steps)
        self._plant.constants[:] = plant_constants(self._vehicle, settings)
        self._state, self._inputs, self._states = self._plant.state, self._plant.inputs, self._plant.states
        self._state[:4] = start.x, start.y, start.yaw, start.yaw
        delay = whole_steps(settings.actuators.dead_time, settings.step) or 0
        self._commands = np.zeros((delay + self._steps, COMMANDS))
        self._unknown = unknown
        self._sample = 0
        self._fix = [math.nan] * 4
        self._settle(seed)
        self._newest = (0.0, 0.0, 0.0)
        self._begun = False
        self._draw()

    def _settle(self, seed: int) -> None:
        """Let the machine stand on its ground. The randomness of all this is apart from what was there before it."""
        settings, first = self._settings, np.array(self._state)
        terrain_rng, history_rng, self._attitude_rng, floating_rng = (
            np.random.default_rng((seed, stream)) for stream in range(1, 5)
        )
        self._terrain = Terrain(settings.terrain, terrain_rng)
        self._attitude = Attitude(self._vehicle, settings.bodies, self._terrain, settings.step, first)
        self._history = History(settings.step, np.concatenate((first, self._attitude.angles)), history_rng)
        self._floating = Floating(settings.events, self._sample_time, floating_rng)

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
        self._inputs[:, :COMMANDS] = self._commands[: self._steps]
        self._inputs[:, COMMANDS:] = self._effects[self._sample % _BLOCK]
        self._inputs[:, COMMANDS + 2 : COMMANDS + 5] += self._creep()
        if self._unknown is not None:
            self._inputs[:, COMMANDS : COMMANDS + 5] += self._unknown()
        self._plant()
        self._state[:] = self._states[-1]
        self._remember()
        self._sample += 1
        if self._sample % _BLOCK == 0:
            self._draw()

    def _creep(self) -> tuple[float, float, float]:
        """Return what the slope adds to b, alpha_r and alpha_i now, rad."""
        creep, across = self._settings.terrain.creep, self._terrain.across
        tractor, trailer = creep * across(self._state[2]), creep * across(self._state[3])
        return tractor, tractor, trailer

    def _remember(self) -> None:
        """Let the bodies settle on the ground, and keep all that sensors may report late."""
        states, flat = np.array(self._states), self._settings.terrain.is_flat
        angles = np.zeros((len(states), ANGLES)) if flat else self._attitude.advance(states)
        self._history.append(np.hstack((states, angles)))

    def truth(self) -> Truth:
        """Return the true state, and the slips that begin to act now; b includes the push of a side slope."""
        x, y, yaw, trailer_yaw, joint, steering, speed, *_ = self._state.tolist()
        mu, kappa, *slides = self._effects[self._sample % _BLOCK, 0, :5].tolist()
        offset, tractor_crab, trailer_crab = map(sum, zip(slides, self._creep(), strict=True))
        tractor_roll, tractor_pitch, trailer_roll, trailer_pitch = self._attitude.angles.tolist()
        trailer_x, trailer_y = _trailer_point(self._vehicle, x, y, yaw, trailer_yaw, joint)
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
            tractor_roll=tractor_roll,
            tractor_pitch=tractor_pitch,
            trailer_roll=trailer_roll,
            trailer_pitch=trailer_pitch,
        )

    def _sense(self) -> Measurement:
        """Look at the world through the sensors."""
        settings, errors = self._settings, self._errors[self._sample % _BLOCK].tolist()
        delays, resolution = settings.delays, settings.sensors.steering_resolution
        fixes = self._find(errors)
        hitch, speed, steering = map(self._history.seen, (delays.hitch_angle, delays.speed, delays.steering))
        told = delays.told
        return Measurement(
            time=self._sample * self._sample_time,
            hitch_angle=hitch.yaw - hitch.trailer_yaw - hitch.joint + errors[4],
            speed=speed.speed + errors[5],
            tractor_steering=_rounded(steering.steering + errors[6], resolution),
            trailer_steering=_rounded(steering.joint + errors[7], resolution),
            hitch_angle_age=told * hitch.age,
            speed_age=told * speed.age,
            tractor_steering_age=told * steering.age,
            trailer_steering_age=told * steering.age,
            **fixes,
            **self._balance("tractor", settings.attitude.tractor),
            **self._balance("trailer", settings.attitude.trailer),
        )

    def _find(self, errors: list[float]) -> dict[str, Any]:
        """Return what both receivers report: position, age, deviation, quality."""
        delays, sensors = self._settings.delays, self._settings.sensors
        seen = [self._history.seen(delays.fix) for _ in range(2)]
        true = [*self._antenna("tractor", seen[0]), *self._antenna("trailer", seen[1])]
        floating, deviations = (each.tolist() for each in self._floating.sample(self._sample * self._sample_time))
        for i, held in enumerate(self._held[self._sample % _BLOCK]):
            error = errors[i] if math.isnan(floating[i] + errors[i]) else floating[i]
            self._fix[i] = self._fix[i] if held else true[i] + error
        report: dict[str, Any] = {}
        for i, body in enumerate(("tractor", "trailer")):
            report[f"{body}_x"], report[f"{body}_y"] = self._fix[2 * i : 2 * i + 2]
            report[f"{body}_fix_age"] = delays.told * seen[i].age
            in_float = not math.isnan(deviations[2 * i])
            if in_float or sensors.quality:
                report[f"{body}_fix_quality"] = FixQuality.FLOAT if in_float else FixQuality.FIXED
                report[f"{body}_fix_deviation"] = deviations[2 * i] if in_float else sensors.position
        return report

    def _antenna(self, body: str, seen: Moment) -> tuple[float, float]:
        """Return where a body's antenna truly was, m."""
        stated, wrong = getattr(self._vehicle.masts, body), getattr(self._settings.masts, body)
        arm = (stated.forward + wrong.forward, stated.left + wrong.left, stated.up + wrong.up)
        if body == "tractor":
            point, angles = (seen.x, seen.y), (seen.yaw, seen.tractor_roll, seen.tractor_pitch)
        else:
            point = _trailer_point(self._vehicle, seen.x, seen.y, seen.yaw, seen.trailer_yaw, seen.joint)
            angles = seen.trailer_yaw, seen.trailer_roll, seen.trailer_pitch
        east, north = arm_offset(*angles, arm)
        return point[0] + east, point[1] + north

    def _balance(self, body: str, sensor: AttitudeSensorSettings) -> dict[str, Any]:
        """Return what a body's attitude sensor reports; nothing where there is none."""
        if not sensor.present:
            return {}
        delays = self._settings.delays
        seen, noise = self._history.seen(delays.attitude), self._attitude_rng.standard_normal(3).tolist()
        return {
            f"{body}_roll": getattr(seen, f"{body}_roll") + sensor.roll_bias + sensor.noise * noise[0],
            f"{body}_pitch": getattr(seen, f"{body}_pitch") + sensor.pitch_bias + sensor.noise * noise[1],
            f"{body}_yaw_rate": getattr(seen, f"{body}_yaw_rate")
            + sensor.yaw_rate_bias
            + sensor.yaw_rate_noise * noise[2],
            f"{body}_attitude_age": delays.told * seen.age,
        }

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


def _trailer_point(
    vehicle: VehicleParameters, x: float, y: float, theta: float, psi: float, joint: float
) -> tuple[float, float]:
    """Return the position of the trailer's tracked point, m; joint = phi - psi."""
    phi, length = psi + joint, vehicle.trailer_length - vehicle.trailer_antenna
    a, d = vehicle.free_joint_offset, vehicle.drawbar_length
    return (
        x - a * math.cos(theta) - d * math.cos(phi) - length * math.cos(psi),
        y - a * math.sin(theta) - d * math.sin(phi) - length * math.sin(psi),
    )


def _rounded(angle: float, resolution: float) -> float:
    return resolution * round(angle / resolution)
