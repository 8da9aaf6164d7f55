"""What a configuration says of a board's memory is written to it on command: a stand-in board on a real socket."""

import socket
import threading
import time
from contextlib import contextmanager
from functools import partial
from types import SimpleNamespace

import pytest
from board_server import BoardServer
from waiting import PatientClock

from drawbar.config import load_configuration
from drawbar.driving.preparation import board_memory, check, finding
from drawbar.driving.preparation.finding import Finding
from drawbar.driving.stand_in.demonstration import free_ports, with_stand_ins
from drawbar.machine.hardware.sensor_line import SensorBoardSettings
from drawbar.machine.hardware.steer_board import BoardMemory, SteerBoardSettings
from drawbar.machine.stand_in.aio_v4 import AioV4
from drawbar.machine.stand_in.wheel import HeldWheel
from drawbar.protocols.own_sentence import own_sentence

PULSES_PER_METRE = 1000.0
HITCH = {"hitch_counts": (0, 1, 2, 3, 4), "hitch_angles": (-0.5, -0.25, 0.0, 0.25, 0.5)}
MEMORY = BoardMemory(gain=70, counts_per_degree=41, offset=-12, invert_motor=True)


CLOCK = PatientClock()


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """Let a busy machine make no board late."""
    monkeypatch.setattr(finding, "time", SimpleNamespace(monotonic=CLOCK))
    monkeypatch.setattr(check, "board_wires", partial(check.board_wires, clock=CLOCK))


@contextmanager
def running(board):
    """Let a board answer; yield the devices of a machine whose front wheels it turns, and nothing measures speed."""
    server, stop = BoardServer(board, port=0, clock=CLOCK), threading.Event()
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
    return AioV4(HeldWheel(), start=CLOCK())


def test_a_board_stores_all_values(board):
    with running(board) as devices:
        (found,) = board_memory.store_board_memories(devices)
    assert not found.problems
    assert found.facts[-1] == "memory written"
    assert (board.settings.gain, board.settings.counts_per_degree, board.settings.offset) == (70, 41, -12)
    assert board.config.invert_motor


def test_a_board_that_may_not_be_steered_is_not_written_to(board, monkeypatch):
    taken = Finding(device="tractor board", received=True, problems=["another computer commands it"])
    monkeypatch.setattr(board_memory, "listen_to_board", lambda name, settings, seconds: taken)
    with running(board) as devices:
        (found,) = board_memory.store_board_memories(devices)
    assert found.problems[-1] == "nothing was written to it"
    assert board.settings.gain == 40


def test_a_board_that_does_not_reply_is_reported(board):
    with running(board) as devices:
        gone = devices.tractor_board.model_copy(update={"address": "127.0.0.1:1"})
        (found,) = board_memory.store_board_memories(devices.model_copy(update={"tractor_board": gone}))
    assert not found.received
    assert found.problems[-1] == "nothing was written to it"


@contextmanager
def sensor_board(speed):
    """Let the wheels' encoder report a speed, m/s; None: its board is silent. Yield its settings."""
    own = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    port, stop = free_ports(socket.SOCK_DGRAM, 1)[0], threading.Event()

    def send():
        begin = time.monotonic()
        while speed is not None and not stop.wait(0.05):
            milliseconds = int((time.monotonic() - begin) / 0.05) * 50  # whole pulses at each time: the speed is exact
            pulses = round(milliseconds * speed * PULSES_PER_METRE / 1e3) % 2**32
            own.sendto(own_sentence("PDBS", milliseconds, None, pulses), ("127.0.0.1", port))

    thread = threading.Thread(target=send)
    thread.start()
    try:
        yield SensorBoardSettings(transport=f"udp://127.0.0.1:{port}", pulses_per_metre=PULSES_PER_METRE)
    finally:
        stop.set()
        thread.join()
        own.close()


@pytest.mark.parametrize(
    ("speed", "problem"),
    [(1.0, "they turn: stand"), (-0.2, "they turn: stand"), (None, "their encoder reports nothing")],
)
def test_nothing_is_written_unless_the_encoder_shows_that_the_wheels_stand(board, speed, problem):
    with running(board) as devices, sensor_board(speed) as sensors:
        (found,) = board_memory.store_board_memories(devices.model_copy(update={"sensors": sensors}))
    assert found.problems[0].startswith(problem)
    assert found.facts == ([] if speed is None else [f"{speed:.2f} m/s"])
    assert found.problems[-1] == "nothing was written to any board"
    assert board.settings.gain == 40


def test_wheels_that_stand_let_a_board_store(board):
    with running(board) as devices, sensor_board(0.0) as sensors:
        (found,) = board_memory.store_board_memories(devices.model_copy(update={"sensors": sensors}))
    assert found.facts[-1] == "memory written"


def test_sensors_without_an_encoder_leave_it_to_the_operator(board):
    with running(board) as devices, sensor_board(None) as sensors:
        hitch_only = SensorBoardSettings(transport=sensors.transport, **HITCH)
        (found,) = board_memory.store_board_memories(devices.model_copy(update={"sensors": hitch_only}))
    assert found.facts[-1] == "memory written"
