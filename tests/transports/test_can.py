"""CAN buses of python-can: frames both ways over each interface without hardware; garbage is dropped and counted."""

import errno
import os
import pty
import socket
import termios
import time
import tty
from pathlib import Path

import can
import pytest
from waiting import FakeClock, until

from drawbar.transports.address import CanAddress
from drawbar.transports.base import CanBus, CanFrame
from drawbar.transports.can import RETRY, PythonCanBus
from drawbar.transports.open import open_can

CLAIM = CanFrame(0x18EEFF1C, bytes.fromhex("3930E0AF001D02A0"))


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        return int(probe.getsockname()[1])


def cross(one: CanBus, other: CanBus) -> None:
    """Frames written to one come out of the other, in order, stamped with when they were sent."""
    assert one.connected, one.trouble
    before = time.monotonic()
    sent = [CLAIM, CanFrame(0x0CADFF1C, b""), CanFrame(0x1FFFFFFF, b"\x01")]
    assert all(one.write(frame) for frame in sent)
    received: list[tuple[float, CanFrame]] = []
    until(lambda: received.extend(other.read()) or len(received) >= len(sent))
    assert [frame for _, frame in received] == sent
    assert all(before - 0.01 <= moment <= time.monotonic() for moment, _ in received)
    assert one.read() == []


@pytest.mark.parametrize("kind", ["virtual", "udp_multicast"])
def test_frames_cross_between_two_nodes(kind: str) -> None:
    channel = "a-bus-of-this-test" if kind == "virtual" else f"239.74.163.2:{free_port()}"
    one, other = (open_can(f"can:{kind}:{channel}") for _ in range(2))
    if kind == "udp_multicast" and not one.connected:
        pytest.skip(f"no multicast here: {one.trouble}")
    cross(one, other)
    cross(other, one)
    for each in (one, other):
        each.close()
        assert not each.connected
        assert not each.write(CLAIM)
        assert each.unsent == 1


def test_an_adapter_that_goes_while_it_is_opened_is_tried_again(monkeypatch: pytest.MonkeyPatch) -> None:
    def gone(**options: object) -> None:
        raise termios.error(errno.EIO, "Input/output error")

    clock = FakeClock()
    with monkeypatch.context() as patch:
        patch.setattr(can, "Bus", gone)
        bus = PythonCanBus(CanAddress(interface="virtual", channel="an-adapter-of-this-test"), clock)
    assert not bus.connected
    assert "cannot be opened" in bus.trouble
    clock.now += RETRY
    bus.read()
    assert bus.connected
    bus.close()


def test_multicast_delivers_the_same_frame_of_another_node() -> None:
    port = free_port()
    one, other = (open_can(f"can:udp_multicast:239.74.163.2:{port}") for _ in range(2))
    if not one.connected:
        pytest.skip(f"no multicast here: {one.trouble}")
    assert one.write(CLAIM)
    assert other.write(CLAIM)
    for each in (one, other):
        assert [frame for _, frame in until(each.read)] == [CLAIM], "a duplicate address must be seen"
        time.sleep(0.01)
        assert each.read() == []
        each.close()


def test_only_data_frames_with_long_identifiers_come_out() -> None:
    bus = PythonCanBus(CanAddress(interface="virtual", channel="kinds"))
    assert bus.fileno() == -1
    with can.Bus(interface="virtual", channel="kinds", protocol=can.CanProtocol.CAN_FD) as other:
        other.send(can.Message(arbitration_id=0x123, is_extended_id=False))
        other.send(can.Message(arbitration_id=0x123, is_remote_frame=True))
        other.send(can.Message(is_error_frame=True))
        other.send(can.Message(arbitration_id=0x123, is_fd=True, data=bytes(64)))
        other.send(can.Message(arbitration_id=CLAIM.identifier, data=CLAIM.data))
        assert [frame for _, frame in bus.read()] == [CLAIM]
    assert bus.dropped == {"11-bit identifier": 1, "remote frame": 1, "error frame": 1, "CAN FD frame": 1}
    bus.close()


def test_foreign_datagrams_on_the_multicast_group_are_dropped() -> None:
    port = free_port()
    bus = PythonCanBus(CanAddress(interface="udp_multicast", channel="239.74.163.2", number=port))
    if not bus.connected:
        pytest.skip(f"no multicast here: {bus.trouble}")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        for garbage in (b"", b"\xc1", b"hello", bytes(2000)):
            sender.sendto(garbage, ("239.74.163.2", port))
    other = PythonCanBus(CanAddress(interface="udp_multicast", channel="239.74.163.2", number=port))
    assert other.write(CLAIM)
    assert until(bus.read)[0][1] == CLAIM
    assert bus.dropped["garbage"] >= 3
    assert bus.connected
    bus.close()
    other.close()


