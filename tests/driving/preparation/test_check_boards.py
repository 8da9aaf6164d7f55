"""`drawbar check` finds boards by their answers to a scan: real sockets on loopback."""

import socket
import struct
import threading
import time
from contextlib import contextmanager

import pytest
from board_server import BoardServer

from drawbar.driving.preparation import check
from drawbar.driving.stand_in.demonstration import free_ports
from drawbar.machine.hardware import board_scan
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.receiver import ReceiverSettings
from drawbar.machine.hardware.sensor_line import SensorBoardSettings
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.machine.stand_in.aio_26 import Aio26
from drawbar.machine.stand_in.aio_v4 import AioV4
from drawbar.machine.stand_in.wheel import HeldWheel
from drawbar.protocols.agopengps.frame import STEER_BOARD, pack
from drawbar.protocols.agopengps.network import SCAN
from drawbar.protocols.agopengps.steer_board import SET_POINT
from drawbar.transports.udp import KNOWN_PORTS

NOWHERE = "127.0.0.1:1"


@contextmanager
def running(board, host="127.0.0.1", port=0):
    """Let a board answer; yield its host and port."""
    server, stop = BoardServer(board, host=host, port=port), threading.Event()
    thread = threading.Thread(target=server.run, args=(stop,))
    thread.start()
    try:
        yield server.address
    finally:
        stop.set()
        thread.join()
        server.close()


@pytest.fixture
def listen():
    """Return where replies are taken."""
    return "127.0.0.1:{}".format(*free_ports(socket.SOCK_DGRAM, 1))


def settings(address, listen):
    return SteerBoardSettings(
        address=address if isinstance(address, str) else "{}:{}".format(*address), listen=listen, max_angle=0.5
    )


def found(boards, seconds=1.0):
    return {finding.device: finding for finding in check._boards(boards, seconds)}


@pytest.mark.parametrize("firmware", [AioV4, Aio26])
def test_boards_that_answer_are_reported_with_their_own_address(firmware, listen):
    board = firmware(HeldWheel(), subnet="192.168.7", start=time.monotonic())
    board.computer_port = int(listen.partition(":")[2])
    with running(board) as address:
        findings = found({"tractor board": settings(address, listen)})
    assert "scan: steer board 192.168.7.126" in findings["tractor board"].facts
    assert findings.keys() == {"tractor board"}
    assert not any("answers the scan" in problem for problem in findings["tractor board"].problems)


def test_a_board_is_not_silent_where_a_busy_computer_did_not_ask_it(listen, monkeypatch):
    whole = check.poll_times

    def with_a_pause(seconds):
        yield from whole(seconds)
        time.sleep(0.6)
        yield time.monotonic()

    monkeypatch.setattr(check, "poll_times", with_a_pause)
    with running(AioV4(HeldWheel(), start=time.monotonic())) as address:
        finding = check.listen_to_board("tractor board", settings(address, listen), 2.0)
    assert finding.facts == ["angle 0.0°, ready"]
    assert finding.problems == []


def test_a_board_at_another_address_than_the_configured_one_is_found_by_broadcast(monkeypatch):
    (port,) = free_ports(socket.SOCK_DGRAM, 1)
    monkeypatch.setattr(board_scan, "BOARD_PORT", port)
    listen = "0.0.0.0:{}".format(*free_ports(socket.SOCK_DGRAM, 1))
    with running(AioV4(HeldWheel(), subnet="192.168.7", start=time.monotonic()), host="0.0.0.0", port=port):
        findings = found({"tractor board": settings(NOWHERE, listen)})
    problems = findings["tractor board"].problems
    assert "nothing was received" in problems[0]
    assert problems[1] == (
        "a steer board answers the scan from 192.168.7.126: if it is this one, write that as its address"
    )
    assert findings["other boards that answer the scan"].facts == ["steer board 192.168.7.126"]


def answering(line, reply):
    """Answer one scan with a reply."""
    data, computer = line.recvfrom(100)
    assert data == SCAN
    line.sendto(reply, computer)


def test_a_board_that_hears_this_computer_from_another_network_is_reported(listen):
    reply = pack(STEER_BOARD, 203, bytes((192, 168, 5, 126, 192, 168, 1)))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
        line.bind(("127.0.0.1", 0))
        line.settimeout(10.0)
        thread = threading.Thread(target=answering, args=(line, reply))
        thread.start()
        findings = found({"tractor board": settings(line.getsockname(), listen)})
        thread.join()
    assert any(
        "hears this computer from 192.168.1.*: give this computer's network card an address in 192.168.5.*" in problem
        for problem in findings["tractor board"].problems
    )


@contextmanager
def answering_twice(angles):
    """Answer each set point as boards do that have one address, with these angles, 0.01°; yield host and port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
        line.bind(("127.0.0.1", 0))
        line.settimeout(0.2)
        stop = threading.Event()

        def run():
            while not stop.is_set():
                try:
                    data, computer = line.recvfrom(100)
                except TimeoutError:
                    continue
                for angle in angles if data[:4] == SET_POINT else ():
                    line.sendto(pack(STEER_BOARD, 253, struct.pack("<hhhBB", angle, 9999, 8888, 7, 0)), computer)

        thread = threading.Thread(target=run)
        thread.start()
        yield line.getsockname()
        stop.set()
        thread.join()


@pytest.mark.parametrize(("angles", "found"), [((-150, 100), True), ((0, 1200), True), ((0, 0), False), ((0,), False)])
def test_two_boards_that_answer_from_one_address_are_reported(angles, found, listen):
    with answering_twice(angles) as address:
        finding = check.listen_to_board("tractor board", settings(address, listen), 1.5)
    assert any("two boards answer from its address" in problem for problem in finding.problems) is found
    assert not any("more than a wheel turns" in problem for problem in finding.problems)


def test_a_computer_without_boards_scans_nothing(monkeypatch):
    monkeypatch.setattr(check, "BoardScan", lambda *_: pytest.fail("it scanned"))
    assert found({}) == {}


def test_a_port_that_agio_has_is_a_finding_and_the_other_devices_are_listened_to(monkeypatch, listen, tmp_path):
    host, port = listen.split(":")
    monkeypatch.setitem(KNOWN_PORTS, int(port), "AgIO")
    devices = DeviceSettings(
        tractor_receiver=ReceiverSettings(transport=f"udp://{listen}", sender="127.0.0.2"),
        trailer_receiver=ReceiverSettings(transport=f"file:{tmp_path}/missing"),
        tractor_board=settings(NOWHERE, listen),
        trailer_board=settings("127.0.0.2:1", listen),
        sensors=SensorBoardSettings(transport=f"serial:{tmp_path}/missing@115200", pulses_per_metre=1.0),
    )
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as agio:
        agio.bind((host, int(port)))
        told = {
            each.device: each.problems for each in check.check(devices, devices.origin.frame(), 0.1, 0.2, oldest=5.0)
        }
    taken = [f"port {port} is taken: another program (AgIO?) listens there; stop it or give another port"]
    assert told.keys() == {"tractor receiver", "trailer receiver", "tractor board", "trailer board", "sensor board"}
    assert told["tractor receiver"] == told["tractor board"] == told["trailer board"] == taken
    assert "No such file" in told["trailer receiver"][0]
    assert "cannot be opened" in told["sensor board"][0]
