"""Sensor board: counts of the hitch angle's sensor and of the wheels' encoder, in one sentence of NMEA's form. Pure.

`$PDBS,MS,HITCH,PULSES*hh` CR LF: the board's own milliseconds (32 bits, wrapping), counts of the hitch's converter,
pulses of the encoder since the start (16 or 32 bits, wrapping); what the board has not is empty. Any small board with a
converter and a counter can send it, 10 to 50 times a second.
"""

import math
from collections import Counter
from dataclasses import dataclass

from drawbar.protocols.sensors import Encoder, Potentiometer, SensorFault, WheelSpeed

_LONGEST = 64
"""bytes of a sentence"""
_WRAP = 2**32
"""ms"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorReport:
    """What the board said at one instant; NaN: it has no such sensor, or the sensor has a fault."""

    time: float
    """monotonic time at which it came, s"""
    hitch_angle: float = math.nan
    """rad"""
    wheel_speed: float = math.nan
    """m/s, forward positive"""


class SensorBoard:
    """One board's bytes in, reports out. Whatever comes, nothing raises; `dropped` counts what was not understood."""

    def __init__(self, hitch: Potentiometer | None, encoder: Encoder | None) -> None:
        """Take the calibration of the sensors that it has."""
        self._hitch, self._wheel = hitch, WheelSpeed(encoder) if encoder else None
        self._rest = b""
        self._stamp: float | None = None
        self._last = 0
        self.dropped: Counter[str] = Counter()
        self.faults: Counter[str] = Counter()
        """readings with a fault, by sensor and fault"""

    def push(self, data: bytes, time: float) -> list[SensorReport]:
        """Take bytes that came at a monotonic time, s; return the reports that they end."""
        *lines, rest = (self._rest + data).split(b"\n")
        if len(rest) > _LONGEST:
            self.dropped["too long"] += 1
            rest = b""
        self._rest = rest
        reports = [self._report(line, time) for line in lines]
        return [report for report in reports if report is not None]

    def _report(self, line: bytes, time: float) -> SensorReport | None:
        fields = _fields(line.rstrip(b"\r"))
        if isinstance(fields, str):
            self.dropped[fields] += 1
            return None
        milliseconds, counts, pulses = fields
        return SensorReport(
            time=time,
            hitch_angle=self._hitch_angle(counts),
            wheel_speed=self._wheel_speed(milliseconds, pulses),
        )

    def _hitch_angle(self, counts: int | None) -> float:
        if self._hitch is None or counts is None:
            return math.nan
        reading = self._hitch.read(counts)
        return self._noted("hitch", reading.value, reading.fault)

    def _wheel_speed(self, milliseconds: int, pulses: int | None) -> float:
        step = (milliseconds - self._last) % _WRAP
        self._stamp = 0.0 if self._stamp is None else self._stamp + step * 1e-3
        self._last = milliseconds
        if self._wheel is None or pulses is None:
            return math.nan
        reading = self._wheel.read(self._stamp, pulses)
        return self._noted("wheel", reading.value, reading.fault)

    def _noted(self, sensor: str, value: float, fault: SensorFault) -> float:
        if fault is not SensorFault.NONE:
            self.faults[f"{sensor} {fault.value}"] += 1
        return value


def sentence(milliseconds: int, counts: int | None, pulses: int | None) -> bytes:
    """Return the sentence that a board sends."""
    values = ["" if value is None else str(value) for value in (counts, pulses)]
    body = f"PDBS,{milliseconds % _WRAP},{values[0]},{values[1]}".encode("ascii")
    return b"$" + body + f"*{_checksum(body):02X}\r\n".encode("ascii")


def _checksum(body: bytes) -> int:
    total = 0
    for byte in body:
        total ^= byte
    return total


def _fields(line: bytes) -> tuple[int, int | None, int | None] | str:
    """Return a sentence's numbers, or why it has none."""
    if not line.startswith(b"$PDBS,") or len(line) > _LONGEST or line[-3:-2] != b"*":
        return "no sentence of a sensor board"
    body = line[1:-3]
    try:
        if int(line[-2:], 16) != _checksum(body):
            return "checksum"
        milliseconds, counts, pulses = (_number(field) for field in body.split(b",")[1:])
    except ValueError:
        return "not three whole numbers"
    return (milliseconds, counts, pulses) if milliseconds is not None else "no time"


def _number(field: bytes) -> int | None:
    if not field:
        return None
    if not field.isdigit() or len(field) > 10:
        raise ValueError
    return int(field)
