"""When two antennas are to be believed more than the estimate."""

import math


class Trust:
    """Two antennas that agree with each other cannot be locked out by an estimate that is wrong.

    An estimate that both have confirmed for some time is overruled by both only: then it was moved by more than it can
    know (a new base station, a tow). Before that one suffices: its yaw, say, was wrong from the start.
    """

    def __init__(self, patience: float) -> None:
        """Take the time for which it must last, s."""
        self._patience = patience
        self._contradicted = self._confirmed = math.nan  # since when, s; NaN: not now
        self.earned = False
        """whether both antennas have confirmed the estimate for long enough"""

    def overruled(self, time: float, *, agreeing: bool, rejected: int) -> bool:
        """Return whether the estimate has been contradicted for long enough; it then has to earn its trust anew.

        Args:
            time: of the measurement, s.
            agreeing: both antennas have a fix, as far from each other as they should be.
            rejected: how many of the two are rejected.
        """
        self._confirmed = _since(self._confirmed, time, agreeing and rejected == 0)
        self._contradicted = _since(self._contradicted, time, agreeing and rejected > (1 if self.earned else 0))
        if time - self._confirmed >= self._patience:
            self.earned = True
        if time - self._contradicted >= self._patience:
            self.earned, self._contradicted = False, math.nan
            return True
        return False


def _since(start: float, time: float, holds: bool) -> float:
    """Return since when something has held: now, when it just began to, and NaN when it does not."""
    if not holds:
        return math.nan
    return start if math.isfinite(start) else time
