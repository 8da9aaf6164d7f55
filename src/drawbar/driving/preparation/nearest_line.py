"""Nearest line: the one of a field's lines to drive from where the vehicle stands, by distance and heading."""

import math
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import NamedTuple

import numpy as np

from drawbar.config import Configuration
from drawbar.driving.preparation.finding import poll_times
from drawbar.errors import ConfigurationError, PathError
from drawbar.geometry import LocalFrame
from drawbar.guidance.importers.line import RecordedLine
from drawbar.guidance.importers.load import line_names, load_line
from drawbar.machine.hardware.devices import DeviceSettings, OriginSettings
from drawbar.machine.hardware.receiver import Receiver
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.transports.open import open_transport

_LISTENS = 10.0
"""s, until every receiver has reported its position"""
_ALONG = math.radians(60.0)
"""between vehicle and line, up to which the line leads along the vehicle, rad"""
_APART = 0.3
"""least distance of both antennas that shows where the vehicle faces, m"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """Where a vehicle stands."""

    latitude: float
    """of the tractor's antenna, WGS84 degrees"""
    longitude: float
    """degrees"""
    yaw: float = math.nan
    """where it faces, NaN: not known, rad"""


def standing(devices: DeviceSettings) -> Standing:
    """Return where the vehicle stands, by its receivers.

    Raises:
        ConfigurationError: a receiver reports no position.
        DrawbarError: a transport cannot be opened.
    """
    tractor = _position(devices, "tractor_receiver")
    if math.isfinite(tractor.yaw) or devices.trailer_receiver is None:
        return Standing(latitude=tractor.latitude, longitude=tractor.longitude, yaw=tractor.yaw)
    trailer = _position(devices, "trailer_receiver")
    frame = LocalFrame(latitude=trailer.latitude, longitude=trailer.longitude)
    east, north = (float(each) for each in frame.east_north(tractor.latitude, tractor.longitude))
    yaw = math.atan2(north, east) if math.hypot(east, north) > _APART else math.nan
    return Standing(latitude=tractor.latitude, longitude=tractor.longitude, yaw=yaw)


def _position(devices: DeviceSettings, name: str) -> Epoch:
    settings = getattr(devices, name)
    with closing(Receiver(open_transport(settings.transport), settings)) as receiver:
        for now in poll_times(_LISTENS, receiver.transport):
            for epoch in receiver.poll(now):
                if epoch.has_fix:
                    return epoch
    raise ConfigurationError(
        f"devices.{name}: has told no position for {_LISTENS:.0f} s, so that no line is the nearest; look at "
        "`drawbar check`, or give --track NAME"
    )


def nearest_track(configuration: Configuration, place: Standing) -> str:
    """Return the name of the line to drive: of those along the vehicle, either way, the nearest, else of all.

    Raises:
        ConfigurationError: the path has no file.
        PathError: no line can be read, or none is as near as `guidance.maximum_start_distance`.
    """
    settings = configuration.path
    if not settings.file:
        raise ConfigurationError("--track nearest: there is no file with lines; give path.file, or leave --track out")
    source, origin = FilePath(settings.file), OriginSettings()
    reach = configuration.guidance.maximum_start_distance
    unreadable, seen = list[str](), list[_Seen]()
    for name in line_names(source):
        try:
            line = load_line(source, name, settings.extension)
        except PathError as error:
            unreadable.append(str(error))
            continue
        frame = line.frame or (configuration.devices.origin if configuration.devices else origin).frame()
        seen.append(_seen(place, line, frame, reach=reach))
    if not seen:
        raise PathError(f"{source}: none of its lines can be read: {'; '.join(unreadable)}")
    best = min(seen)
    if best.away > reach:
        nearest = min(seen, key=lambda each: each.away)
        raise PathError(
            f"{source}: its nearest line {nearest.name!r} is {nearest.away:.0f} m away, {reach:g} m are allowed "
            f"(guidance.maximum_start_distance); drive nearer and start again, or give --track NAME"
        )
    return best.name


class _Seen(NamedTuple):
    """How a line lies before a vehicle, in the order of what is better."""

    across: bool
    """no place within reach leads along the vehicle"""
    away: float
    """distance of its place, m"""
    name: str


def _seen(place: Standing, line: RecordedLine, frame: LocalFrame, *, reach: float) -> _Seen:
    """Return how a line lies: its nearest place within reach along the vehicle, either way, else its nearest one."""
    east, north = (float(each) for each in frame.east_north(place.latitude, place.longitude))
    points = np.column_stack([line.x, line.y])
    steps, beside = np.diff(points, axis=0), np.array([east, north]) - points[:-1]
    share = np.clip((beside * steps).sum(axis=1) / (steps**2).sum(axis=1), 0.0, 1.0)
    away = np.hypot(*(beside - share[:, None] * steps).T)
    along = np.cos(np.arctan2(steps[:, 1], steps[:, 0]) - place.yaw)
    leads = np.abs(along) >= math.cos(_ALONG)  # nowhere where the yaw is not known
    suitable = leads & (away <= reach)
    if suitable.any():
        return _Seen(False, float(away[suitable].min()), line.name)
    return _Seen(True, float(away.min()), line.name)
