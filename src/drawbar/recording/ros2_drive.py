"""ROS 2 messages of a drive beside those of its steps: what the receivers reported, and the supervisor's states."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec

from drawbar.geometry import LocalFrame
from drawbar.messages import Fixes
from drawbar.recording.drive_events import Became, drive_events
from drawbar.recording.drive_records import TOPICS
from drawbar.recording.encoding import decode_message
from drawbar.recording.log import RunLog, reading
from drawbar.recording.ros2_types import Said, head
from drawbar.recording.stream import LoggedMessage
from drawbar.statuses import FixQuality
from drawbar.vehicle.parameters import BODIES

_NO_FIX, _UNKNOWN, _APPROXIMATED = -1, 0, 1
_STATUS = {
    FixQuality.UNKNOWN: 0,
    FixQuality.SINGLE: 0,
    FixQuality.DIFFERENTIAL: 1,
    FixQuality.FLOAT: 2,
    FixQuality.FIXED: 2,
}
"""of NavSatStatus: SBAS stands for differential, GBAS for RTK; no other has a fix"""
_HEIGHT = 1e6
"""variance of a height, which is not recorded, m²"""


class _Report(msgspec.Struct):
    x: float
    y: float
    deviation: float
    quality: int
    heard: int = 1


class _Fixes(msgspec.Struct):
    time: int
    epoch: int
    tractor: _Report
    trailer: _Report


def drive_messages(log: RunLog, source: Path) -> list[Said]:
    """Return what the processes of a drive have told each other, in order; a simulated run has nothing of it.

    Raises:
        DrawbarError: the messages cannot be read.
    """
    said = [_state(event) for event in drive_events(source) if isinstance(event, Became)]
    if log.header.origin is not None:
        latitude, longitude, height = log.header.origin
        said += _fixes(source, LocalFrame(latitude=latitude, longitude=longitude, height=height))
    return sorted(said, key=lambda each: each.time)


def _state(event: Became) -> Said:
    ended = "" if event.cause is None else f": {event.cause.sentence}"
    text = {"data": f"{event.state.name}{ended}"}
    return Said(round(event.time * 1e9), "/gate/state", "std_msgs/String", text)


def _fixes(source: Path, frame: LocalFrame) -> Iterator[Said]:
    with reading(source) as records:
        for record in records:
            if isinstance(record, LoggedMessage) and record.topic == TOPICS[Fixes]:
                fixes, time = msgspec.convert(decode_message(record), _Fixes), record.publish_time
                epoch = time + fixes.epoch - fixes.time
                for body, report in zip(BODIES, (fixes.tractor, fixes.trailer), strict=True):
                    if report.heard:
                        content = _fix(report, frame, head(epoch, f"{body}_antenna"))
                        yield Said(time, f"/{body}/fix", "sensor_msgs/NavSatFix", content)


def _fix(report: _Report, frame: LocalFrame, header: dict[str, Any]) -> dict[str, Any]:
    latitude, longitude = (float(each) for each in frame.level(report.x, report.y))
    is_known, has_place = math.isfinite(report.deviation), math.isfinite(report.x + report.y)
    variance = report.deviation**2 if is_known else 0.0
    status = _STATUS.get(FixQuality(report.quality), _NO_FIX) if has_place else _NO_FIX
    return {
        "header": header,
        "status": {"status": status, "service": 0},
        "latitude": latitude,
        "longitude": longitude,
        "altitude": math.nan,
        "position_covariance": [variance, 0.0, 0.0, 0.0, variance, 0.0, 0.0, 0.0, _HEIGHT],
        "position_covariance_type": _APPROXIMATED if is_known else _UNKNOWN,
    }
