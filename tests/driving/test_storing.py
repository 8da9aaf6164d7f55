"""What a configuration says of a board's memory is written to it on command: a stand-in board on a real socket."""

import socket
import threading
import time
from contextlib import contextmanager

import pytest
from board_server import BoardServer

from drawbar.config import load_configuration
from drawbar.driving import storing
from drawbar.driving.check import Finding
from drawbar.driving.demonstration import free_ports, with_stand_ins
from drawbar.machine.hardware.steer_board import BoardMemory, SteerBoardSettings
from drawbar.machine.stand_in.aio_v4 import AioV4
from drawbar.machine.stand_in.wheel import HeldWheel

MEMORY = BoardMemory(gain=70, counts_per_degree=41, offset=-12, invert_motor=True)


@contextmanager
def running(board):
    """Let a board answer; yield the devices of a machine whose front wheels it turns, and nothing measures speed."""
    server, stop = BoardServer(board), threading.Event()
    thread = threading.Thread(target=server.run, args=(stop,))
    thread.start()
    listen = "127.0.0.1:{}".format(*free_ports(socket.SOCK_DGRAM, 1))
    settings = SteerBoardSettings(address="{}:{}".format(*server.address), listen=listen, max_angle=0.5, memory=MEMORY)
    devices = with_stand_ins(load_configuration("articulated")).devices
    try:
        yield devices.model_copy(update={"tractor_board": settings, "trailer_board": None, "sensors": None})
    finally:
        stop.set()
        thread.join()
        server.close()


@pytest.fixture
def board():
    return AioV4(HeldWheel(), start=time.monotonic())


def test_a_board_stores_all_values(board):
    with running(board) as devices:
        (found,) = storing.store(devices)
    assert not found.problems
    assert found.facts[-1] == "memory written"
    assert (board.settings.gain, board.settings.counts_per_degree, board.settings.offset) == (70, 41, -12)
    assert board.config.invert_motor


def test_a_board_that_may_not_be_steered_is_not_written_to(board, monkeypatch):
    taken = Finding(device="tractor board", heard=True, problems=["another computer commands it"])
    monkeypatch.setattr(storing, "listen_to_board", lambda name, settings, seconds: taken)
    with running(board) as devices:
        (found,) = storing.store(devices)
    assert found.problems[-1] == "nothing was written to it"
    assert board.settings.gain == 40


def test_a_board_that_is_not_heard_is_told(board):
    with running(board) as devices:
        gone = devices.tractor_board.model_copy(update={"address": "127.0.0.1:1"})
        (found,) = storing.store(devices.model_copy(update={"tractor_board": gone}))
    assert not found.heard
    assert found.problems[-1] == "nothing was written to it"


def test_nothing_is_written_while_the_wheels_turn(board, monkeypatch):
    sensors = with_stand_ins(load_configuration("articulated")).devices.sensors
    monkeypatch.setattr(storing, "_moves", lambda settings: settings is sensors)
    with running(board) as devices:
        (found,) = storing.store(devices.model_copy(update={"sensors": sensors}))
    assert found.problems == ["they turn: stand; nothing was written"]
    assert board.settings.gain == 40
