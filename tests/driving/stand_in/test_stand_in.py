"""`drawbar stand-in` with faults, and a drive against it: two programs, real sockets on loopback, real time."""

import socket
import subprocess
import sys
import time
from contextlib import closing, contextmanager
from itertools import takewhile

import pytest
from patience import ENGAGE, PATIENT, watch
from waiting import until

from drawbar.config import load_configuration
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.driving.devices.pace import shown_pace
from drawbar.driving.devices.path_frame import local_frame
from drawbar.driving.operator.front_end import FrontEnd
from drawbar.driving.preparation.check import check
from drawbar.driving.preparation.wiggle import wiggle_both
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.driving.stand_in.demonstration import free_ports, with_isobus, with_stand_ins
from drawbar.driving.stand_in.device_transports import BoardLine, open_line
from drawbar.errors import HardwareError
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.hardware.receiver import ReceiverSettings
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.machine.stand_in.board import Output
from drawbar.messages import SupervisorState
from drawbar.protocols.agopengps.network import HELLO
from drawbar.recording.drive_records import RawBytes, open_drive
from drawbar.safety.causes import Cause

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
FAULTS = ("--fault", "receivers-silent@3s", "--fault", "board-silent@7s")
ATTEMPTS = 4
"""of a drive: on a computer that is busy with other tests a board may be late by itself, which ends one"""
QUICK = ["safety.timing.angle=0.5", "safety.timing.angle_lost=1.0"]


@pytest.fixture
def configuration(tmp_path):
    """Return a configuration with devices at free ports, and its file."""
    configuration = with_stand_ins(load_configuration("articulated", ["path.radii=[8.0]", *PATIENT, *QUICK]))
    file = tmp_path / CONFIGURATION_NAME
    file.write_text(configuration.to_toml(), "utf-8")
    return configuration, file


@contextmanager
def served(file, tmp_path, *options):
    """Let the program run, its words in a file."""
    words = tmp_path / "stand-in.txt"
    command = [sys.executable, "-m", "drawbar", "stand-in", str(file), *options]
    with words.open("wb") as output:
        process = subprocess.Popen(command, stdout=output, stderr=output)
    try:
        devices = load_configuration(str(file)).devices
        until(lambda: shown_pace(devices), ENGAGE)
        yield words
    finally:
        process.terminate()
        assert process.wait(ENGAGE) == 0, words.read_text()


def test_the_wiggle_test_is_passed_against_a_stand_in(configuration, tmp_path):
    with served(configuration[1], tmp_path):
        for _ in range(ATTEMPTS):
            found = dict(wiggle_both(configuration[0]))
            if not any("missing or old" in words for each in found.values() for words in each.refusals):
                break
    assert all(each.passed for each in found.values()), found
    assert found.keys() == {"front wheels", "joint"}


def test_a_second_stand_in_of_the_same_bus_ends_with_one_message(tmp_path):
    file = tmp_path / CONFIGURATION_NAME
    file.write_text(with_isobus(load_configuration("articulated")).to_toml(), "utf-8")
    with served(file, tmp_path):
        command = [sys.executable, "-m", "drawbar", "stand-in", str(file)]
        second = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300.0)
    assert second.returncode == 2
    told = "stand-in: another stand-in of these devices runs (Address already in use); end it"
    assert second.stderr.splitlines() == [told]


def test_a_drive_against_a_stand_in_whose_receivers_and_then_a_board_fall_silent(configuration, tmp_path):
    for attempt in range(ATTEMPTS):
        folder = tmp_path / str(attempt)
        folder.mkdir()
        file = folder / CONFIGURATION_NAME
        file.write_text(configuration[0].to_toml(), "utf-8")
        with (
            served(file, folder, *FAULTS) as words,
            DriveProcesses(configuration[0], folder, stand_ins=False) as processes,
        ):
            front = FrontEnd(processes, demonstrates=True)
            watch(front, lambda front: front.is_over or is_degraded(front), ENGAGE)
            begun = "both receivers fall silent" in words.read_text()
            if begun:
                assert is_degraded(front), front.state
                assert front.state.cause == Cause.FIX_LOST.value
                state = watch(front, lambda front: not front.state.steers, 30.0)
                assert state.state is SupervisorState.FAULT
                assert state.cause in (Cause.STEERING_LOST.value, Cause.ACTUATOR_RELEASED.value, Cause.SILENT.value)
                assert "front wheels' board says nothing" in words.read_text()
            front.close()
        if begun:
            return
    raise AssertionError(f"{ATTEMPTS} drives were over before anything was broken")


def is_degraded(front):
    return front.state is not None and front.state.state is SupervisorState.DEGRADED


