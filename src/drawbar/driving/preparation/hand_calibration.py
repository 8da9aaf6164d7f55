"""Calibration by hand: a machine's numbers from the log of a drive by hand (docs/calibration.md). Pure."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from pydantic import ValidationError

from drawbar.config import Configuration
from drawbar.driving.preparation.hand_drive import HandDrive
from drawbar.geometry import Floats, wrap
from drawbar.machine.calibration.calibrated import Calibrated, blocks, finite_columns
from drawbar.machine.calibration.mounting import CurveDrive, antenna_place, mounting_roll
from drawbar.machine.calibration.scale import Circle, Scale, scale_from_circles
from drawbar.machine.calibration.zero import zero_from_straight
from drawbar.machine.hardware.sensor_line import SensorBoardSettings
from drawbar.machine.hardware.steer_board import BoardMemory, SteerBoardSettings
from drawbar.vehicle.parameters import Mast, VehicleParameters

_OPPOSITE = math.radians(10.0)
"""by which the way back may differ from the opposite of the way there, rad"""
_SAME_TRACK = 2.0
"""farthest of the way back from the way there, m"""
_WHEEL_MARKS = 0.02
"""standard deviation with which a driver meets the same wheel marks, m"""


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationResult:
    """What one calibration found, and what it changes in the configuration."""

    name: str
    value: Calibrated
    sets: Mapping[str, Any]
    """by dotted key; empty where it is refused"""


def calibrate(configuration: Configuration, drive: HandDrive) -> Iterator[CalibrationResult]:
    """Yield everything that the drive shows of the machine; what it does not show is refused, with what to drive."""
    devices = configuration.devices
    assert devices is not None
    if devices.tractor_board is not None and np.isfinite(drive.front_wheels).any():
        yield from _front_wheels(devices.tractor_board, configuration.vehicle.wheelbase, drive)
    if devices.trailer_board is not None:
        yield _joint(devices.trailer_board, drive)
    if devices.sensors is not None and devices.sensors.measures_hitch:
        yield _hitch(devices.sensors, drive)
    if devices.sensors is not None and devices.sensors.pulses_per_metre is not None:
        yield _wheels(devices.sensors.pulses_per_metre, drive)
    if np.isfinite(drive.roll).any():
        yield _roll("tractor", configuration.vehicle, drive)
    if np.isfinite(drive.trailer_roll + drive.trailer_antenna_x + drive.joint).any():
        yield _roll("trailer", configuration.vehicle, drive)
    if np.isfinite(drive.front_wheels).any() and np.isfinite(drive.wheel_speed).any():
        yield from _antenna(configuration.vehicle, drive)


def board_counts(board: SteerBoardSettings, angles: Floats) -> Floats:
    """Return the sensor's counts (n,), from its centre, of angles that a board has reported, rad."""
    memory = board.memory
    reported = np.degrees(angles) * (1.0 if board.inverted else -1.0)  # on the wire, right positive
    position = memory.counts_per_degree * np.where(reported < 0.0, reported * 100.0 / memory.ackermann, reported)
    return np.asarray(memory.offset - position if memory.invert_sensor else position - memory.offset, float)


def _front_wheels(board: SteerBoardSettings, wheelbase: float, drive: HandDrive) -> Iterator[CalibrationResult]:
    zero = _zero(board, drive, "front_wheels")
    circles = [
        Circle(
            times=part.times,
            counts=board_counts(board, part.front_wheels),
            yaw_rates=part.yaw_rates,
            speeds=part.speeds,
        )
        for part in drive.circles()
    ]
    counts = board_counts(board, drive.front_wheels)
    span = float(np.nanmin(counts)), float(np.nanmax(counts))
    scale = scale_from_circles(circles, wheelbase=wheelbase, zero=zero, span=span)
    value, memory = scale.counts_per_degree, board.memory
    if value.accepted:
        changes = _scaled(board, scale, zero)
        try:
            memory = BoardMemory.model_validate(board.memory.model_dump() | changes)
        except ValidationError:
            numbers = ", ".join(f"{name}={number}" for name, number in changes.items())
            reason = f"a board cannot store {numbers}; check the sensor's lever and its way"
            value = replace(value, refusals=(reason,))
    prefix = "devices.tractor_board.memory."
    yield CalibrationResult(name="front wheels: zero", value=zero, sets=_offset(prefix, memory, zero))
    names = ("counts_per_degree", "ackermann", "invert_sensor")
    sets = {prefix + name: getattr(memory, name) for name in names} if value.accepted else {}
    yield CalibrationResult(name="front wheels: scale", value=value, sets=sets)


