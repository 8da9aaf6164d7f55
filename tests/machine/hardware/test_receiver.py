"""The receiver's driver: epochs out of a transport, and nothing of other senders."""

import datetime
import math

import pytest
from pydantic import ValidationError
from receiver_frames import nmea

from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.receiver import Receiver, ReceiverSettings
from drawbar.machine.stand_in.receiver import Report
from drawbar.transports.base import Received, Transport

BEGIN = datetime.datetime(2026, 11, 22, 12, tzinfo=datetime.UTC)


class Wire(Transport):
    """A transport that holds what a test puts there."""

    connected = True

    def __init__(self) -> None:
        self.waiting: list[Received] = []
        self.closed = False

    def fileno(self) -> int:
        return -1

    def read(self) -> list[Received]:
        waiting, self.waiting = self.waiting, []
        return waiting

    def write(self, data: bytes) -> bool:
        return bool(data)

    def close(self) -> None:
        self.closed = True


def gga(seconds: float, latitude: float = 50.0) -> bytes:
    time = BEGIN + datetime.timedelta(seconds=seconds)
    return nmea.gga(Report(time=time, latitude=latitude, longitude=4.0, height=0.0))


def test_bytes_become_epochs_when_their_time_has_come() -> None:
    wire = Wire()
    receiver = Receiver(wire, ReceiverSettings(transport="serial:/dev/ttyACM0@460800", latency=0.03))
    assert receiver.poll(9.0) == []
    assert (receiver.last_received, receiver.last, receiver.due) == (-math.inf, None, math.inf)
    sentence = gga(0.0)
    wire.waiting = [Received(10.0, sentence[:30])]
    assert receiver.poll(10.001) == []
    wire.waiting = [Received(10.004, sentence[30:])]
    assert receiver.poll(10.005) == []
    assert receiver.due == pytest.approx(10.024)
    (epoch,) = receiver.poll(receiver.due)
    assert (epoch.received, epoch.time) == (10.0, pytest.approx(9.97))
    assert receiver.last is epoch
    assert receiver.last_received == 10.004
    assert receiver.due == math.inf
    assert receiver.kinds == {"GGA": 1}
    receiver.close()
    assert wire.closed


@pytest.mark.parametrize("sender", ["192.168.5.126", ""])
def test_two_boards_on_one_port_are_told_apart(sender: str) -> None:
    wire = Wire()
    receiver = Receiver(wire, ReceiverSettings(transport="udp://0.0.0.0:9999", sender=sender))
    for step in range(3):
        wire.waiting += [
            Received(10.0 + step, gga(step, 50.0), "192.168.5.126:5120"),
            Received(10.001 + step, gga(step, 51.0), "192.168.5.127:5120"),
        ]
    epochs = receiver.poll(13.0)
    assert [epoch.latitude for epoch in epochs] == [50.0] * 3
    assert receiver.dropped == {"datagram of another sender": 3}


def test_replies_of_the_board_that_carries_the_receiver_are_no_noise_of_it():
    wire = Wire()
    receiver = Receiver(wire, ReceiverSettings(transport="udp://0.0.0.0:9999"))
    reply = Received(10.0, bytes.fromhex("80817efd08c8000f27b822070062"), "192.168.5.127:8888")
    wire.waiting = [
        reply,
        Received(10.0, gga(0, 50.0), "192.168.5.126:5120"),
        Received(11.0, gga(1, 50.0), "192.168.5.126:5120"),
    ]
    assert len(receiver.poll(12.0)) == 2
    assert receiver.dropped == {"reply of a board": 1}


def test_a_broken_off_sentence_is_given_up_after_a_silence() -> None:
    wire = Wire()
    receiver = Receiver(wire, ReceiverSettings(transport="tcp://127.0.0.1:28784"))
    wire.waiting = [Received(10.0, b"\xb5\x62\x01\x07\x00\x03" + gga(0.0))]
    assert receiver.poll(10.0) == []
    assert receiver.due == pytest.approx(10.05)
    (epoch,) = receiver.poll(receiver.due)
    assert epoch.received == 10.0
    assert receiver.dropped == {"incomplete": 1, "noise bytes": 5}


def on_can(sender: str) -> dict[str, str]:
    return {"transport": "can:virtual:x", "sender": sender}


@pytest.mark.parametrize("senders", [("", ""), ("32", ""), ("32", "32")])
def test_two_receivers_on_one_can_bus_need_two_senders(senders: tuple[str, str]) -> None:
    boards = {
        body: {"address": f"192.168.{net}.126", "max_angle": 0.3} for net, body in ((5, "tractor"), (6, "trailer"))
    }
    devices: dict[str, object] = {f"{body}_board": board for body, board in boards.items()}
    devices |= {"tractor_receiver": on_can(senders[0]), "trailer_receiver": on_can(senders[1])}
    with pytest.raises(ValidationError, match="need a sender each"):
        DeviceSettings.model_validate(devices)
    DeviceSettings.model_validate(devices | {"trailer_receiver": on_can("33"), "tractor_receiver": on_can("32")})


def test_a_sender_on_a_can_bus_is_a_number() -> None:
    with pytest.raises(ValidationError, match="no address on a CAN bus"):
        ReceiverSettings.model_validate(on_can("192.168.5.126"))
