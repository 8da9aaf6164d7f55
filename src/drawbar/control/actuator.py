"""From a planned steering rate to the command that makes a lagging actuator follow it."""

import math


class SteeringActuator:
    """A first-order lag delta' = (u - delta) / tau, whose command u is held over a sample."""

    def __init__(self, *, lag: float, limit: float, sample_time: float, sign: int = 1) -> None:
        """Take tau (s), the largest command (rad), the sample time (s), -1 if the actuator is reversed."""
        self._lead = sample_time / (1.0 - math.exp(-sample_time / lag))
        self._limit, self._sign = limit, sign

    def command(self, steering: float, rate: float) -> float:
        """Return the command (rad) after which the steering (rad) has moved by rate (rad/s) times the sample time.

        The command ends at the limit, which the lag then approaches from inside.
        """
        wanted = self._sign * (steering + self._lead * rate)
        return math.copysign(min(abs(wanted), self._limit), wanted) if math.isfinite(wanted) else wanted

    def rate(self, steering: float, command: float) -> float:
        """Return the mean rate (rad/s) over a sample by which the steering (rad) follows a command (rad)."""
        return (self._sign * command - steering) / self._lead
