"""The gate's sockets and wires: nothing waits, nothing grows, and an end is seen."""

import os
import socket
import stat

import pytest
from gate_bench import FakeSpeed, FakeSteering, FakeTransport

from drawbar.errors import HardwareError
from drawbar.protocols.actuator import SteeringReport, SteeringRequest
from drawbar.protocols.speed_actuator import SpeedReport, SpeedRequest
from drawbar.safety.channels import ControllerChannel, OperatorChannel, controller_pair, open_operator_socket
from drawbar.safety.wires import Wire, Wires
from drawbar.transports.base import CanBus, CanFrame

OFF = SteeringRequest(steer=False, angle=0.0, speed=0.0)
STOP = SpeedRequest(drive=False, speed=0.0, deceleration=1.0)


@pytest.fixture
def pair():
    gate, controller = controller_pair()
    channel = ControllerChannel(gate)
    yield channel, controller
    channel.close()
    controller.close()


def test_records_come_whole_in_order_and_at_most_so_many(pair):
    channel, controller = pair
    assert channel.receive(5) == []
    for record in (b"a", b"bb", b"ccc"):
        controller.send(record)
    assert channel.receive(2) == [b"a", b"bb"]
    assert channel.receive(2) == [b"ccc"]
    assert not channel.gone
    assert channel.fileno() > 0


def test_the_other_end_closing_is_seen_after_what_it_said(pair):
    channel, controller = pair
    controller.send(b"last")
    controller.close()
    assert channel.receive(5) == [b"last"]
    assert channel.gone
    assert channel.receive(5) == []
    channel.send(b"nobody listens")


def test_a_broken_channel_is_one_that_has_ended(pair):
    channel, _ = pair
    channel.close()
    assert channel.receive(5) == []
    assert channel.gone


def test_a_controller_that_does_not_read_is_not_waited_for(pair):
    channel, controller = pair
    for _ in range(5000):
        channel.send(bytes(169))
    assert len(controller.recv(4096)) == 169


@pytest.fixture
def operators(tmp_path):
    channel = OperatorChannel(open_operator_socket(str(tmp_path / "operators")), (str(tmp_path / "fixed"),))
    yield channel, tmp_path
    channel.close()


def front_end(folder, name):
    front = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    front.bind(str(folder / name))
    front.setblocking(False)
    return front


def test_the_operators_socket_is_for_its_user_alone_and_takes_the_place_of_an_old_one(tmp_path):
    path = str(tmp_path / "operators")
    before = os.umask(0o022)
    os.umask(before)
    for _ in range(2):
        open_operator_socket(path).close()
        assert stat.S_IMODE(os.stat(path).st_mode) == 0o600
    assert os.umask(before) == before, "others' files are made as before"


def test_an_operators_socket_that_cannot_be_is_refused_with_what_to_do(tmp_path):
    (tmp_path / "file").write_text("somebody's")
    for path in (tmp_path / "file", tmp_path / "none" / "operators", tmp_path / ("x" * 120)):
        with pytest.raises(HardwareError, match="Give the path of a new file"):
            open_operator_socket(str(path))
    assert (tmp_path / "file").read_text() == "somebody's"


def test_what_operators_send_comes_with_its_sender(operators):
    channel, folder = operators
    with front_end(folder, "front") as front, socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as nameless:
        front.sendto(b"a", str(folder / "operators"))
        nameless.sendto(b"b", str(folder / "operators"))
        front.sendto(b"c", str(folder / "operators"))
        assert channel.receive(2) == [(b"a", str(folder / "front")), (b"b", "")]
        assert channel.receive(2) == [(b"c", str(folder / "front"))]
        assert channel.receive(2) == []
    assert channel.fileno() > 0


def test_states_go_to_those_given_at_the_start_and_to_senders_until_they_are_gone(operators):
    channel, folder = operators
    channel.publish(b"nobody is there yet")
    fixed, front = front_end(folder, "fixed"), front_end(folder, "front")
    for sender in (str(folder / "front"), "", str(folder / "fixed")):
        channel.subscribe(sender)
    channel.publish(b"1")
    assert fixed.recv(10) == b"1"
    with pytest.raises(BlockingIOError):
        fixed.recv(10)
    assert front.recv(10) == b"1"
    front.close()
    channel.publish(b"2")
    os.unlink(folder / "front")
    front = front_end(folder, "front")
    channel.publish(b"3")
    with pytest.raises(BlockingIOError):
        front.recv(10)
    front.close()
    fixed.close()


