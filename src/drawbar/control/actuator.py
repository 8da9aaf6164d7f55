"""From a planned steering rate to the command that makes a lagging actuator follow it."""

import math


class SteeringActuator:
    """A first-order lag delta' = (u - delta) / tau, whose command u is held over a sample."""

    def __init__(self, *, lag: float, limit: float, sample_time: float, sign: int = 1) -> None:
        """Take tau (s), the largest command (rad), the sample time (s), -1 if the actuator is reversed."""
        self._lead = sample_time / (1.0 - math.exp(-sample_time / lag))
        self._limit, self._sign = limit, sign

    def follow(self, steering: float, rate: float) -> tuple[float, float]:
        """Return the command (rad) that moves the steering at a mean rate over a sample, and the rate that it makes.

        The command ends at the limit, which the lag then approaches from inside: the rate is then a smaller one.

        Args:
            steering: now, rad.
            rate: wanted, rad/s.
        """
        wanted = self._sign * (steering + self._lead * rate)
        command = math.copysign(min(abs(wanted), self._limit), wanted) if math.isfinite(wanted) else wanted
        return command, (self._sign * command - steering) / self._lead
