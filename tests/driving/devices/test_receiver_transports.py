"""Both receivers' lines: one UDP port for two, the boards' port, and what one line for two devices is refused for."""

import socket

import pytest
from pydantic import ValidationError

from drawbar.driving.devices.receiver_transports import open_receivers
from drawbar.driving.stand_in.demonstration import free_ports
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.receiver import Receiver

BOARDS = {
    "tractor_board": {"address": "127.0.5.126", "max_angle": 0.5},
    "trailer_board": {"address": "127.0.6.126", "max_angle": 0.3},
}


def devices(tractor, trailer, **others):
    receivers = {"tractor_receiver": {"transport": tractor}, "trailer_receiver": {"transport": trailer}}
    for name, sender in others.pop("senders", {}).items():
        receivers[name]["sender"] = sender
    return DeviceSettings.model_validate(receivers | BOARDS | others)


SENDERS = {"tractor_receiver": "127.0.5.126", "trailer_receiver": "127.0.6.126"}


def test_two_receivers_that_send_to_one_port_are_each_heard(tmp_path):
    (port,) = free_ports(socket.SOCK_DGRAM, 1)
    settings = devices(f"udp://127.0.0.1:{port}", f"udp://127.0.0.1:{port}", senders=SENDERS)
    lines = open_receivers(settings, str(tmp_path / "none"))
    receivers = [
        Receiver(line, each)
        for line, each in zip(lines, (settings.tractor_receiver, settings.trailer_receiver), strict=True)
    ]
    for host in SENDERS.values():
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as board:
            board.bind((host, 0))
            board.sendto(b"noise", ("127.0.0.1", port))
    for receiver in receivers:
        receiver.poll(0.0)
        assert receiver.last_received > 0.0
        assert receiver.dropped["datagram of another sender"] == 1
        receiver.close()


@pytest.mark.parametrize(
    ("tractor", "trailer", "on_boards"),
    [
        ("udp://0.0.0.0:9999", "udp://0.0.0.0:9999", 2),
        ("udp://192.168.5.10:9999", "serial:/dev/ttyACM0@460800", 1),
        ("udp://0.0.0.0:9998", "tcp://127.0.0.1:9999", 0),
        ("can:virtual:9999", "file:9999", 0),
    ],
)
def test_receivers_at_the_boards_port_are_known(tractor, trailer, on_boards):
    assert len(devices(tractor, trailer, senders=SENDERS if on_boards == 2 else {}).receivers_on_boards) == on_boards


SENSORS = {"transport": "serial:/dev/ttyUSB1@115200", "pulses_per_metre": 100.0}


@pytest.mark.parametrize(
    ("tractor", "trailer", "others", "why"),
    [
        ("tcp://10.0.0.1:28784", "tcp://10.0.0.1:28784", {}, "both receivers have one transport, tcp://10.0.0.1:28784"),
        ("serial:/dev/ttyACM0@460800", "serial:/dev/ttyACM0@460800", {}, "give each its own"),
        ("udp://0.0.0.0:9999", "udp://0.0.0.0:9999", {}, "need a sender each"),
        ("can:virtual:x", "can:virtual:x", {}, "need a sender each"),
        ("tcp://10.0.0.1:28784", "serial:/dev/ttyUSB1@115200", {"sensors": SENSORS}, "a receiver and sensors"),
    ],
)
def test_one_line_for_two_devices_is_refused(tractor, trailer, others, why):
    with pytest.raises(ValidationError, match=why):
        devices(tractor, trailer, **others)
