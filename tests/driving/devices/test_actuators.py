"""The boards' wires: another computer that broadcasts set points to the boards is heard."""

import socket
import time

import pytest

from drawbar.driving.devices.actuators import board_wires
from drawbar.driving.preparation.check import listen_to_board
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.protocols.actuator import Readiness
from drawbar.protocols.agopengps.frame import COMPUTER, Pgn, pack
from drawbar.safety.wires import Wires


@pytest.fixture
def port():
    """Return a free port of boards in the network 127.0.5."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.5.255", 0))
        return free.getsockname()[1]


def settings_at(port):
    return SteerBoardSettings(address=f"127.0.5.126:{port}", listen="127.0.0.1:0", max_angle=0.5)


def commands_from_elsewhere(port):
    """Send the set point of another computer to the network, which on loopback is an address."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.9", 0))
        other.sendto(pack(COMPUTER, Pgn.STEER, bytes(8)), ("127.0.5.255", port))


@pytest.mark.parametrize("listens", [False, True])
def test_another_computer_that_broadcasts_set_points_is_another_master(port, listens):
    wires = Wires(board_wires({"tractor": settings_at(port)}, listens=listens))
    commands_from_elsewhere(port)
    wires.receive()
    report, _ = wires.steering(time.monotonic())
    wires.close()
    # a shadow looks on while another program steers
    assert (report.readiness is Readiness.OTHER_MASTER) is not listens


def test_a_taken_port_keeps_no_board_from_being_opened(port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.5.255", port))
        (wire,) = board_wires({"tractor": settings_at(port)})
        assert wire.transport.connected
        wire.transport.close()
        assert not wire.transport.connected


def test_a_board_that_is_reached_by_broadcast_shares_the_socket_of_one_that_is_not():
    trailer = SteerBoardSettings(address="127.255.255.255:9", listen="127.0.0.1:0", max_angle=0.5)
    wires = board_wires({"tractor": settings_at(9), "trailer": trailer})
    assert [wire.transport.write(bytes(8)) for wire in wires] == [True, True], wires[1].transport.trouble
    wires[0].transport.close()
    wires[1].transport.close()


def test_the_check_tells_another_master(monkeypatch, port):
    def looks(*_):
        commands_from_elsewhere(port)
        yield time.monotonic()

    monkeypatch.setattr("drawbar.driving.preparation.check.poll_times", looks)
    finding = listen_to_board("tractor board", settings_at(port), 1.0)
    assert Readiness.OTHER_MASTER.value in finding.problems
