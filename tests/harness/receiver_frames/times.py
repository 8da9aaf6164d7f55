"""Times and velocities as binary protocols send them."""

import datetime
import math

from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.gnss.decoding import LEAP_SECONDS

_GPS_BEGIN = datetime.datetime(1980, 1, 6, tzinfo=datetime.UTC)
_WEEK = 7 * 86_400_000
"""ms"""


def gps_time(report: Report) -> tuple[int, int]:
    """Return the GPS week and the milliseconds in it."""
    since = report.time - _GPS_BEGIN + datetime.timedelta(seconds=LEAP_SECONDS)
    return divmod(since // datetime.timedelta(milliseconds=1), _WEEK)


def velocity(report: Report) -> tuple[float, float]:
    """Return east and north of the speed over ground, m/s; zero where there is no course."""
    if math.isnan(report.course):
        return 0.0, 0.0
    return report.speed * math.cos(report.course), report.speed * math.sin(report.course)