def test_subscribers_are_bounded_and_slow_ones_are_not_waited_for(operators):
    channel, folder = operators
    fronts = [front_end(folder, f"front{index}") for index in range(17)]
    for index in range(17):
        channel.subscribe(str(folder / f"front{index}"))
    for _ in range(2000):
        channel.publish(bytes(169))
    with pytest.raises(BlockingIOError):
        fronts[0].recv(4096)
    for front in fronts[1:]:
        assert len(front.recv(4096)) == 169
    for front in fronts:
        while True:
            try:
                front.recv(4096)
            except BlockingIOError:
                break
    channel.publish(b"slow ones are still told")
    assert fronts[1].recv(4096) == b"slow ones are still told"
    for front in fronts:
        front.close()


class FakeCan(CanBus):
    def __init__(self):
        self.connected, self.written = True, []

    def fileno(self):
        return 9

    def read(self):
        return [(1.5, CanFrame(0x123, b"x"))]

    def write(self, frame):
        self.written.append(frame)
        return True

    def close(self):
        pass


def test_a_bus_carries_several_actuators():
    bus, tractor, trailer, speed = FakeCan(), FakeSteering("tractor"), FakeSteering("trailer"), FakeSpeed()
    wires = Wires([Wire(transport=bus, tractor=tractor, trailer=trailer, speed=speed)])
    wires.receive()
    assert tractor.received == trailer.received == [(1.5, CanFrame(0x123, b"x"), "")]
    left, right = (SteeringRequest(steer=True, angle=angle, speed=1.0) for angle in (0.2, -0.1))
    assert wires.send(1.0, (left, right), STOP)
    assert bus.written == [b"tractor on", b"trailer on", b"speed"]
    assert (tractor.requests, trailer.requests, speed.requests) == ([(1.0, left)], [(1.0, right)], [(1.0, STOP)])


def test_a_bus_without_a_speed_actuator_does_not_drive():
    bus = FakeCan()
    wires = Wires([Wire(transport=bus, tractor=FakeSteering("tractor"), trailer=FakeSteering("trailer"))])
    assert wires.send(1.0, (OFF, OFF), STOP)
    assert bus.written == [b"tractor off", b"trailer off"]
    assert wires.descriptors() == [9]
    assert not wires.drives
    assert wires.speed(1.0) is None
    assert wires.dropped == 2


def test_an_actuator_that_raises_is_silent_and_does_not_keep_the_others_from_it(capfd):
    class Broken(FakeSteering):
        def report(self, time):
            raise RuntimeError("report")

        def send(self, time, request):
            raise RuntimeError("send")

        def receive(self, time, frame, source=""):
            raise RuntimeError(f"receive {time}")

    transport, broken, good = FakeTransport(), Broken("tractor"), FakeSteering("trailer")
    wires = Wires([Wire(transport=transport, tractor=broken, trailer=good, speed=Broken("speed"))])
    assert wires.drives
    assert wires.steering(1.0)[0] == SteeringReport()
    assert wires.failed
    assert wires.speed(1.0) == SpeedReport()
    assert wires.send(1.0, (OFF, OFF), STOP)
    assert transport.written == [b"trailer off"]
    capfd.readouterr()
    wires.send(1.0, (OFF, OFF), STOP)
    assert capfd.readouterr().err == "", "each error is said once"
    for number in range(40):
        broken.receive = Broken("tractor").receive
        transport.waiting = [type("R", (), {"time": number, "data": b"", "source": ""})()]
        wires.receive()
    assert capfd.readouterr().err.count("Traceback") == 14, "and no more than sixteen kinds"


def test_a_frame_that_is_not_taken_is_said():
    transport = FakeTransport()
    wires = Wires([Wire(transport=transport, tractor=FakeSteering("tractor"), trailer=FakeSteering("trailer"))])
    transport.works = False
    assert not wires.send(1.0, (OFF, OFF), STOP)
    transport.write = None
    assert not wires.send(1.0, (OFF, OFF), STOP)
    assert wires.steering(1.0)[1].angle == 0.0
    wires.close()
    assert transport.closed
