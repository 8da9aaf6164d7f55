"""Device rates: how often each device reports to the console, and the age of its last report. Time is given."""

import math
from collections import deque
from dataclasses import dataclass

from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.messages import ControllerState, Fixes, GateState
from drawbar.signals import FixQuality

_WINDOW = 3_000_000_000
"""over which rates are counted, ns"""
DEVICES = (
    "tractor_receiver",
    "trailer_receiver",
    "hitch_sensor",
    "wheel_sensor",
    "tractor_steering_sensor",
    "trailer_steering_sensor",
    "controller",
    "gate",
)
"""in the order in which they are listed; `corrections` follow with their age alone"""


def missing(devices: DeviceSettings | None) -> set[str]:
    """Return which of DEVICES a machine does not have, so that nobody waits for them."""
    if devices is None:
        return set()
    sensors = devices.sensors
    found = {
        "trailer_receiver": devices.trailer_receiver is None,
        "hitch_sensor": sensors is None or not sensors.measures_hitch,
        "wheel_sensor": sensors is None or sensors.pulses_per_metre is None,
    }
    return {name for name, is_missing in found.items() if is_missing}


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviceState:
    """One device."""

    name: str
    rate: float
    """words, 1/s; 0: none in the last seconds"""
    age: float
    """of its last word, s; NaN: there was none"""


class DeviceRates:
    """Counts the words of each device by the stamps in the drive's messages."""

    def __init__(self) -> None:
        """Begin with nothing received."""
        self._stamps: dict[str, deque[int]] = {name: deque() for name in DEVICES}
        self._correction_age = math.nan

    def receive(self, message: Fixes | ControllerState | GateState, now: int) -> None:
        """Take in a message at a time, ns."""
        if isinstance(message, Fixes):
            none = (FixQuality.UNKNOWN, FixQuality.NONE)
            for name, report in (("tractor_receiver", message.tractor), ("trailer_receiver", message.trailer)):
                self._stamp(name, 0 if report.quality in none else message.epoch, now)
            self._stamp("hitch_sensor", message.hitch_angle_time, now)
            self._stamp("wheel_sensor", message.wheel_speed_time, now)
        elif isinstance(message, ControllerState):
            self._correction_age = message.correction_age
            self._stamp("controller", message.time, now)
        else:
            self._stamp("tractor_steering_sensor", message.tractor_angle_time, now)
            self._stamp("trailer_steering_sensor", message.trailer_angle_time, now)
            self._stamp("gate", message.time, now)

    def _stamp(self, name: str, time: int, now: int) -> None:
        """Keep a stamp that is new; ns."""
        stamps = self._stamps[name]
        if time and (not stamps or time > stamps[-1]):
            stamps.append(time)
        while len(stamps) > 1 and now - stamps[0] > _WINDOW:
            stamps.popleft()

    def states(self, now: int) -> list[DeviceState]:
        """Return all devices as they are at a time, ns."""
        found = [self._state(name, now) for name in DEVICES]
        return [*found, DeviceState(name="corrections", rate=math.nan, age=self._correction_age)]

    def _state(self, name: str, now: int) -> DeviceState:
        recent = [each for each in self._stamps[name] if now - each <= _WINDOW]
        lasted = (recent[-1] - recent[0]) * 1e-9 if len(recent) > 1 else 0.0
        age = (now - self._stamps[name][-1]) * 1e-9 if self._stamps[name] else math.nan
        return DeviceState(name=name, rate=(len(recent) - 1) / lasted if lasted > 0.0 else 0.0, age=age)
