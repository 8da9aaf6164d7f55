"""ROS 2 types: the texts of the messages that an exported log holds, each complete with the types that it is made of.

They are those of common_interfaces, rcl_interfaces and geometry2, without their comments.
"""

import math
from typing import Any, NamedTuple

from drawbar.step.layout import RULE

_OWN = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "std_msgs/Float64": "float64 data\n",
    "std_msgs/String": "string data\n",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
    "geometry_msgs/PoseStamped": "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
    "geometry_msgs/Transform": "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
    "geometry_msgs/TransformStamped": (
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"
    ),
    "nav_msgs/Path": "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
    "tf2_msgs/TFMessage": "geometry_msgs/TransformStamped[] transforms\n",
    "sensor_msgs/JointState": (
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
    ),
    "sensor_msgs/NavSatStatus": (
        "int8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 STATUS_SBAS_FIX=1\nint8 STATUS_GBAS_FIX=2\nint8 status\n"
        "uint16 SERVICE_GPS=1\nuint16 SERVICE_GLONASS=2\nuint16 SERVICE_COMPASS=4\nuint16 SERVICE_GALILEO=8\n"
        "uint16 service\n"
    ),
    "sensor_msgs/NavSatFix": (
        "std_msgs/Header header\nsensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\n"
        "float64 altitude\nfloat64[9] position_covariance\nuint8 COVARIANCE_TYPE_UNKNOWN=0\n"
        "uint8 COVARIANCE_TYPE_APPROXIMATED=1\nuint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\n"
        "uint8 COVARIANCE_TYPE_KNOWN=3\nuint8 position_covariance_type\n"
    ),
}
"""by name, as other types name them: what each consists of itself"""


def definition(kind: str) -> str:
    """Return the text of a type, such as `nav_msgs/Path`, with those of all that it consists of."""
    others = list[str]()
    _collect(kind, others)
    return _OWN[kind] + "".join(f"{RULE}\nMSG: {other}\n{_OWN[other]}" for other in others)


def _collect(kind: str, found: list[str]) -> None:
    """Add the types that a type consists of, each once."""
    for line in _OWN[kind].splitlines():
        part = line.split()[0].partition("[")[0]
        if part in _OWN and part not in found:
            found.append(part)
            _collect(part, found)


class Said(NamedTuple):
    """A message, as it comes to stand in the file."""

    time: int
    """ns since 1970"""
    topic: str
    kind: str
    """name of its type"""
    content: dict[str, Any]


def head(time: int, frame: str = "map") -> dict[str, Any]:
    """Return the header of a message, with its time in ns since 1970."""
    seconds, rest = divmod(time, 1_000_000_000)
    return {"stamp": {"sec": seconds, "nanosec": rest}, "frame_id": frame}


def turned(yaw: float) -> dict[str, float]:
    """Return a turn around the vertical as a quaternion."""
    return {"x": 0.0, "y": 0.0, "z": math.sin(yaw / 2.0), "w": math.cos(yaw / 2.0)}