def test_an_emergency_stop_that_is_first_tried_after_it_rolls_can_be_acknowledged(configuration, tmp_path):
    safety = configuration[0].safety
    engage = safety.engage.model_copy(update={"emergency_test": False})  # else it would stand until then
    machine = configuration[0].model_copy(update={"safety": safety.model_copy(update={"engage": engage})})
    with (
        served(configuration[1], tmp_path, "--pace", "3"),
        DriveProcesses(machine, tmp_path, stand_ins=False, pace=3) as processes,
    ):
        front = FrontEnd(processes, demonstrates=False)
        watch(front, lambda front: front.controller is not None and front.controller.wheel_speed > 0.2, ENGAGE)
        front.press("x")
        watch(front, lambda front: front.state.state is SupervisorState.ESTOP, ENGAGE)
        watch(front, lambda front: front.controller.wheel_speed == 0.0, ENGAGE)
        watch(front, lambda front: front.press("a") or front.state.state is SupervisorState.STANDBY, ENGAGE)
        watch(front, lambda front: front.controller.wheel_speed > 0.2, ENGAGE)
        assert front.state.state is SupervisorState.STANDBY
        front.close()


@pytest.fixture
def corrected(configuration, monkeypatch):
    """Return the configuration with corrections from a caster on this computer, and its file."""
    whole, file = configuration
    monkeypatch.setenv("LOGIN", "farmer:s3cret")
    (port,) = free_ports(socket.SOCK_STREAM, 1)
    caster = CorrectionsSettings(host="127.0.0.1", port=port, mount="VRS", credentials="environment:LOGIN")
    whole = whole.model_copy(update={"devices": whole.devices.model_copy(update={"corrections": caster})})
    file.write_text(whole.to_toml(), "utf-8")
    return whole, file


def test_a_drive_with_aio_26_boards_and_corrections_from_the_stand_ins_caster(corrected, tmp_path):
    configuration, file = corrected
    with (
        served(file, tmp_path, "--boards", "aio-26"),
        DriveProcesses(configuration, tmp_path, stand_ins=False) as processes,
    ):
        front = FrontEnd(processes, demonstrates=True)
        state = watch(front, lambda front: front.state and front.state.state is SupervisorState.ACTIVE, ENGAGE)
        assert state.steers
        front.close()
    with open_drive(tmp_path / "log.mcap") as records:
        sent = {record.device for record in records if isinstance(record, RawBytes) and record.data[:1] == b"\xd3"}
    assert sent == {"tractor_receiver", "trailer_receiver"}


def test_receivers_have_no_rtk_fix_without_the_corrections_that_they_wait_for(corrected, tmp_path):
    configuration, file = corrected
    with served(file, tmp_path):
        devices, frame = configuration.devices, local_frame(configuration)
        alone = devices.model_copy(update={"corrections": None})
        without = heard(lambda: next(check(alone, frame, 1.0, configuration.sample_time, oldest=5.0)))
        findings = {
            finding.device: finding for finding in check(devices, frame, 3.0, configuration.sample_time, oldest=5.0)
        }
    assert "fix single" in "; ".join(without.facts)
    assert any("no RTK fix" in problem for problem in without.problems)
    assert "fix fixed" in "; ".join(findings["tractor receiver"].facts)
    assert "fix fixed" in "; ".join(findings["trailer receiver"].facts)
    assert "wheels 0.00 m/s" in findings["sensor board"].facts, "it stands where a drive can begin"
    assert findings["corrections"].facts == ["RTCM 1005, 1077"]
    assert "scan: steer board 192.168.5.126" in findings["tractor board"].facts
    assert "scan: steer board 192.168.6.126" in findings["trailer board"].facts


@pytest.mark.parametrize(("firmware", "unasked"), [("aio-v4", False), ("aio-26", True)])
def test_the_firmware_of_its_boards_can_be_chosen(configuration, tmp_path, firmware, unasked):
    board = configuration[0].devices.tractor_board
    with served(configuration[1], tmp_path, "--boards", firmware), socket.socket(type=socket.SOCK_DGRAM) as computer:
        computer.bind(board.listening)
        computer.settimeout(0.5)
        until(lambda: computer.sendto(HELLO, board.destination) and received(computer), ENGAGE)
        computer.settimeout(ENGAGE if unasked else 0.5)
        more = list(takewhile(bool, (received(computer) for _ in range(20))))
    assert (len(more) == 20) == unasked, "only an AiO_26 reports at 100 Hz by itself"


def received(computer):
    """Return the next datagram; nothing where none comes, or nobody is there yet."""
    try:
        return computer.recv(100)
    except OSError:
        return b""


