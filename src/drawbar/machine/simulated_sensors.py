"""Simulated sensors of a machine in a computer: its true past in, a measurement out."""

import math
from typing import Any, Protocol

import numpy as np

from drawbar.geometry import Floats, arm_offset, wrap
from drawbar.machine.events import Event
from drawbar.machine.floating import Floating
from drawbar.machine.history import BodyMoment, History
from drawbar.machine.sensor_errors import SensorErrors
from drawbar.machine.sensor_settings import (
    AttitudeSensors,
    AttitudeSensorSettings,
    DelaySettings,
    MastErrors,
    SensorSettings,
)
from drawbar.signals import FixQuality, Measurement
from drawbar.vehicle.parameters import VehicleParameters


class SensorSections(Protocol):
    """The sections of a machine's settings about its sensors."""

    @property
    def sensors(self) -> SensorSettings: ...  # noqa: D102 -- as in the settings
    @property
    def masts(self) -> MastErrors: ...  # noqa: D102
    @property
    def attitude(self) -> AttitudeSensors: ...  # noqa: D102
    @property
    def delays(self) -> DelaySettings: ...  # noqa: D102
    @property
    def events(self) -> tuple[Event, ...]: ...  # noqa: D102


class SimulatedSensors:
    """All sensors; each kind draws its errors from a stream of its own, so that another kind leaves them alone."""

    def __init__(
        self,
        *,
        vehicle: VehicleParameters,
        settings: SensorSections,
        sample_time: float,
        rng: np.random.Generator,
        attitude_rng: np.random.Generator,
        floating_rng: np.random.Generator,
    ) -> None:
        """Put the sensors on a vehicle; nothing is measured before the first draw().

        Args:
            vehicle: as it truly is; its masts as they are stated.
            settings: of the sensors.
            sample_time: s.
            rng: of positions, hitch angle, speed and steering.
            attitude_rng: of roll, pitch, yaw rate and yaw.
            floating_rng: of fixes in float.
        """
        self._sensors, self._delays, self._sample_time = settings.sensors, settings.delays, sample_time
        attitude = {"tractor": settings.attitude.tractor, "trailer": settings.attitude.trailer}
        self._attitude = {body: sensor for body, sensor in attitude.items() if sensor.present}
        self._yaw = settings.attitude.yaw
        self._arms = {
            body: tuple(
                getattr(getattr(vehicle.masts, body), axis) + getattr(getattr(settings.masts, body), axis)
                for axis in ("forward", "left", "up")
            )
            for body in ("tractor", "trailer")
        }
        self._noise = SensorErrors(settings.sensors, settings.events, sample_time, rng)
        self._floating = Floating(settings.events, sample_time, floating_rng)
        self._attitude_rng = attitude_rng
        self._fix = [math.nan] * 4

    def draw(self, samples: Floats) -> None:
        """Draw the errors of the next block of samples (n,), given by their numbers."""
        errors, held = self._noise.block(self._sample_time * samples)
        self._errors, self._held = errors.tolist(), held.tolist()

    def measure(self, sample: int, history: History) -> Measurement:
        """Look at the machine through the sensors, as it was when each of them looked."""
        delays, errors = self._delays, self._errors[sample % len(self._errors)]
        report = self._find(sample, errors, history)
        hitch_error, speed_error, wheels_error, joint_error = errors[4:]
        hitch, speed, steering = map(history.seen, (delays.hitch_angle, delays.speed, delays.steering))
        reported, resolution = delays.reported, self._sensors.steering_resolution
        for body, sensor in self._attitude.items():
            report |= self._balance(body, sensor, history)
        if self._yaw.present:
            report |= self._direction(history)
        return Measurement(
            time=sample * self._sample_time,
            hitch_angle=hitch.hitch_angle + hitch_error,
            speed=speed.speed + speed_error,
            tractor_steering=_rounded(steering.steering + wheels_error, resolution),
            trailer_steering=_rounded(steering.joint + joint_error, resolution),
            hitch_angle_age=reported * hitch.age,
            speed_age=reported * speed.age,
            tractor_steering_age=reported * steering.age,
            trailer_steering_age=reported * steering.age,
            **report,
        )

    def _find(self, sample: int, errors: list[float], history: History) -> dict[str, Any]:
        """Return what both receivers report: position, age, deviation, quality."""
        delays, sensors, fix = self._delays, self._sensors, self._fix
        tractor, trailer = history.seen(delays.fix), history.seen(delays.fix)
        true = (*self._antenna("tractor", tractor.tractor), *self._antenna("trailer", trailer.trailer))
        floating, deviations = self._floating.sample(sample * self._sample_time)
        for i, held in enumerate(self._held[sample % len(self._held)]):
            if not held:
                fix[i] = true[i] + (errors[i] if math.isnan(floating[i] + errors[i]) else floating[i])
        report: dict[str, Any] = {
            "tractor_x": fix[0],
            "tractor_y": fix[1],
            "trailer_x": fix[2],
            "trailer_y": fix[3],
            "tractor_fix_age": delays.reported * tractor.age,
            "trailer_fix_age": delays.reported * trailer.age,
        }
        for body, deviation in zip(("tractor", "trailer"), deviations[::2], strict=True):
            in_float = not math.isnan(deviation)
            if in_float or sensors.quality:
                report[f"{body}_fix_quality"] = FixQuality.FLOAT if in_float else FixQuality.FIXED
                report[f"{body}_fix_deviation"] = deviation if in_float else sensors.position
        return report

    def _antenna(self, body: str, seen: BodyMoment) -> tuple[float, float]:
        """Return where a body's antenna truly was, m."""
        east, north = arm_offset(seen.yaw, seen.roll, seen.pitch, self._arms[body])
        return seen.x + east, seen.y + north

    def _balance(self, body: str, sensor: AttitudeSensorSettings, history: History) -> dict[str, Any]:
        """Return what a body's attitude sensor reports."""
        delays, noise = self._delays, self._attitude_rng.standard_normal(3).tolist()
        moment = history.seen(delays.attitude)
        seen: BodyMoment = getattr(moment, body)
        return {
            f"{body}_roll": seen.roll + sensor.roll_bias + sensor.noise * noise[0],
            f"{body}_pitch": seen.pitch + sensor.pitch_bias + sensor.noise * noise[1],
            f"{body}_yaw_rate": seen.yaw_rate + sensor.yaw_rate_bias + sensor.yaw_rate_noise * noise[2],
            f"{body}_attitude_age": delays.reported * moment.age,
        }

    def _direction(self, history: History) -> dict[str, Any]:
        """Return what the tractor's two antennas report."""
        moment, noise = history.seen(self._delays.attitude), self._attitude_rng.standard_normal()
        return {
            "tractor_yaw": wrap(moment.tractor.yaw + self._yaw.bias + self._yaw.noise * noise),
            "tractor_attitude_age": self._delays.reported * moment.age,
        }


def _rounded(angle: float, resolution: float) -> float:
    return resolution * round(angle / resolution)
