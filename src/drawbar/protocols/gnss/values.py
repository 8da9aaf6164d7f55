"""Values out of frames: what is missing, not finite or impossible becomes NaN or None, and is counted by kind."""

import datetime
import math
import re
from collections import Counter
from typing import Any

from drawbar.geometry import wrap

KNOT = 1852.0 / 3600.0
"""m/s"""
KMH = 1.0 / 3.6
"""m/s"""
LARGEST_SPEED = 50.0
"""m/s"""
OLDEST_CORRECTION = 3600.0
"""no receiver computes with corrections that are older, s"""
_LARGEST_DEVIATION = 1e6
"""m, or m² of a variance: a position this uncertain counts as none"""
_DIGITS = re.compile(r"[0-9]+(?:\.[0-9]*)?")


class Values:
    """The fields of one decoded frame, by name or index; `refused` counts what a sensor cannot have meant."""

    def __init__(self, kind: str, fields: dict[str, Any], refused: Counter[str]) -> None:
        self._kind = kind
        self._fields = fields
        self._refused = refused

    def number(self, name: str, scale: float = 1.0, *, low: float = -math.inf, high: float = math.inf) -> float:
        """Return a field times a scale, NaN where it is missing, empty or outside [low, high] before the scaling."""
        value = self._fields.get(name, "")
        if value is None or value == "":
            return math.nan
        number = float(value)
        if not (low <= number <= high and math.isfinite(number)):
            self.refuse(name)
            return math.nan
        return number * scale + 0.0  # which makes 0 of -0

    def deviation(self, name: str, scale: float = 1.0) -> float:
        """Return a standard deviation or variance as it stands, missing: NaN, given but not finite or too large: -1."""
        value = self._fields.get(name, "")
        if value is None or value == "":
            return math.nan
        number = float(value) * scale
        return number if abs(number) <= _LARGEST_DEVIATION else -1.0

    def integer(self, name: str) -> int | None:
        """Return a whole number, None where it is missing, or outside [0, 65535]."""
        number = self.number(name, low=0, high=65535)
        return int(number) if number == number and number.is_integer() else None

    def text(self, name: str) -> str:
        """Return a text, empty where it is missing."""
        return str(self._fields.get(name, ""))

    def yaw(self, name: str) -> float:
        """Return a heading in degrees clockwise from north as yaw, rad."""
        return wrap(math.pi / 2.0 - self.number(name, math.pi / 180.0, low=-180.0, high=360.0))

    def coordinate(self, name: str, hemisphere: str, letters: str) -> float:
        """Return ddmm.mmmm and the letter of its hemisphere, NS or EW, as degrees; NaN where there is no such place."""
        text, letter, limit = self.text(name), self.text(hemisphere), 90.0 if letters == "NS" else 180.0
        if not text:
            return math.nan
        whole, minutes = divmod(float(text), 100.0) if _DIGITS.fullmatch(text) else (math.inf, 0.0)
        degrees = whole + minutes / 60.0
        if not (minutes < 60.0 and degrees <= limit and letter in tuple(letters)):
            self.refuse(name)
            return math.nan
        return degrees if letter == letters[0] else -degrees

    def correction_age(self, name: str) -> float:
        """Return the age of corrections, s."""
        return self.number(name, low=0.0, high=OLDEST_CORRECTION)

    def velocity(self, north: str, east: str, scale: float = 1.0) -> tuple[float, float]:
        """Return speed over ground (m/s) and its yaw (rad) of two components, NaN where they are missing or absurd."""
        components = [self.number(name, scale) for name in (north, east)]
        speed = math.hypot(*components)
        if speed > LARGEST_SPEED:
            self.refuse("speed")
            return math.nan, math.nan
        return speed, math.atan2(*components)

    def angle(self, name: str, scale: float = 1.0) -> float:
        """Return an inclination in degrees (after the scale), as rad; within a right angle."""
        return self.number(name, math.radians(scale), low=-90.0 / abs(scale), high=90.0 / abs(scale))

    def clock(self, name: str) -> float | None:
        """Return a time of day hhmmss.ss in seconds, None where it is missing; second 60 is the leap second."""
        text = self.text(name)
        if not text:
            return None
        hours, minutes, seconds = text[:2], text[2:4], text[4:]
        if hours.isdecimal() and minutes.isdecimal() and seconds[:2].isdecimal() and len(seconds[:2]) == 2:
            total = int(hours) * 3600 + int(minutes) * 60 + float(seconds)
            is_leap = (int(hours), int(minutes)) == (23, 59)
            if int(hours) < 24 and int(minutes) < 60 and float(seconds) < (61.0 if is_leap else 60.0):
                return total
        self.refuse(name)
        return None

    def day(self, day: int | None, month: int | None, year: int | None) -> datetime.date | None:
        """Return a date, None where there is no such day."""
        if day is None or month is None or year is None:
            return None
        try:
            return datetime.date(year, month, day)
        except ValueError:
            self.refuse("date")
            return None

    def refuse(self, name: str) -> None:
        """Count a value that was given and cannot be meant."""
        self._refused[f"{self._kind}: impossible {f'field {name}' if name.isdecimal() else name}"] += 1


def place(latitude: float, longitude: float) -> tuple[float, float]:
    """Return both WGS84 degrees, or NaN twice where one is missing: half a position is none."""
    return (latitude, longitude) if math.isfinite(latitude + longitude) else (math.nan, math.nan)
