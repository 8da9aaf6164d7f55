"""Recent: the samples of the last seconds."""

from collections import deque
from typing import TypeVar

T = TypeVar("T")


class Recent(deque[T]):
    """Drops its oldest sample for each that is added once it is full."""

    def __init__(self, span: float, sample_time: float, *, least: int = 1) -> None:
        """Begin without a sample, for those of a span, s, but `least` at least; `sample_time` in s."""
        self._size = max(round(span / sample_time), least)
        super().__init__(maxlen=self._size)

    @property
    def is_full(self) -> bool:
        """Whether it covers its span."""
        return len(self) == self._size
