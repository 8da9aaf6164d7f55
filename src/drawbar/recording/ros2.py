"""ROS 2: a log as an MCAP file that ROS tools read, without ROS, all of it in standard messages: docs/files.md.

Frames are those of REP 105: `map` is east-north-up from the path's origin, bodies are forward-left-up. Needs the extra
`machine` (mcap-ros2-support).
"""

import heapq
import math
from collections.abc import Iterator
from operator import attrgetter
from pathlib import Path
from typing import Any

from mcap_ros2.writer import Writer

from drawbar.recording.log import RunLog
from drawbar.recording.ros2_drive import drive_messages
from drawbar.recording.ros2_types import Said, definition, head, turned
from drawbar.signals import Estimate, Pose, StepRecord
from drawbar.vehicle.parameters import BODIES, VehicleParameters


def write_ros2(source: Path, log: RunLog, file: Path) -> None:
    """Write path, steps and, of a drive, the receivers' fixes and the supervisor's states.

    Args:
        source: file of the log.
        log: what was read from it.
        file: to be written.

    Raises:
        DrawbarError: the messages in the log cannot be read.
        OSError: the file cannot be written.
    """
    with file.open("wb") as stream:
        writer, schemas = Writer(stream), dict[str, Any]()
        for said in heapq.merge(_steps(log), drive_messages(log, source), key=attrgetter("time")):
            if said.kind not in schemas:
                package, _, name = said.kind.partition("/")
                schemas[said.kind] = writer.register_msgdef(f"{package}/msg/{name}", definition(said.kind))
            writer.write_message(
                topic=said.topic,
                schema=schemas[said.kind],
                message=said.content,
                log_time=said.time,
                publish_time=said.time,
            )
        writer.finish()  # type: ignore[no-untyped-call]  # mcap_ros2 left its annotation out


def _steps(log: RunLog) -> Iterator[Said]:
    vehicle = log.header.vehicle
    for index, (record, wall) in enumerate(zip(log.records, log.wall_time.tolist(), strict=True)):
        time = round(wall * 1e9)
        if index == 0:
            yield Said(time, "/path", "nav_msgs/Path", _path(log, time))
            yield Said(time, "/tf_static", "tf2_msgs/TFMessage", {"transforms": _antennas(vehicle, time)})
        for body in BODIES:
            place = getattr(record.estimate, body)
            yield Said(time, f"/{body}/pose", "geometry_msgs/PoseStamped", _stamped(place, time))
        yield Said(time, "/tf", "tf2_msgs/TFMessage", {"transforms": _transforms(record.estimate, vehicle, time)})
        yield Said(time, "/joint_states", "sensor_msgs/JointState", _joints(record.estimate, time))
        for topic, value in _numbers(record).items():
            if math.isfinite(value):
                yield Said(time, topic, "std_msgs/Float64", {"data": value})


def _numbers(record: StepRecord) -> dict[str, float]:
    return {
        "/tractor/lateral_error": record.reference.tractor.lateral_error,
        "/trailer/lateral_error": record.reference.trailer.lateral_error,
        "/tractor/steering_command": record.command.tractor_steering,
        "/trailer/steering_command": record.command.trailer_steering,
        "/speed_command": record.command.speed,
    }


def _path(log: RunLog, time: int) -> dict[str, Any]:
    table = log.header.path
    places = zip(table.x.tolist(), table.y.tolist(), table.yaw.tolist(), strict=True)
    return {"header": head(time), "poses": [_stamped(Pose(x=x, y=y, yaw=yaw), time) for x, y, yaw in places]}


def _joints(estimate: Estimate, time: int) -> dict[str, Any]:
    angles = {
        "front_wheels": estimate.tractor_steering,
        "hitch": estimate.hitch_angle,
        "trailer_joint": estimate.trailer_steering,
    }
    known = {name: angle for name, angle in angles.items() if math.isfinite(angle)}
    return {
        "header": head(time, ""),
        "name": list(known),
        "position": list(known.values()),
        "velocity": [],
        "effort": [],
    }


def _antennas(vehicle: VehicleParameters, time: int) -> list[dict[str, Any]]:
    return [
        _transform(body, f"{body}_antenna", Pose(x=mast.forward, y=mast.left, yaw=0.0), time, mast.up)
        for body, mast in zip(BODIES, (vehicle.masts.tractor, vehicle.masts.trailer), strict=True)
    ]


def _transforms(estimate: Estimate, vehicle: VehicleParameters, time: int) -> list[dict[str, Any]]:
    """Return the chain from the map to the trailer; what is not known yet is left out."""
    tractor, back = estimate.tractor, vehicle.free_joint_offset
    drawbar = Pose(
        x=tractor.x - back * math.cos(tractor.yaw),
        y=tractor.y - back * math.sin(tractor.yaw),
        yaw=tractor.yaw - estimate.hitch_angle,
    )
    chain = (
        ("map", "tractor", tractor),
        ("tractor", "drawbar", _seen_from(tractor, drawbar)),
        ("drawbar", "trailer", _seen_from(drawbar, estimate.trailer)),
    )
    return [
        _transform(parent, child, place, time)
        for parent, child, place in chain
        if math.isfinite(place.x + place.y + place.yaw)
    ]


def _seen_from(place: Pose, other: Pose) -> Pose:
    """Return another place in the frame of one."""
    east, north, cos, sin = other.x - place.x, other.y - place.y, math.cos(place.yaw), math.sin(place.yaw)
    return Pose(x=cos * east + sin * north, y=cos * north - sin * east, yaw=other.yaw - place.yaw)


def _transform(parent: str, child: str, place: Pose, time: int, up: float = 0.0) -> dict[str, Any]:
    return {
        "header": head(time, parent),
        "child_frame_id": child,
        "transform": {"translation": {"x": place.x, "y": place.y, "z": up}, "rotation": turned(place.yaw)},
    }


def _stamped(place: Pose, time: int) -> dict[str, Any]:
    position = {"x": place.x, "y": place.y, "z": 0.0}
    return {"header": head(time), "pose": {"position": position, "orientation": turned(place.yaw)}}
