"""Speed command: the speed that drawbar asks of a machine that takes one over ISOBUS (0xFD43)."""

import math
from collections import Counter

from drawbar.errors import ConfigurationError
from drawbar.protocols.isobus.cadence import Cadence
from drawbar.protocols.isobus.node import IsobusNode
from drawbar.protocols.isobus.tractor_messages import SELECTED_SPEED_COMMAND, encode_speed_command
from drawbar.transports.base import CanFrame

_PERIOD = 0.1
_LARGEST = 64.0
"""m/s; the field holds 64.255"""


class SpeedCommand:
    """Set points at 10 Hz under a node's address; the caller makes the ramp and takes the node's own frames.

    No set point (None) is said as "not available", out of turn where there was one, never by silence. After a set
    point that is not allowed, or the loss of the address, nothing else is said until the caller has asked for none, or
    to stand.

    Raises:
        ConfigurationError: the limit is no speed that the field can hold

    """

    def __init__(self, node: IsobusNode, limit: float) -> None:
        if not (0.0 < limit <= _LARGEST):
            raise ConfigurationError(f"speed limit {limit} m/s: allowed are more than 0 and up to {_LARGEST} m/s")
        self.dropped: Counter[str] = Counter()
        self._node, self._limit = node, limit
        self._cadence = Cadence(_PERIOD)
        self._released = self._driving = False
        self._losses = node.claim.losses

    @property
    def is_sent(self) -> bool:
        """Whether the last command held a set point."""
        return self._driving

    def send(self, time: float, speed: float | None, *, stops: bool = False) -> list[CanFrame]:
        """Return the command that is due.

        Args:
            time: monotonic, s.
            speed: set point, m/s, reverse negative, or None for none.
            stops: whether it is part of a stop: then 0 asks to stand.
        """
        at_once = self._driving and not self._allowed(time, speed)
        if at_once or self._losses != self._node.claim.losses:
            self._driving = self._released = False
            self._losses = self._node.claim.losses
        if not self._node.claim.held:
            return []
        if at_once:
            self._cadence.restart(time)
        elif not self._cadence.due(time):
            return []
        return [self._command(time, speed, stands=stops and speed == 0.0)]

    def _command(self, time: float, speed: float | None, *, stands: bool) -> CanFrame:
        set_point, self._released = math.nan, self._released or stands
        if speed is None:
            self._released, self._driving = True, False
        elif self._released and self._allowed(time, speed):
            self._driving, set_point = True, speed
        else:
            self._released = self._driving = False
        return self._node.frame(SELECTED_SPEED_COMMAND, encode_speed_command(set_point, self._limit))

    def _allowed(self, time: float, speed: float | None) -> bool:
        if speed is None or not self._node.usable(time):
            return False
        if not (abs(speed) <= self._limit):
            self.dropped["set point out of range"] += 1
            return False
        return True
