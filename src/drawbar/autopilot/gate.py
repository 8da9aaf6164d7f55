"""The last look at a command before it leaves: small, and independent of all that made it."""

import math
from dataclasses import replace

from drawbar.signals import Command


class CommandGate:
    """Lets finite commands within the limits pass; otherwise repeats the last one that passed."""

    def __init__(self, *, tractor_limit: float, trailer_limit: float, speed_limit: float) -> None:
        """Take the largest steering angles (rad) and speed (m/s) that may leave."""
        self._limits = (tractor_limit, trailer_limit, speed_limit)
        self._last = Command(time=math.nan, tractor_steering=0.0, trailer_steering=0.0, speed=0.0)

    def check(self, command: Command) -> Command:
        """Return the very command, or the last valid one at this command's time."""
        values = (command.tractor_steering, command.trailer_steering, command.speed)
        # `not (|x| <= limit)` also catches NaN, which would walk through a clamp
        if any(not (abs(value) <= limit) for value, limit in zip(values, self._limits, strict=True)):
            return replace(self._last, time=command.time)
        self._last = command
        return command