def _zero(board: SteerBoardSettings, drive: HandDrive, steering: Literal["front_wheels", "joint"]) -> Calibrated:
    """Return the counts of a steering in the longest straight stretch."""
    parts = drive.straights()
    if not parts:
        return zero_from_straight([], [], [], [])
    part = max(parts, key=lambda each: each.way)
    counts = board_counts(board, getattr(part, steering))
    return zero_from_straight(part.times, counts, part.yaw_rates, part.speeds)


def _scaled(board: SteerBoardSettings, scale: Scale, zero: Calibrated) -> dict[str, Any]:
    """Return what of the memory makes the board report the angles of the circles."""
    offset = np.array([counts - zero.value for counts, _, _ in scale.points])
    wire = np.degrees([angle for _, angle, _ in scale.points]) * (1.0 if board.inverted else -1.0)
    inverted = bool(np.sum(offset * wire) < 0.0)
    right, left = (
        abs(float((offset[side] ** 2).sum() / (offset[side] * wire[side]).sum())) for side in (wire > 0.0, wire < 0.0)
    )
    return {
        "counts_per_degree": max(1, round(right)),
        "ackermann": max(1, round(100.0 * right / left)),
        "invert_sensor": inverted,
    }


def _offset(prefix: str, memory: BoardMemory, zero: Calibrated) -> dict[str, Any]:
    if not zero.accepted:
        return {}
    return {prefix + "offset": round(zero.value) if memory.invert_sensor else -round(zero.value)}


def _joint(board: SteerBoardSettings, drive: HandDrive) -> CalibrationResult:
    """Behind a straight drive the joint is straight; its scale needs a protractor."""
    zero = _zero(board, drive, "joint")
    return CalibrationResult(
        name="joint: zero", value=zero, sets=_offset("devices.trailer_board.memory.", board.memory, zero)
    )


def _hitch(sensors: SensorBoardSettings, drive: HandDrive) -> CalibrationResult:
    """Behind a straight drive the hitch angle is zero."""
    value = _of_straights(drive, lambda part: part.hitch, unit="rad")
    sets: dict[str, Any] = {}
    if value.accepted and sensors.hitch_polynomial is not None:
        constant, *others = sensors.hitch_polynomial
        sets = {"devices.sensors.hitch_polynomial": [constant - value.value, *others]}
    elif value.accepted:
        sets = {"devices.sensors.hitch_angles": [each - value.value for each in sensors.hitch_angles]}
    return CalibrationResult(name="hitch angle: zero", value=value, sets=sets)


def _wheels(pulses: float, drive: HandDrive) -> CalibrationResult:
    value = _of_straights(drive, lambda part: part.wheel_speed / part.speeds, unit="reported per true")
    sets = {"devices.sensors.pulses_per_metre": pulses * value.value} if value.accepted else {}
    return CalibrationResult(name="wheel speed", value=value, sets=sets)


def _of_straights(drive: HandDrive, quantity: Callable[[HandDrive], Floats], *, unit: str) -> Calibrated:
    """Return the mean of a quantity in all straight stretches; a second is a sample."""
    parts = drive.straights()
    means = [blocks(*finite_columns(part.times, quantity(part)), length=1.0)[0] for part in parts]
    values = np.concatenate([*means, np.zeros(0)])
    refusals = [] if len(values) >= 10 else [f"{len(values)} s of straight driving; drive 30 m straight at 1 to 2 m/s"]
    spread = float(values.std(ddof=1)) if len(values) > 1 else math.inf
    return Calibrated(
        value=float(values.mean()) if len(values) else math.nan,
        deviation=spread / math.sqrt(max(len(values), 1)),
        unit=unit,
        refusals=tuple(refusals),
    )


