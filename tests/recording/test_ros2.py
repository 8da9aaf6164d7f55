"""A log as standard ROS 2 messages, read back by the reader of mcap-ros2-support."""

import math

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from recorded_rehearsal import FRAME, recorded_rehearsal

from drawbar.config import load_configuration
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.messages import Fixes, SupervisorState
from drawbar.recording.drive_records import read_messages
from drawbar.recording.log import read_log
from drawbar.recording.recorder import Recorder
from drawbar.recording.ros2 import write_ros2
from drawbar.statuses import FixQuality

CHANGES = [
    "path.radii=[8.0]",
    "path.straight_length=10.0",
    "vehicle.masts.tractor.forward=0.3",
    "vehicle.masts.tractor.up=2.5",
]


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """Return the log of a drive that steers for some seconds."""
    file = tmp_path_factory.mktemp("drive") / "log.mcap"
    configuration = with_stand_ins(load_configuration("articulated", CHANGES))
    with recorded_rehearsal(configuration, file, seed=3) as (rehearsal, _):
        while rehearsal.gate_state is None or rehearsal.gate_state.state is not SupervisorState.ACTIVE:
            rehearsal.advance()
            assert rehearsal.time < 60.0, rehearsal.gate_state
        for _ in rehearsal.run(12.0):
            pass
    return file


def exported(log, file):
    """Return the messages of an export by topic, each with its time, ns, and the name of its type."""
    write_ros2(log, read_log(log), file)
    found = {}
    with file.open("rb") as stream:
        for schema, channel, raw, message in make_reader(
            stream, decoder_factories=[DecoderFactory()]
        ).iter_decoded_messages():
            found.setdefault(channel.topic, []).append((raw.log_time, message, schema.name))
    return found


@pytest.fixture(scope="module")
def seen(drive, tmp_path_factory):
    return exported(drive, tmp_path_factory.mktemp("ros2") / "ros2.mcap")


def yaw(turn):
    return 2.0 * math.atan2(turn.z, turn.w)


