"""The small parts of a drive: certainty, letters, mail, display, schemas."""

import dataclasses
import json
import math
import os
from collections import Counter
from io import StringIO
from itertools import islice
from types import SimpleNamespace

import numpy as np
import pytest
from drive_messages import controller_of, gate_of
from mcap.reader import make_reader
from ordinary import believed
from rich.console import Console

from drawbar.config import load_configuration
from drawbar.driving.certainty import across
from drawbar.driving.demonstration import with_stand_ins, without_stand_ins
from drawbar.driving.display import KEYS, picture
from drawbar.driving.front_end import Keyboard
from drawbar.driving.letters import Step, Sureness, pack, unpack
from drawbar.driving.mail import MOST_KEPT, Mailbox
from drawbar.driving.operator import changed_speed
from drawbar.driving.terminal import Terminal
from drawbar.errors import ConfigurationError, DrawbarError
from drawbar.geometry import LocalFrame
from drawbar.message_records import encode
from drawbar.messages import GateState, SupervisorState
from drawbar.recording.drive_log import DriveLog
from drawbar.recording.drive_records import Happening, Kind, Order, RawBytes, is_drive, open_drive
from drawbar.recording.header import run_header
from drawbar.recording.log import read_log
from drawbar.recording.recorder import Recorder
from drawbar.recording.scene import Scene
from drawbar.recording.schema import json_schema
from drawbar.safety.causes import Cause
from drawbar.signals import Pose, Status, StepRecord
from drawbar.simulation import build_path
from drawbar.transports.tapped import Direction
from drawbar.vehicle.articulated import trailer_antenna
from drawbar.vehicle.lengths import lengths_of

SEED = 11
NAN = math.nan


def gate_state_of(sequence):
    fields = dict.fromkeys((field.name for field in dataclasses.fields(GateState)), 0)
    known = {"state": SupervisorState.READY, "refusals": (0,) * 8, "tractor_angle": 0.1, "trailer_angle": NAN}
    unknown = dict.fromkeys(("remaining", "tractor_set_point", "trailer_set_point", "set_speed"), NAN)
    return GateState(**(fields | known | unknown | {"sequence": sequence, "time": 10**9}))


def estimate_of(x, y, theta, psi, joint):
    return believed(Pose(x=x, y=y, yaw=theta), Pose(x=0.0, y=0.0, yaw=psi), trailer_steering=joint)


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
        RawBytes(time=5, device="trailer_receiver", direction=Direction.UNSENT, data=b"\x00\xff$GGA"),
        RawBytes(time=6, device="sensors", direction=Direction.IN, data=b"", source="192.168.5.126:5120"),
        Order((Happening(kind=Kind.LOOK, time=1), Happening(kind=Kind.FIXES, time=2**45, sequence=2**32 - 1))),
        Step(time=2**40, data=b'{"step":1}'),
        Sureness({"tractor_slip": 0.015625}),
    ],
)
def test_letters_arrive_as_they_were_sent(letter):
    assert unpack(pack(letter)) == letter


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"DBr\0",
        b"DBs\0" + bytes(7),
        b"DBo\0",
        b"DBo\0" + bytes(14),
        b"DBv\0[1]",
        b"DBr\0" + bytes(8) + b"\xff\x00",
        b"x" * 40,
    ],
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


