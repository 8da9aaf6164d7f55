"""Stand-in of a bare valve's board: a motor with a dead band turns the front wheels as commanded, at ticks."""

import math

import numpy as np

from drawbar.machine.hardware.bare_valve_settings import BareValveSettings
from drawbar.machine.stand_in.wheel import MotorWheel
from drawbar.protocols.bare_valve import HOLDS, commanded_drives
from drawbar.protocols.own_sentence import SentenceReader, own_sentence

_PWM = 255.0
DEAD_BAND = 38.0 / _PWM
FULL_RATE = math.radians(25.0)
"""rad/s"""
LAG = 0.1
"""s"""


class StandInBareValve:
    """The board with its motor; `permitted` is what a test sets."""

    def __init__(self, settings: BareValveSettings) -> None:
        """Take the sensor's true table."""
        rising = settings.angles[0] < settings.angles[-1]
        self._table = (settings.angles, settings.counts) if rising else (settings.angles[::-1], settings.counts[::-1])
        self._wheel = MotorWheel(rate=FULL_RATE, lag=LAG, stiction=round(DEAD_BAND * _PWM))
        self._sentences = SentenceReader("PDBD")
        self._drive, self._commanded = 0.0, -math.inf
        self.permitted = True
        """the operator holds the switch"""

    def receive(self, time: float, data: bytes) -> None:
        """Take in commands at a time, s."""
        for drive in commanded_drives(self._sentences, data):
            self._drive, self._commanded = drive, time

    def turn(self, time: float, angle: float, duration: float) -> float | None:
        """Turn the wheels from a time (s) on for a duration (s); return where they are, rad; None: no command.

        Args:
            time: s.
            angle: of the wheels, which others have turned while nothing was commanded, rad.
            duration: s.
        """
        if time - self._commanded > HOLDS:
            self._wheel.place(angle)
            return None
        self._wheel.turn(_PWM * self._drive if self.permitted else 0.0, duration)
        return self._wheel.angle

    def report(self, time: float) -> bytes:
        """Return what it reports at a time, s."""
        counts = round(float(np.interp(self._wheel.angle, *self._table)))
        return own_sentence("PDBV", round(time * 1e3), counts, int(self.permitted))
