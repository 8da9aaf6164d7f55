"""Sensor board: counts of the hitch angle's sensor and of the wheels' encoder, in one sentence of NMEA's form. Pure.

`$PDBS,MS,HITCH,PULSES*hh` CR LF: the board's own milliseconds (32 bits, wrapping), counts of the hitch's converter,
pulses of the encoder since the start (16 or 32 bits, wrapping); what the board has not is empty. Any small board with a
converter and a counter can send it, 10 to 50 times a second.
"""

import math
from collections import Counter
from dataclasses import dataclass

from drawbar.protocols.own_sentence import SentenceReader, own_sentence, whole_number
from drawbar.protocols.sensors import AngleSensor, Encoder, SensorFault, WheelSpeed

_WRAP = 2**32
"""ms"""
_RESTARTED = 5
"""reports in a row that are not after the last one come from a board that has restarted"""
_DRIFT = 0.006
"""by which a board's clock may be slow: a ceramic resonator is wrong by 0.5 %"""
_STOPPED = 2.0
"""delay beyond which the board's clock has stood still rather than its line become so slow, s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorReport:
    """What the board reported at one instant; NaN: it has no such sensor, or the sensor has a fault."""

    time: float
    """monotonic time at which it was measured, as far as the delay has changed, s"""
    received: float
    """monotonic time at which it came, s"""
    hitch_angle: float = math.nan
    """rad"""
    wheel_speed: float = math.nan
    """m/s, forward positive"""


class _BoardClock:
    """The board's time in the monotonic clock: as ReceiverClock, but of a clock that may be as wrong as `_DRIFT`.

    The constant part of the delay is not observable; a line that becomes slower, or reports in bursts, is seen.
    """

    def __init__(self) -> None:
        self._least, self._received = math.inf, math.inf  # delay, and time of the last report, s

    def measured(self, stamp: float, received: float) -> float:
        """Return when a report was measured, given the board's time and when it came, s."""
        delay = received - stamp
        self._least = min(delay, self._least + _DRIFT * max(received - self._received, 0.0))
        self._received = received
        if delay - self._least > _STOPPED:
            self._least = delay
        return stamp + self._least


class SensorBoard:
    """One board's bytes in, reports out. Whatever comes, nothing raises; `dropped` counts what was not understood."""

    def __init__(self, hitch: AngleSensor | None, encoder: Encoder | None) -> None:
        """Take the calibration of the sensors that it has."""
        self._hitch, self._wheel = hitch, WheelSpeed(encoder) if encoder else None
        self._sentences = SentenceReader("PDBS")
        self._clock = _BoardClock()
        self._stamp: float | None = None  # the board's time since its first report, s
        self._last = self._not_after = 0
        self.faults: Counter[str] = Counter()
        """readings with a fault, by sensor and fault"""

    @property
    def dropped(self) -> Counter[str]:
        """What was not understood, by kind."""
        return self._sentences.dropped

    def push(self, data: bytes, time: float) -> list[SensorReport]:
        """Take bytes that came at a monotonic time, s; return the reports that they end."""
        reports = [self._report(fields, time) for fields in self._sentences.push(data)]
        return [report for report in reports if report is not None]

    def _report(self, fields: list[bytes], time: float) -> SensorReport | None:
        try:
            milliseconds, counts, pulses = map(whole_number, fields)
        except ValueError:
            self.dropped["not three whole numbers"] += 1
            return None
        if milliseconds is None:
            self.dropped["no time"] += 1
            return None
        if self._comes_late(milliseconds):
            self.dropped["not after the one before"] += 1
            return None
        stamp = self._advance(milliseconds)
        return SensorReport(
            time=self._clock.measured(stamp, time),
            received=time,
            hitch_angle=self._hitch_angle(counts),
            wheel_speed=self._wheel_speed(stamp, pulses),
        )

    def _comes_late(self, milliseconds: int) -> bool:
        """Whether a report was overtaken on its way, or came before, as datagrams may."""
        after = self._stamp is None or 0 < (milliseconds - self._last) % _WRAP < _WRAP // 2
        self._not_after = 0 if after else self._not_after + 1
        return 0 < self._not_after < _RESTARTED

    def _hitch_angle(self, counts: int | None) -> float:
        if self._hitch is None or counts is None:
            return math.nan
        reading = self._hitch.read(counts)
        return self._noted("hitch", reading.value, reading.fault)

    def _advance(self, milliseconds: int) -> float:
        """Return the board's time since its first report, s."""
        step = (milliseconds - self._last) % _WRAP
        self._stamp = 0.0 if self._stamp is None else self._stamp + step * 1e-3
        self._last = milliseconds
        return self._stamp

    def _wheel_speed(self, stamp: float, pulses: int | None) -> float:
        if self._wheel is None or pulses is None:
            return math.nan
        reading = self._wheel.read(stamp, pulses)
        return self._noted("wheel", reading.value, reading.fault)

    def _noted(self, sensor: str, value: float, fault: SensorFault) -> float:
        if fault is not SensorFault.NONE:
            self.faults[f"{sensor} {fault.value}"] += 1
        return value


def sentence(milliseconds: int, counts: int | None, pulses: int | None) -> bytes:
    """Return the sentence that a board sends."""
    return own_sentence("PDBS", milliseconds % _WRAP, counts, pulses)