def test_what_is_posted_arrives_in_order_however_late_it_is_read(tmp_path, capfd):
    one, other = Mailbox(str(tmp_path / "1")), Mailbox(str(tmp_path / "2"))
    sent = [bytes((number % 256,)) * 2000 for number in range(1500)]
    for data in sent:
        one.post(str(tmp_path / "2"), data)
    taken = list(other.receive())
    assert len(taken) < len(sent)
    while len(taken) < len(sent):
        one.post(str(tmp_path / "2"), b"more")
        taken += [data for data in other.receive() if data != b"more"]
    assert taken == sent
    assert one.lost == 0
    for _ in range(MOST_KEPT // 2000 + 1000):
        one.post(str(tmp_path / "2"), bytes(2000))
    assert one.lost > 0
    assert (
        capfd.readouterr().err == "1: the 2 does not keep up, and what it has not taken is lost; end other programs\n"
    )
    for each in (other, one):
        each.close()


def test_what_was_recorded_of_a_drive_is_read_again(tmp_path):
    configuration = load_configuration("articulated")
    path, _ = build_path(configuration)
    frame = LocalFrame(latitude=50.0, longitude=4.0)
    header = run_header(configuration, path, None, seed=0, frame=frame)
    state = gate_state_of(sequence=7)
    raw = [
        RawBytes(time=5, device="sensors", direction=Direction.IN, data=b"\x00\xff", source="127.0.0.1:9999"),
        RawBytes(time=7, device="tractor_receiver", direction=Direction.UNSENT, data=b""),
    ]
    look = Happening(kind=Kind.LOOK, time=123456789)
    with DriveLog(tmp_path / "log.mcap", header, Scene(path=path, vehicle=configuration.vehicle, frame=frame)) as log:
        for each in raw:
            log.add_raw(each)
        waiting = log.flushed
        log.flush()
        assert log.flushed > waiting, "the recorder need not flush by itself so soon"
        with open_drive(tmp_path / "log.mcap") as records:  # as a kill at this moment would leave it
            assert list(records) == raw
        log.add_order(Order((look,)))
        log.add_order(Order((look,)))
        log.flush()
        for _ in range(2):
            log.add_message(state)
    assert is_drive(tmp_path / "log.mcap")
    with open_drive(tmp_path / "log.mcap") as records:
        read = list(records)
    assert read[:4] == [*raw, look, look]
    assert len(read) == 5
    assert encode(read[4]) == encode(state)
    with (tmp_path / "log.mcap").open("rb") as stream:
        topics = Counter(channel.topic for _, channel, _ in make_reader(stream).iter_messages())
    assert topics["/raw"] == topics["/order"] == 1  # each message has 16 bytes of the index
    assert read_log(tmp_path / "log.mcap").outcome.reason == "the drive was ended before the end of the path"


def test_a_drives_steps_and_what_is_drawn_of_them_fill_few_megabytes_an_hour(tmp_path, build):
    simulation, frame = build("articulated"), LocalFrame(latitude=50.0, longitude=4.0)
    scene = Scene(path=simulation.path, vehicle=simulation.configuration.vehicle, frame=frame)
    file, steps = tmp_path / "log.mcap", 400
    with DriveLog(file, simulation.header(), scene) as log:
        begin = file.stat().st_size
        for record in islice(simulation.steps(), steps):
            log.add_step(round(record.measurement.time * 1e9), record)
    hourly = 3600.0 / simulation.configuration.sample_time * (file.stat().st_size - begin) / steps * 1e-6
    print(f"\n{hourly:.1f} MB an hour")
    assert hourly < 30.0
    with file.open("rb") as stream:
        topics = Counter(channel.topic for _, channel, _ in make_reader(stream).iter_messages())
    assert topics == dict.fromkeys(("/step", "/tf", "/plan", "/tractor/fix", "/trailer/fix"), steps) | {
        "/path": 1,
        "/bodies": 1,
    }


def test_a_runs_log_fills_less_than_40_megabytes_an_hour(tmp_path, build):
    simulation, file, steps = build("articulated"), tmp_path / "log.mcap", 900
    with Recorder(file, simulation.header()) as log:
        begin = file.stat().st_size
        for record in islice(simulation.steps(), steps):
            log.write(record)
    hourly = 3600.0 / simulation.configuration.sample_time * (file.stat().st_size - begin) / steps * 1e-6
    assert 15.0 < hourly < 30.0


def test_a_drive_of_an_earlier_drawbar_is_refused_by_name(tmp_path, build):
    simulation, frame = build("articulated"), LocalFrame(latitude=50.0, longitude=4.0)
    scene = Scene(path=simulation.path, vehicle=simulation.configuration.vehicle, frame=frame)
    with DriveLog(tmp_path / "log.mcap", simulation.header(), scene) as log:
        log._add_plain("/raw/sensors", b"", 10**9)
    with open_drive(tmp_path / "log.mcap") as records, pytest.raises(DrawbarError, match="an earlier drawbar wrote it"):
        list(records)


@pytest.mark.parametrize("status", [Status.OK, Status.FINISHED])
def test_a_drive_has_finished_where_its_path_has_ended(tmp_path, build, status):
    simulation, frame = build("articulated"), LocalFrame(latitude=50.0, longitude=4.0)
    scene = Scene(path=simulation.path, vehicle=simulation.configuration.vehicle, frame=frame)
    record = dataclasses.replace(next(iter(simulation.steps())), status=status)
    with DriveLog(tmp_path / "log.mcap", simulation.header(), scene) as log:
        log.add_step(10**9, record)
    assert read_log(tmp_path / "log.mcap").outcome.finished == (status is Status.FINISHED)


def test_a_simulated_run_is_no_drive(tmp_path):
    configuration = load_configuration("articulated")
    path, _ = build_path(configuration)
    with Recorder(tmp_path / "log.mcap", run_header(configuration, path, None, seed=0)):
        pass
    assert not is_drive(tmp_path / "log.mcap")


def test_the_display_fits_sixty_columns_without_a_machine():
    console = Console(width=60, file=None, record=True, force_terminal=False)
    with console.capture() as capture:
        console.print(picture(None, None))
    assert all(len(line) <= 60 for line in capture.get().splitlines())
    assert KEYS.splitlines()[0] in capture.get()


def test_the_driver_is_told_to_stop_until_the_vehicle_stands():
    stopping = dataclasses.replace(gate_of(SupervisorState.FAULT), stop=1)
    for wheels, receiver, told in ((1.0, 0.0, True), (0.0, 1.0, False), (NAN, 0.0, False), (NAN, NAN, True)):
        speeds = {"wheel_speed": wheels, "receiver_speed": receiver}
        heard = dataclasses.replace(controller_of(Status.OK), correction_age=NAN, **speeds)
        assert ("STOP THE VEHICLE" in picture(stopping, heard).plain) == told
    assert "STOP THE VEHICLE" in picture(stopping, None).plain


def test_the_display_says_why_a_key_was_refused():
    assert Cause.OUT_OF_RANGE.sentence in picture(None, None, Cause.OUT_OF_RANGE).plain


def test_where_there_is_no_terminal_each_reason_against_engaging_or_to_worry_is_told_once():
    causes = (Cause.FIX_LOST, Cause.NO_OPERATOR)
    states = [
        dataclasses.replace(
            gate_state_of(sequence),
            state=state,
            steers=int(state is SupervisorState.ACTIVE),
            refusals=tuple(cause.value for cause in found) + (0,) * (8 - len(found)),
        )
        for sequence, (state, found) in enumerate(
            [
                (SupervisorState.STANDBY, causes[:1]),
                (SupervisorState.STANDBY, causes),
                (SupervisorState.STANDBY, causes[1:]),
                (SupervisorState.READY, ()),
                (SupervisorState.STANDBY, causes[:1]),
                (SupervisorState.ACTIVE, ()),
                (SupervisorState.ACTIVE, (Cause.TOO_SLOW, causes[0])),  # too slow to engage is no worry then
                (SupervisorState.ACTIVE, causes[:1]),
                (SupervisorState.FAULT, causes),
            ]
        )
    ]
    console, front = Console(file=StringIO(), width=60), SimpleNamespace(state=None, controller=None, refusal=None)
    terminal = Terminal(console, None, front)
    for front.state in states:
        terminal.show()
    first, second = (f"- {cause.sentence}: {cause.advice}\n" for cause in causes)
    waiting, ready = "STANDBY: not ready to engage\n", "READY: ready to engage\n"
    steering, ended = "ACTIVE: steering\n", "FAULT: let go of the steering; acknowledge to go on\n"
    told = [waiting, first, second, ready, waiting, first, steering, first, ended]
    assert console.file.getvalue() == "".join(told)


@pytest.mark.skipif(os.name == "nt", reason="POSIX terminals")
def test_no_key_waits_for_the_next_one(monkeypatch):
    far, near = os.openpty()
    with open(near, encoding="utf-8") as terminal, open(far, "wb", buffering=0) as keys:
        monkeypatch.setattr("sys.stdin", terminal)
        with Keyboard() as keyboard:
            assert keyboard.pressed() == ""
            keys.write(b"+x")
            assert keyboard.pressed() == "+x"
            assert keyboard.pressed() == ""


@pytest.mark.skipif(os.name == "nt", reason="POSIX terminals")
def test_no_key_is_pressed_on_a_terminal_that_is_gone(monkeypatch):
    far, near = os.openpty()
    with open(near, encoding="utf-8") as terminal:
        monkeypatch.setattr("sys.stdin", terminal)
        with Keyboard() as keyboard:
            os.close(far)
            assert keyboard.pressed() == ""


@pytest.mark.parametrize(
    ("wish", "change", "asked"),
    [(NAN, -0.1, 0.9), (NAN, 0.1, 1.0), (0.5, 0.1, 0.6), (0.15, -0.1, 0.1), (0.1, -0.1, 0.1), (0.95, 0.1, 1.0)],
)
def test_set_speed_changes_between_a_step_and_the_configured_one(wish, change, asked):
    state = dataclasses.replace(gate_state_of(1), set_speed=wish)  # which allows 0 m/s: it does not steer
    assert changed_speed(state, change, 1.0) == pytest.approx(asked)


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


@pytest.mark.parametrize("body", ["tractor", "trailer"])
def test_a_vehicle_that_no_stand_in_board_can_steer_is_refused(body):
    changes = [f"vehicle.{body}_steering_limit=0.9", f"machine.actuators.{body}_stop=1.0"]
    with pytest.raises(ConfigurationError, match=rf"vehicle\.{body}_steering_limit = 0\.9 rad: .* below 0\.8726 rad"):
        with_stand_ins(load_configuration("articulated", changes))


def test_what_is_kept_of_a_demonstration_names_no_stand_in_and_asks_for_the_wiggle_test():
    configuration = load_configuration("articulated")
    driven = with_stand_ins(configuration)
    assert driven.devices is not None
    assert without_stand_ins(driven) == configuration
    assert without_stand_ins(driven).safety.engage.wiggle_test
