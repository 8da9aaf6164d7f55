"""Stand-in boards on real sockets of this computer."""

import math
import socket
import threading
from collections.abc import Iterator

import pytest
from board_server import BoardServer

from drawbar.errors import HardwareError
from drawbar.machine.stand_in.aio_26 import Aio26
from drawbar.machine.stand_in.aio_v4 import AioV4
from drawbar.machine.stand_in.wheel import HeldWheel, MotorWheel
from drawbar.protocols.actuator import SteeringRequest
from drawbar.protocols.agopengps.network import HELLO
from drawbar.protocols.agopengps.steer_board import SteerBoard


class Clock:
    def __init__(self) -> None:
        self.time = 50.0

    def __call__(self) -> float:
        return self.time


@pytest.fixture
def computer() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as computer:
        computer.bind(("127.0.0.1", 0))
        computer.setblocking(False)
        yield computer


def read(computer: socket.socket) -> list[tuple[bytes, str]]:
    received = []
    while True:
        try:
            data, (host, port) = computer.recvfrom(2048)
        except BlockingIOError:
            return received
        received.append((data, f"{host}:{port}"))


def test_two_boards_share_one_socket_of_the_computer(computer: socket.socket) -> None:
    clock = Clock()
    v26 = Aio26(MotorWheel(), start=clock.time)
    v26.computer_port = computer.getsockname()[1]
    boards = {"127.0.5.126": AioV4(MotorWheel(), start=clock.time), "127.0.6.126": v26}
    servers = [BoardServer(board, host=host, port=0, clock=clock) for host, board in boards.items()]
    addresses = ["{}:{}".format(*server.address) for server in servers]
    actuators = [SteerBoard(board=address, max_angle=0.5) for address in addresses]
    angles = (0.1, -0.2)
    for step in range(160):
        for data, source in read(computer):
            for actuator in actuators:
                actuator.receive(clock.time, data, source)
        for server, actuator, angle in zip(servers, actuators, angles, strict=True):
            request = SteeringRequest(steer=step > 50, angle=angle, speed=1.0)
            for datagram in actuator.send(clock.time, request):
                computer.sendto(datagram, server.address)
        clock.time += 0.002
        for server in servers:
            server.poll()
        clock.time += 0.048
        for server in servers:
            server.poll()
    for board, actuator, angle in zip(boards.values(), actuators, angles, strict=True):
        assert actuator.report(clock.time).engaged
        assert board.wheel.angle == pytest.approx(angle, abs=math.radians(0.5))
    for server in servers:
        server.close()


def test_a_taken_address_is_refused_with_what_to_do(computer: socket.socket) -> None:
    host, port = computer.getsockname()
    with pytest.raises(HardwareError, match=f"cannot listen on {host}:{port}.*another address"):
        BoardServer(AioV4(HeldWheel()), host=host, port=port)


def test_replies_go_to_the_computer_that_is_given(computer: socket.socket) -> None:
    clock = Clock()
    board = Aio26(HeldWheel(), start=clock.time)
    server = BoardServer(board, port=0, computer=computer.getsockname(), clock=clock)
    clock.time += 0.1
    server.poll()
    assert len(read(computer)) == 10
    server.close()


def test_before_anyone_is_heard_nothing_is_sent() -> None:
    clock = Clock()
    board = Aio26(HeldWheel(), start=clock.time)
    server = BoardServer(board, port=0, clock=clock)
    clock.time += 0.1
    server.poll()
    assert board.next_tick > clock.time, "it has run all the same"
    server.close()


def test_runs_by_itself_in_real_time(computer: socket.socket) -> None:
    import time

    server = BoardServer(AioV4(HeldWheel(), start=time.monotonic()), port=0)
    stop = threading.Event()
    thread = threading.Thread(target=server.run, args=(stop,))
    thread.start()
    try:
        computer.settimeout(10.0)
        computer.sendto(HELLO, server.address)
        assert computer.recvfrom(2048)[0][3] == 126
    finally:
        stop.set()
        thread.join()
        server.close()
