"""Who may be driven faster than real time: a stand-in on this computer, at the pace that it shows."""

import subprocess
import sys
from types import SimpleNamespace

import pytest
from isobus_devices import isobus_devices
from pydantic import ValidationError

from drawbar.config import load_configuration
from drawbar.driving.devices import pace as paces
from drawbar.driving.devices.pace import demand_stand_in, driver_socket, refuse_elsewhere, shown_pace
from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.processes.drive_processes import gate_options
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.errors import ConfigurationError, HardwareError
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.hardware.receiver import ReceiverSettings
from drawbar.machine.hardware.steer_board import SteerBoardSettings

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
REAL = {
    "tractor_receiver": ReceiverSettings(transport="serial:/dev/ttyACM0@460800"),
    "trailer_receiver": ReceiverSettings(transport="tcp://192.168.3.1:28784"),
    "tractor_board": SteerBoardSettings(address="192.168.5.126", max_angle=0.5),
    "corrections": CorrectionsSettings(host="rtk.example.org", mount="VRS"),
}


@pytest.fixture
def devices():
    return with_stand_ins(load_configuration("articulated")).devices


def test_devices_on_this_computer_may_be_faster(devices):
    here = isobus_devices("can:udp_multicast:239.74.163.2:43113", "can:socketcan:vcan0")
    assert not is_elsewhere(devices)
    assert not is_elsewhere(here)


def is_elsewhere(devices):
    """Return whether a pace is refused, as for what may not be on this computer."""
    try:
        refuse_elsewhere(devices, 10)
    except ConfigurationError:
        return True
    return False


@pytest.mark.parametrize("name", REAL)
def test_a_device_that_may_be_a_real_one_is_driven_in_real_time_only(devices, name):
    machine = devices.model_copy(update={name: REAL[name]})
    refuse_elsewhere(machine, 1)
    with pytest.raises(ConfigurationError, match=f"--pace 2 is for stand-ins.*: devices.{name}; leave out --pace"):
        refuse_elsewhere(machine, 2)


@pytest.mark.parametrize("bus", ["can:socketcan:can0", "can:slcan:/dev/ttyACM0@115200"])
def test_a_can_bus_with_wires_is_driven_in_real_time_only(bus):
    with pytest.raises(ConfigurationError, match=r"devices.isobus"):
        refuse_elsewhere(isobus_devices(bus), 2)


def test_corrections_that_are_passed_on_to_a_board_are_somewhere_else(devices):
    onward = CorrectionsSettings(host="127.0.0.1", mount="VRS", forward=["udp://0.0.0.0:0?peer=192.168.5.126:2233"])
    with pytest.raises(ConfigurationError, match=r"devices.corrections"):
        refuse_elsewhere(devices.model_copy(update={"corrections": onward}), 2)


def test_the_gate_refuses_by_itself_to_be_faster_than_a_machine(devices):
    configuration = load_configuration("articulated").model_copy(update={"devices": devices})
    assert gate_options(configuration, "", 0, 10).clock.pace == 10
    for change in ({"tractor_board": REAL["tractor_board"]}, {"isobus": isobus_devices("can:socketcan:can0").isobus}):
        machine = SimpleNamespace(
            devices=devices.model_copy(update=change), vehicle=configuration.vehicle, safety=configuration.safety
        )
        assert gate_options(machine, "", 0).clock.pace == 1
        with pytest.raises(ValidationError, match="driven at pace 1, not 10"):
            gate_options(machine, "", 0, 10)


@pytest.mark.parametrize(
    ("command", "changes", "words"),
    [
        ("drive", {"tractor_receiver": REAL["tractor_receiver"]}, "may be real ones: devices.tractor_receiver"),
        ("drive", {}, "none runs at the devices of this configuration"),
        ("stand-in", {"tractor_board": REAL["tractor_board"]}, "may be real ones: devices.tractor_board"),
    ],
)
def test_a_machine_that_may_be_real_is_refused(devices, tmp_path, command, changes, words):
    configuration = load_configuration("articulated").model_copy(update={"devices": devices.model_copy(update=changes)})
    (tmp_path / "machine.toml").write_text(configuration.to_toml(), "utf-8")
    assert words in refused(tmp_path, command, "machine.toml", "--pace", "2")


def test_the_console_shows_drives_in_real_time_only(tmp_path):
    assert "leave out --pace 2, or --console" in refused(tmp_path, "drive", "--pace", "2", "--console")


@pytest.mark.parametrize("pace", ["0", "11", "1.5"])
def test_a_pace_beyond_its_range_is_refused(tmp_path, pace):
    assert "'--pace'" in refused(tmp_path, "drive", "--pace", pace)


def refused(folder, *arguments):
    """Let drawbar refuse a command that leaves nothing; return what it says."""
    command = [sys.executable, "-m", "drawbar", *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300.0, check=False)
    assert done.returncode, done.stdout
    assert not (folder / "runs").exists()
    return " ".join((done.stdout + done.stderr).split())


def test_a_drive_is_as_fast_as_the_stand_in(devices):
    assert shown_pace(devices) is None
    demand_stand_in(devices, 1)
    with pytest.raises(HardwareError, match="none runs at the devices of this configuration; start `drawbar stand-in"):
        demand_stand_in(devices, 10)
    endpoint = Endpoint(driver_socket(devices, 10))
    try:
        assert shown_pace(devices) == 10
        demand_stand_in(devices, 10)
        for pace in (1, 5):
            with pytest.raises(HardwareError, match=f"runs at --pace 10, not {pace}; give the same to both"):
                demand_stand_in(devices, pace)
        other = devices.model_copy(update={"sensors": None})
        assert shown_pace(other) is None, "a stand-in of other devices is another one"
    finally:
        endpoint.close()
    assert shown_pace(devices) is None


def test_without_a_list_of_sockets_no_stand_in_is_found(devices, monkeypatch, tmp_path):
    monkeypatch.setattr(paces, "_SOCKETS", tmp_path / "none")
    demand_stand_in(devices, 1)
    with pytest.raises(HardwareError, match="none runs at the devices"):
        demand_stand_in(devices, 2)
