"""Corrections relay: from the caster to the receivers, and how that is to the operator."""

import math
from collections.abc import Callable, Sequence

from drawbar.driving.messaging.datagrams import CorrectionsFailure, pack
from drawbar.machine.hardware.corrections.corrections import open_corrections
from drawbar.machine.hardware.corrections.receivers import correct
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.hardware.corrections.status import CorrectionsNews
from drawbar.machine.hardware.receiver import Receiver
from drawbar.realtime import say
from drawbar.transports.clock import Clock

_SHOWN = 0.5
"""between two words to the console of how the corrections are, s"""


class CorrectionsRelay:
    """The corrections of one section of the configuration, for all receivers."""

    def __init__(
        self,
        settings: CorrectionsSettings,
        receivers: Sequence[Receiver],
        clock: Clock,
        show: Callable[[bytes], object],
    ) -> None:
        """Open the outlets; `show` sends a datagram to the console."""
        self._corrections = open_corrections(settings, clock)
        self._receivers, self._clock, self._show = receivers, clock, show
        self._news, self._shown = CorrectionsNews(), -math.inf

    def update(self) -> None:
        """Pass on what has come, and say what has changed."""
        correct(self._corrections, self._clock(), self._receivers[0], self._receivers)
        status = self._corrections.status(self._clock())
        for word in self._news.update(status):
            say(f"receivers: {word}")
        if self._clock() >= self._shown + _SHOWN:
            self._shown = self._clock()
            self._show(pack(CorrectionsFailure(status.failure)))

    def close(self) -> None:
        """Close connection and outlets."""
        self._corrections.close()