def stamp(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def test_each_topic_has_its_standard_type(seen):
    types = {topic: said[0][2] for topic, said in seen.items()}
    assert types == {
        "/path": "nav_msgs/msg/Path",
        "/tf_static": "tf2_msgs/msg/TFMessage",
        "/tf": "tf2_msgs/msg/TFMessage",
        "/joint_states": "sensor_msgs/msg/JointState",
        "/tractor/pose": "geometry_msgs/msg/PoseStamped",
        "/trailer/pose": "geometry_msgs/msg/PoseStamped",
        "/tractor/fix": "sensor_msgs/msg/NavSatFix",
        "/trailer/fix": "sensor_msgs/msg/NavSatFix",
        "/gate/state": "std_msgs/msg/String",
        **dict.fromkeys(
            (
                "/tractor/lateral_error", "/trailer/lateral_error", "/speed_command",
                "/tractor/steering_command", "/trailer/steering_command",
            ),
            "std_msgs/msg/Float64",
        ),
    }  # fmt: skip


@pytest.mark.parametrize("body", ["tractor", "trailer"])
def test_fixes_are_what_the_receivers_reported(drive, seen, body):
    reported = [(wall, fixes) for wall, fixes in read_messages(drive, Fixes) if getattr(fixes, body).heard]
    said = seen[f"/{body}/fix"]
    assert len(said) == len(reported) > 50
    for (wall, fixes), (time, fix, _) in zip(reported, said, strict=True):
        report = getattr(fixes, body)
        east, north = FRAME.east_north(fix.latitude, fix.longitude)
        assert (east, north) == pytest.approx((report.x, report.y), abs=1e-6)
        assert math.isnan(fix.altitude)
        assert fix.header.frame_id == f"{body}_antenna"
        assert time == pytest.approx(wall * 1e9, abs=1000)
        assert time - stamp(fix) == fixes.time - fixes.epoch
        assert fix.status.status == {FixQuality.FIXED: 2, FixQuality.SINGLE: 0}[FixQuality(report.quality)]
        assert fix.position_covariance_type == 1
        variances = np.reshape(fix.position_covariance, (3, 3)).diagonal()
        assert variances == pytest.approx((report.deviation**2, report.deviation**2, 1e6))


def test_transforms_lead_from_the_map_to_the_trailer(drive, seen):
    log = read_log(drive)
    vehicle = log.header.vehicle
    assert len(seen["/tf"]) == len(log.records)
    for record, (_, message, _) in zip(log.records, seen["/tf"], strict=True):
        chain = {each.child_frame_id: each for each in message.transforms}
        if len(chain) < 3:
            assert not math.isfinite(record.estimate.tractor.x + record.estimate.trailer.x)
            continue
        assert [each.header.frame_id for each in chain.values()] == ["map", "tractor", "drawbar"]
        place, facing = np.zeros(2), 0.0
        for each in chain.values():
            shift, turn = each.transform.translation, np.array([math.cos(facing), math.sin(facing)])
            place = place + shift.x * turn + shift.y * np.array([-turn[1], turn[0]])
            facing += yaw(each.transform.rotation)
        trailer = record.estimate.trailer
        assert place == pytest.approx((trailer.x, trailer.y), abs=1e-9)
        assert math.remainder(facing - trailer.yaw, math.tau) == pytest.approx(0.0, abs=1e-9)
        joint = chain["trailer"].transform
        bent = yaw(joint.rotation)
        assert bent == pytest.approx(-record.estimate.trailer_steering, abs=0.02)
        behind = vehicle.trailer_length - vehicle.trailer_antenna
        expected = (-vehicle.drawbar_length - behind * math.cos(bent), -behind * math.sin(bent))
        assert (joint.translation.x, joint.translation.y) == pytest.approx(expected, abs=0.1)
    assert len(chain) == 3
    antenna = {each.child_frame_id: each for each in seen["/tf_static"][0][1].transforms}["tractor_antenna"]
    assert antenna.header.frame_id == "tractor"
    assert (antenna.transform.translation.x, antenna.transform.translation.z) == (0.3, 2.5)


def test_joints_and_poses_are_the_estimate(drive, seen):
    record = read_log(drive).records[-1]
    joints = seen["/joint_states"][-1][1]
    assert dict(zip(joints.name, joints.position, strict=True)) == {
        "front_wheels": record.estimate.tractor_steering,
        "hitch": record.estimate.hitch_angle,
        "trailer_joint": record.estimate.trailer_steering,
    }
    pose = seen["/trailer/pose"][-1][1].pose
    assert (pose.position.x, pose.position.y) == (record.estimate.trailer.x, record.estimate.trailer.y)
    assert seen["/tractor/lateral_error"][-1][1].data == record.reference.tractor.lateral_error


def test_each_state_of_the_supervisor_is_told_once(seen):
    told = [message.data for _, message, _ in seen["/gate/state"]]
    names = [text.partition(":")[0] for text in told]
    assert names[-3:] == ["READY", "ENGAGING", "ACTIVE"]
    assert "ESTOP: the operator asked for an emergency stop" in told


def test_messages_come_in_the_order_of_their_times(drive, tmp_path):
    write_ros2(drive, read_log(drive), tmp_path / "ros2.mcap")
    with (tmp_path / "ros2.mcap").open("rb") as stream:
        times = [raw.log_time for _, _, raw in make_reader(stream).iter_messages(log_time_order=False)]
    assert times == sorted(times)


def test_a_simulated_run_has_no_fixes_and_no_supervisor(drive, tmp_path):
    log = read_log(drive)
    with Recorder(tmp_path / "log.mcap", log.header) as recorder:
        for record in log.records[-5:]:
            recorder.write(record)
    found = exported(tmp_path / "log.mcap", tmp_path / "ros2.mcap")
    assert len(found["/tf"]) == 5
    assert not found.keys() & {"/tractor/fix", "/trailer/fix", "/gate/state"}
