"""Stream of one receiver, the whole way from bytes to epochs: framing, decoding, assembly. Pure; time is given."""

import math
from collections import Counter

from drawbar.protocols.gnss.assembly import Assembler
from drawbar.protocols.gnss.decoding import Decoder
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.framing import Frame, Framer
from drawbar.protocols.gnss.settings import EpochSettings

BROKEN_OFF = 0.05
"""a frame that has begun is given up after so long without a byte, s: longer than any adapter holds bytes back"""


class EpochStream:
    """One receiver's bytes in, its epochs out. Call `poll` not later than at `due`."""

    def __init__(self, settings: EpochSettings) -> None:
        self._framer = Framer()
        self._decoder = Decoder(settings.leap_seconds)
        self._assembler = Assembler(settings)
        self._last_byte = -math.inf
        self.kinds: Counter[str] = Counter()
        """messages understood, by kind"""

    @property
    def dropped(self) -> Counter[str]:
        """What became of no epoch so far, by kind."""
        return self._framer.dropped + self._decoder.dropped + self._assembler.dropped

    @property
    def frozen(self) -> int:
        """Epochs in a row that came with the time of the one before."""
        return self._assembler.frozen

    @property
    def due(self) -> float:
        """Monotonic time at which `poll` may have something to do, infinite while there is nothing, s."""
        if self._assembler.is_open:
            return self._last_byte + self._assembler.silence
        return self._last_byte + BROKEN_OFF if self._framer.is_waiting else math.inf

    def push(self, data: bytes, time: float) -> list[Epoch]:
        """Take bytes that were read at a monotonic time (s), and return the epochs that they end.

        A silence before them ends nothing: who reads late finds bytes that have long been there. Only `poll` is sure.
        """
        self._last_byte = time if data else self._last_byte
        return self._epochs(self._framer.push(data, time))

    def poll(self, time: float) -> list[Epoch]:
        """Return the epochs that a silence until this monotonic time (s), when nothing is left to read, has ended."""
        ended: list[Epoch] = []
        if self._framer.is_waiting and time >= self._last_byte + BROKEN_OFF:
            ended += self._epochs(self._framer.settle())
        if self._assembler.is_open and time >= self._last_byte + self._assembler.silence:
            ended += self._assembler.close()
        return ended

    def _epochs(self, frames: list[Frame]) -> list[Epoch]:
        ended: list[Epoch] = []
        for frame in frames:
            message = self._decoder.decode(frame)
            if message is not None:
                self.kinds[message.kind] += 1
                ended += self._assembler.add(message, frame.time)
        return ended
