"""The small parts of a drive: certainty, letters, mail, display, schemas."""

import json
import math

import numpy as np
import pytest
from rich.console import Console

from drawbar.config import load_configuration
from drawbar.driving.certainty import across
from drawbar.driving.demonstration import with_stand_ins, without_stand_ins
from drawbar.driving.display import KEYS, picture
from drawbar.driving.letters import Device, Event, Level, Raw, Step, pack, unpack
from drawbar.driving.mail import Mailbox
from drawbar.recording.schema import json_schema
from drawbar.signals import Estimate, Pose, SolverStatus, StepRecord
from drawbar.transports.tapped import Direction
from drawbar.vehicle.articulated import trailer_antenna
from drawbar.vehicle.lengths import lengths_of

SEED = 11
NAN = math.nan


def estimate_of(x, y, theta, psi, joint):
    names = ("time", "hitch_angle", "speed", "tractor_steering", "longitudinal_slip", "tractor_slip", "trailer_slip")
    others = dict.fromkeys((*names, "steering_offset", "tractor_crab", "trailer_crab"), 0.0)
    return Estimate(
        tractor=Pose(x=x, y=y, yaw=theta),
        trailer=Pose(x=0.0, y=0.0, yaw=psi),
        trailer_steering=joint,
        status=SolverStatus.SOLVED,
        **others,
    )


def test_certainty_is_what_many_draws_show():
    vehicle = load_configuration("articulated").vehicle
    rng = np.random.default_rng(SEED)
    root = 0.02 * rng.standard_normal((8, 8))
    covariance = root @ root.T
    place = np.array([3.0, -2.0, 0.4, 0.1, 0.05, -0.2])
    lateral, heading = across(vehicle, estimate_of(*place[:4], place[5]), covariance)
    draws = place + rng.multivariate_normal(np.zeros(8), covariance, 200_000)[:, :6]
    lengths, _ = lengths_of(vehicle)
    a, d = vehicle.free_joint_offset, vehicle.drawbar_length
    back = vehicle.trailer_length - vehicle.trailer_antenna

    def antenna(x, y, theta, psi, _steering, joint):
        phi = psi + joint
        east = x - a * np.cos(theta) - d * np.cos(phi) - back * np.cos(psi)
        return east, y - a * np.sin(theta) - d * np.sin(phi) - back * np.sin(psi)

    assert [float(each) for each in trailer_antenna(lengths, *place[:4], place[5])] != []
    spread = []
    for yaw, (x, y) in ((place[2], draws[:, :2].T), (place[3], antenna(*draws.T))):
        spread.append(np.std(-np.sin(yaw) * x + np.cos(yaw) * y))
    assert lateral == pytest.approx(max(spread), rel=0.02)
    assert heading == pytest.approx(np.std(draws[:, 2:4], axis=0).max(), rel=0.01)


@pytest.mark.parametrize(
    "letter",
    [
        Raw(time=5, device=Device.TRAILER_RECEIVER, direction=Direction.UNSENT, data=b"\x00\xff$GGA"),
        Step(time=2**40, data=b'{"step":1}'),
        Event(time=7, level=Level.WARNING, name="gate", text="Größe"),
    ],
)
def test_letters_arrive_as_they_were_sent(letter):
    assert unpack(pack(letter)) == letter


@pytest.mark.parametrize(
    "data", [b"", b"DBr\0", b"DBe\0" + bytes(8) + b"{", b"DBr\0" + bytes(8) + b"\xff\x00", b"x" * 40]
)
def test_what_is_no_letter_is_none(data):
    assert unpack(data) is None


def test_mail_is_never_waited_for_and_what_nobody_takes_is_counted(tmp_path):
    one, other = Mailbox(str(tmp_path / "1")), Mailbox(str(tmp_path / "2"))
    one.send(str(tmp_path / "2"), b"hello")
    one.send(str(tmp_path / "3"), b"nobody")
    assert list(other.receive()) == [b"hello"]
    assert one.lost == 1
    for _ in range(100_000):
        one.send(str(tmp_path / "2"), bytes(1000))
        if one.lost > 1:
            break
    assert one.lost == 2
    one.close()
    other.close()
    assert list(tmp_path.iterdir()) == []


def test_the_display_fits_sixty_columns_without_a_machine():
    console = Console(width=60, file=None, record=True, force_terminal=False)
    with console.capture() as capture:
        console.print(picture(None, None))
    assert all(len(line) <= 60 for line in capture.get().splitlines())
    assert KEYS.splitlines()[0] in capture.get()


def test_schemas_hold_nothing_that_viewers_cannot_read():
    text = json_schema(StepRecord).decode()

    def walk(node):
        assert isinstance(node["type"], str)
        if node["type"] == "array":
            walk(node["items"])
        for child in node.get("properties", {}).values():
            walk(child)

    walk(json.loads(text))
    assert "$ref" not in text
    properties = json.loads(text)["properties"]
    assert properties["plan"]["properties"]["tractor"]["properties"]["poses"]["items"]["type"] == "array"


def test_what_is_kept_of_a_demonstration_names_no_stand_in_and_asks_for_the_wiggle_test():
    configuration = load_configuration("articulated")
    driven = with_stand_ins(configuration)
    assert driven.devices is not None
    assert without_stand_ins(driven) == configuration
    assert without_stand_ins(driven).safety.engage.wiggle_test