def heard(look):
    """Look at a device until its program has begun; return what was found."""
    end = time.monotonic() + ENGAGE
    while not (finding := look()).received:
        assert time.monotonic() < end
    return finding


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["--fault", "list"], 0, ["fixes-jump: both receivers' positions jump 1 m to the left", "bus-off: "]),
        (["--fault", "nothing@3s"], 1, ["there is no fault 'nothing'", "receivers-silent"]),
        (["--fault", "bus-off"], 1, ["needs devices.isobus, which the configuration does not have"]),
    ],
)
def test_which_faults_there_are_is_reported(configuration, arguments, code, words):
    command = [sys.executable, "-m", "drawbar", "stand-in", str(configuration[1]), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300.0, check=False)
    said = " ".join((done.stdout + done.stderr).split())
    for part in words:
        assert part in said
    assert (done.returncode != 0) == code


def test_what_can_be_broken_is_listed_without_a_configuration(tmp_path):
    command = [sys.executable, "-m", "drawbar", "stand-in", "--fault", "list"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300.0, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "bus-off: " in done.stdout


@pytest.fixture
def serial(configuration, tmp_path):
    """Return the configuration with all lines that can be serial ones at names in a folder, and its file."""
    whole, file = configuration
    lines = {
        name: getattr(whole.devices, name).model_copy(update={"transport": f"serial:{tmp_path / name}@115200"})
        for name in ("tractor_receiver", "trailer_receiver", "sensors")
    }
    whole = whole.model_copy(update={"devices": whole.devices.model_copy(update=lines)})
    file.write_text(whole.to_toml(), "utf-8")
    return whole, file


def test_a_drive_over_serial_lines_which_are_gone_with_the_stand_in(serial, tmp_path):
    configuration, file = serial
    (tmp_path / "tractor_receiver").symlink_to("/dev/pts/4711")  # of a stand-in that was killed
    with (
        served(file, tmp_path),
        DriveProcesses(configuration, tmp_path, stand_ins=False) as processes,
    ):
        front = FrontEnd(processes, demonstrates=True)
        watch(front, lambda front: front.state and front.state.state is SupervisorState.ACTIVE, ENGAGE)
        assert front.controller.wheel_speed > 0.0, "the sensor board is heard"
        front.close()
    assert not any((tmp_path / name).is_symlink() for name in ("tractor_receiver", "trailer_receiver", "sensors"))


def test_a_serial_line_that_there_is_already_is_left_alone(serial, tmp_path):
    (tmp_path / "trailer_receiver").write_text("a device")
    command = [sys.executable, "-m", "drawbar", "stand-in", str(serial[1])]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300.0, check=False)
    assert done.returncode == 2
    said = " ".join((done.stdout + done.stderr).split())
    assert "name a file that there is not yet" in said
    assert "the simulated machine is there" not in said
    assert (tmp_path / "trailer_receiver").read_text() == "a device"
    assert not (tmp_path / "tractor_receiver").is_symlink(), "what was opened before is closed again"


def test_a_drive_whose_receivers_are_on_the_boards_and_send_to_the_port_of_their_replies(configuration, tmp_path):
    whole, file = configuration
    devices = whole.devices
    receivers = {
        f"{body}_receiver": ReceiverSettings(
            transport=f"udp://{getattr(devices, f'{body}_board').listen}", sender=f"127.0.{subnet}.126"
        )
        for body, subnet in (("tractor", 5), ("trailer", 6))
    }
    whole = whole.model_copy(update={"devices": devices.model_copy(update=receivers)})
    file.write_text(whole.to_toml(), "utf-8")
    with (
        served(file, tmp_path),
        DriveProcesses(whole, tmp_path, stand_ins=False) as processes,
    ):
        front = FrontEnd(processes, demonstrates=True)
        state = watch(front, lambda front: front.state and front.state.state is SupervisorState.ACTIVE, ENGAGE)
        assert state.steers
        front.close()


def test_a_board_that_speaks_unasked_is_heard_by_who_only_listens():
    board, listen = free_ports(socket.SOCK_DGRAM, 2)
    settings = SteerBoardSettings(address=f"127.0.0.1:{board}", listen=f"0.0.0.0:{listen}", max_angle=0.5)
    with closing(BoardLine(settings)) as line, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as shadow:
        line.send(Output(0.0, b"nobody hears it", ""))
        shadow.bind(("0.0.0.0", listen))
        shadow.settimeout(5.0)
        line.send(Output(0.0, b"angle", ""))
        assert shadow.recv(100) == b"angle"


@pytest.mark.parametrize(
    ("address", "advice"), [("tcp://192.0.2.77:5000", "give this computer that address"), (None, "end the program")]
)
def test_a_stand_in_that_cannot_be_at_an_address_says_what_to_do(address, advice):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(HardwareError, match=advice):
            open_line(address or f"tcp://127.0.0.1:{taken.getsockname()[1]}")