def _roll(body: Literal["tractor", "trailer"], vehicle: VehicleParameters, drive: HandDrive) -> CalibrationResult:
    """Return the mounting roll from two straight stretches of one track, there and back.

    The trailer follows the track beside itself by what its joint is bent; a slope moves it to the same side both ways.
    """
    mast: Mast = getattr(vehicle.masts, body)
    there, back = two_ways(drive)
    course = float(np.mean(there.yaw)) if len(there.times) else 0.0
    origin = [float(np.mean(each)) if len(each) else 0.0 for each in _antenna_of(body, there)[:2]]

    def across(part: HandDrive) -> Floats:
        """Return how far the track lies to the left of the way there, m."""
        x, y, yaw, roll = _antenna_of(body, part)
        lean = mast.up * np.sin(roll) - mast.left  # of the body's own left, from the antenna to the ground point
        if body == "trailer":
            lean = lean + vehicle.drawbar_length * np.sin(part.joint)
        east, north = x - lean * np.sin(yaw) - origin[0], y + lean * np.cos(yaw) - origin[1]
        return np.asarray(north * math.cos(course) - east * math.sin(course), float)

    value = mounting_roll((there.times, across(there)), (back.times, across(back)), height=mast.up)
    sets: dict[str, Any] = {}
    if value.accepted:
        known = math.hypot(value.deviation, _WHEEL_MARKS / (2.0 * mast.up))
        prefix = f"vehicle.masts.{body}.roll_"
        sets = {f"{prefix}offset": value.value, f"{prefix}deviation": round(known, 5)}
    return CalibrationResult(name=f"{body}: mounting roll", value=value, sets=sets)


def _antenna_of(body: Literal["tractor", "trailer"], drive: HandDrive) -> tuple[Floats, Floats, Floats, Floats]:
    """Return x and y of a body's antenna, m, and its yaw and measured roll, rad."""
    if body == "tractor":
        return drive.antenna_x, drive.antenna_y, drive.yaw, drive.roll
    return drive.trailer_antenna_x, drive.trailer_antenna_y, drive.trailer_yaw, drive.trailer_roll


def _antenna(vehicle: VehicleParameters, drive: HandDrive) -> Iterator[CalibrationResult]:
    """Yield where the tractor's antenna stands; how roll moves it is taken out as far as it is known."""
    mast = vehicle.masts.tractor
    lateral = mast.up * np.sin(np.nan_to_num(drive.roll - mast.roll_offset))  # to the right
    place = antenna_place(
        CurveDrive(
            times=drive.times,
            x=drive.antenna_x - lateral * np.sin(drive.yaw),
            y=drive.antenna_y + lateral * np.cos(drive.yaw),
            wheel_speeds=drive.wheel_speed,
            front_wheels=drive.front_wheels,
        ),
        wheelbase=vehicle.wheelbase,
    )
    left = place.left
    if np.isfinite(drive.roll).any():
        reason = "a roll sensor's zero looks like an antenna's place to the side; measure that place"
        left = replace(left, refusals=(*left.refusals, reason))
    for name, value in (("forward", place.forward), ("left", left)):
        sets = {f"vehicle.masts.tractor.{name}": round(value.value, 3)} if value.accepted else {}
        yield CalibrationResult(name=f"tractor: antenna {name}", value=value, sets=sets)


def two_ways(drive: HandDrive) -> tuple[HandDrive, HandDrive]:
    """Return the longest straight stretch, and the longest one that leads back beside it; empty ones: there is none."""
    parts, nothing = sorted(drive.straights(), key=lambda part: -part.way), drive.part(slice(0, 0))
    for i, there in enumerate(parts):
        yaw, x, y = np.mean(there.yaw), np.mean(there.x), np.mean(there.y)
        for back in parts[i + 1 :]:
            off = (np.mean(back.y) - y) * np.cos(yaw) - (np.mean(back.x) - x) * np.sin(yaw)
            if abs(wrap(float(np.mean(back.yaw) - yaw) - math.pi)) <= _OPPOSITE and abs(off) <= _SAME_TRACK:
                return there, back
    return nothing, nothing