def read_to(far: int, ending: bytes) -> bytes:
    """Return what comes out of a serial line, up to an ending."""
    data = b""
    while not data.endswith(ending):
        data += os.read(far, 1000)
    return data


def test_slcan_adapter_on_a_serial_line(tmp_path: Path) -> None:
    far, near = pty.openpty()
    tty.setraw(far)
    tty.setraw(near)
    clock = FakeClock()
    bus = PythonCanBus(CanAddress(interface="slcan", channel=os.ttyname(near), number=115200), clock, time.time)
    assert bus.connected, bus.trouble
    read_to(far, b"O\r")
    assert bus.write(CLAIM)
    assert read_to(far, b"A0\r") == b"T18EEFF1C83930E0AF001D02A0\r"
    os.write(far, b"Tnonsense\rT18EE\r\xff\xfe\r")
    until(lambda: bus.read() == [] and bus.dropped["garbage"] >= 3)
    os.write(far, b"T18EEFF1C83930E0AF001D02A0\r")
    assert until(bus.read)[0][1] == CLAIM
    os.close(far)
    os.close(near)
    until(lambda: bus.read() == [] and not bus.connected)
    assert "is lost" in bus.trouble
    clock.now += RETRY
    assert bus.read() == []
    assert "cannot be opened" in bus.trouble
    bus.close()


def test_interface_that_is_not_there_is_reported_and_tried_again() -> None:
    clock = FakeClock()
    bus = PythonCanBus(CanAddress(interface="socketcan", channel="none7"), clock)
    assert not bus.connected
    assert "socketcan none7 cannot be opened" in bus.trouble
    bus.trouble = ""
    bus.read()
    assert bus.trouble == "", "it is not asked again at once"
    clock.now += RETRY
    bus.read()
    assert "cannot be opened" in bus.trouble


class SocketcanInterface:
    """A kernel's CAN interface, as python-can's socketcan shows it: up, off the bus (its queue is full), or down."""

    state = "up"

    def __init__(self, **options: object) -> None:
        self.sent: list[can.Message] = []

    def send(self, message: can.Message) -> None:
        if self.state == "off the bus":
            raise can.CanOperationError("Transmit buffer full")
        self._fail_where_down("Failed to transmit")
        self.sent.append(message)

    def recv(self, timeout: float) -> can.Message | None:
        self._fail_where_down("Error receiving")
        return None

    def fileno(self) -> int:
        return 0

    def shutdown(self) -> None:
        pass

    def _fail_where_down(self, what: str) -> None:
        if self.state == "down":
            try:
                raise OSError(errno.ENETDOWN, "Network is down")
            except OSError as error:
                raise can.CanOperationError(f"{what}: {error.strerror}", error.errno) from error


@pytest.mark.parametrize("state", ["off the bus", "down"])
def test_an_interface_that_fails_takes_no_frame_never_raises_and_is_used_again(
    monkeypatch: pytest.MonkeyPatch, state: str
) -> None:
    monkeypatch.setattr(can, "Bus", SocketcanInterface)
    clock = FakeClock()
    bus = PythonCanBus(CanAddress(interface="socketcan", channel="can0"), clock)
    assert bus.write(CLAIM)
    monkeypatch.setattr(SocketcanInterface, "state", state)
    assert not bus.write(CLAIM)
    assert "socketcan can0 took no frame" in bus.trouble
    assert bus.unsent == 1
    assert bus.read() == []
    assert bus.connected == (state == "off the bus"), "a receiver hears on where the controller has left the bus"
    for _ in range(3):
        clock.now += RETRY
        assert bus.read() == []
        assert not bus.write(CLAIM)
    monkeypatch.setattr(SocketcanInterface, "state", "up")
    clock.now += RETRY
    assert bus.read() == []
    assert bus.connected
    assert bus.write(CLAIM)
    bus.close()


def test_socketcan_carries_frames() -> None:
    names = [name for _, name in socket.if_nameindex() if name.startswith(("vcan", "can"))]
    if not names:
        pytest.skip("no CAN interface (can0, vcan0) on this machine; `ip link add type vcan` needs a kernel module")
    one, other = (open_can(f"can:socketcan:{names[0]}") for _ in range(2))
    if not one.connected:
        pytest.skip(f"{names[0]} is not up: {one.trouble}")
    cross(one, other)
    for each in (one, other):
        each.close()
        assert not each.connected
