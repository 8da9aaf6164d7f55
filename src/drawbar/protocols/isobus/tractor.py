"""Tractor: speeds, hitches and power take-offs that a machine reports on its bus, each with its age."""

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

from drawbar.protocols.isobus.identifier import Message
from drawbar.protocols.isobus.node import Component
from drawbar.protocols.isobus.tractor_messages import (
    FRONT_HITCH,
    FRONT_PTO,
    GROUND_SPEED,
    REAR_HITCH,
    REAR_PTO,
    SELECTED_SPEED,
    WHEEL_SPEED,
    Hitch,
    PowerTakeOff,
    SelectedSpeed,
    WheelOrGroundSpeed,
    decode_hitch,
    decode_power_take_off,
    decode_selected_speed,
    decode_speed,
)

Reading = WheelOrGroundSpeed | SelectedSpeed | Hitch | PowerTakeOff
_GROUPS: dict[int, tuple[str, Callable[[bytes], Reading | None]]] = {
    WHEEL_SPEED: ("wheel speed", decode_speed),
    GROUND_SPEED: ("ground speed", decode_speed),
    SELECTED_SPEED: ("selected speed", decode_selected_speed),
    REAR_HITCH: ("rear hitch", decode_hitch),
    FRONT_HITCH: ("front hitch", decode_hitch),
    REAR_PTO: ("rear PTO", decode_power_take_off),
    FRONT_PTO: ("front PTO", decode_power_take_off),
}
"""facilities by their message: name and reader"""
_TIMEOUT = 0.3
"""without its message, after which a facility is lost, s; at 10 Hz three are missed"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedReading:
    """One speed and when it came."""

    speed: float = math.nan
    """m/s, reverse negative; NaN: never received, not available, in error, or of no direction"""
    time: float = -math.inf
    """monotonic time at which it was received, s; -inf: never"""


class Tractor(Component):
    """The tractor's own messages; attach it to a node, or hand it messages of a bus on which drawbar only listens.

    Each facility is taken from the sender that was heard first, until that one falls silent.
    """

    def __init__(self) -> None:
        self.dropped: Counter[str] = Counter()
        """messages of a wrong length, and of a second sender"""
        self._readings: dict[str, tuple[float, Reading]] = {}
        self._sources: dict[str, int] = {}

    def receive_message(self, time: float, message: Message) -> None:
        """Take in one message."""
        if message.pgn not in _GROUPS:
            return
        name, decode = _GROUPS[message.pgn]
        reading = decode(message.data)
        if reading is None:
            self.dropped["length"] += 1
            return
        if self._is_present(name, time) and self._sources[name] != message.source:
            self.dropped["second sender"] += 1
            return
        self._sources[name] = message.source
        self._readings[name] = time, reading

    def speed(self, name: str) -> SpeedReading:
        """Return the latest "wheel speed", "ground speed" or "selected speed"; its age is for the caller to judge."""
        time, reading = self._readings.get(name, (-math.inf, None))
        if not isinstance(reading, WheelOrGroundSpeed | SelectedSpeed):
            return SpeedReading()
        return SpeedReading(speed=reading.speed, time=time)

    def reading(self, name: str, time: float) -> Reading | None:
        """Return the latest reading of a facility, None while it is lost."""
        return self._readings[name][1] if self._is_present(name, time) else None

    def _is_present(self, name: str, time: float) -> bool:
        return name in self._readings and time - self._readings[name][0] <= _TIMEOUT
