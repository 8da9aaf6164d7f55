"""How noisy position fixes really are."""

import math

from drawbar.estimation.antennas import Point


class NoiseLevel:
    """The deviation of one coordinate, from how much the disagreement of two antennas changes between samples.

    Successive differences (von Neumann 1941) do not see what lasts or grows slowly: neither a shifted antenna nor an
    estimate that is off makes the fixes look noisier than they are.
    """

    def __init__(self, memory: int) -> None:
        """Take the number of samples to average over."""
        self._memory = memory
        self._samples, self._mean_square = 0, 0.0
        self._last: Point | None = None

    def update(self, disagreement: Point, limit: float) -> None:
        """Take in by how much (m) both antennas disagree; no more than the limit (m) of a change counts."""
        if self._last is not None:
            change = min(math.dist(disagreement, self._last), limit)
            self._samples = min(self._samples + 1, self._memory)
            self._mean_square += (change * change - self._mean_square) / self._samples
        self._last = disagreement

    def interrupt(self) -> None:
        """Begin a new series: one of the antennas has no fix."""
        self._last = None

    @property
    def deviation(self) -> float:
        """Standard deviation of one coordinate of one antenna, m; zero while nothing is known."""
        return math.sqrt(self._mean_square / 8.0)  # two coordinates of two antennas at two samples
