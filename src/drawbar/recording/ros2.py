"""ROS 2: a log as an MCAP file that ROS tools read, without ROS: fixes, path, poses and errors as standard messages.

Message texts are those of common_interfaces (REP 105 frames: `map` for east-north-up from the path's origin). Needs the
extra `machine` (mcap-ros2-support).
"""

import math
from pathlib import Path
from typing import Any

from mcap_ros2.writer import Writer

from drawbar.recording.log import RunLog
from drawbar.signals import Pose, StepRecord
from drawbar.step.layout import RULE

_TIME = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
_HEADER = f"MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n{RULE}\n{_TIME}"
_POINT = "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n"
_QUATERNION = "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
_POSE = f"MSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n{RULE}\n{_POINT}{RULE}\n{_QUATERNION}"
_STAMPED = f"std_msgs/Header header\nPose pose\n{RULE}\n{_HEADER}{RULE}\n{_POSE}"
_PATH = (
    f"std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n{RULE}\n{_HEADER}{RULE}\n"
    f"MSG: geometry_msgs/PoseStamped\nstd_msgs/Header header\nPose pose\n{RULE}\n{_POSE}"
)
_FLOAT = "float64 data\n"


def write_ros2(log: RunLog, file: Path) -> None:
    """Write the path once, and of each step poses, steering commands and lateral errors of both bodies.

    Raises:
        OSError: the file cannot be written.
    """
    with file.open("wb") as stream:
        writer = Writer(stream)
        pose = writer.register_msgdef("geometry_msgs/msg/PoseStamped", _STAMPED)
        path = writer.register_msgdef("nav_msgs/msg/Path", _PATH)
        number = writer.register_msgdef("std_msgs/msg/Float64", _FLOAT)
        for index, (record, wall) in enumerate(zip(log.records, log.wall_time.tolist(), strict=True)):
            time = round(wall * 1e9)
            if index == 0:
                _write(writer, "/path", path, _path(log, time), time)
            _write(writer, "/tractor/pose", pose, _stamped(record.estimate.tractor, time), time)
            _write(writer, "/trailer/pose", pose, _stamped(record.estimate.trailer, time), time)
            for topic, value in _numbers(record).items():
                if math.isfinite(value):
                    _write(writer, topic, number, {"data": value}, time)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap_ros2 left its annotation out


def _write(writer: Any, topic: str, schema: Any, message: dict[str, Any], time: int) -> None:
    writer.write_message(topic=topic, schema=schema, message=message, log_time=time, publish_time=time)


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
    return {"header": _head(time), "poses": [_stamped(Pose(x=x, y=y, yaw=yaw), time) for x, y, yaw in places]}


def _stamped(place: Pose, time: int) -> dict[str, Any]:
    half = place.yaw / 2.0
    turned = {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)}
    return {"header": _head(time), "pose": {"position": {"x": place.x, "y": place.y, "z": 0.0}, "orientation": turned}}


def _head(time: int) -> dict[str, Any]:
    seconds, rest = divmod(time, 1_000_000_000)
    return {"stamp": {"sec": seconds, "nanosec": rest}, "frame_id": "map"}
