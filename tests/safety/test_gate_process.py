"""The gate as a process: whatever becomes of the controller's process, "off" is on the wire in time and stays.

The time that counts is from the instant of the kill to the first "off" datagram, as the kernel stamps it: when this
process reads it does not matter. It may take what a command is valid for, 200 ms, and what this computer's scheduler
adds while other tests run: SLACK, which is stated here and is no part of the design.
"""

import contextlib
import os
import random
import select
import signal
import socket
import struct
import subprocess
import sys
import threading
import time

import pytest
from gate_machine import WAIT, Machine, NotDrivingError
from waiting import until

from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.process_options import BOARDS, GATE, GateOptions
from drawbar.driving.messaging.socket_passing import pass_socket
from drawbar.driving.processes.guard_main import OFF
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.messages import Action, Heartbeat, OperatorMessage, SupervisorState
from drawbar.messages.records import decode, encode
from drawbar.safety.gate_process import ENDED, FAILED, GONE
from drawbar.safety.settings import SafetySettings

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="a real machine is driven on Linux")
SLACK = 0.3
KILLS = int(os.environ.get("DRAWBAR_KILLS", "4"))
"""instants at which the controller is killed, and stopped; 200 for the whole proof"""
HEARD_OF = (SupervisorState.ACTIVE, SupervisorState.FAULT)


@pytest.fixture
def machine(tmp_path_factory):
    """Return a function that starts a machine and drives it."""
    started = []

    def start(**order):
        for _ in range(10):  # on a busy computer a controller may be late by itself, which is a fault
            started.append(Machine(tmp_path_factory.mktemp("gate"), **order))
            with contextlib.suppress(NotDrivingError):
                started[-1].come_to(SupervisorState.ACTIVE)
                return started[-1]
            started[-1].close()
        raise NotDrivingError

    yield start
    for each in started:
        each.close()


@pytest.fixture
def guarded(machine):
    """Return a function that starts a machine with a guard, and drives it."""
    guards = []

    def start():
        driving = machine()
        board = SteerBoardSettings(address=f"127.0.0.1:{driving.wire.port}", max_angle=0.5)
        options = GateOptions(
            folder=str(driving.folder), safety=SafetySettings(), controller=0, wheelbase=1.4, tractor_limit=0.5,
            trailer_limit=0.3, tractor_board=board, trailer_board=None, isobus=None,
        )  # fmt: skip
        heard, knows = Endpoint(str(driving.folder / GATE)), []  # where it says what it knows of the gate
        command = [sys.executable, "-m", "drawbar.driving.processes.guard_main"]
        guards.append(subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.DEVNULL))
        guards[-1].stdin.write(options.model_dump_json().encode())
        guards[-1].stdin.close()
        until((driving.folder / BOARDS).exists)

        def hears():
            knows.extend(decode(each, Heartbeat) for each in heard.receive())
            return knows and knows[-1].state in HEARD_OF

        until(hears)
        assert not knows[-1].healthy, "it has no socket yet"
        pass_socket(str(driving.folder / BOARDS), "tractor", driving.gate_wire.fileno())
        until(lambda: hears() and knows[-1].healthy)
        heard.close()
        return driving, guards[-1]

    yield start
    for each in guards:
        each.kill()
        each.wait(WAIT)


def still_driving(start, pause):
    """Return what was started and drives after a pause; on a busy computer a controller may be late by itself."""
    for _ in range(10):
        driving, *guard = start()
        time.sleep(pause)
        driving.listen()
        if driving.state.state is SupervisorState.ACTIVE:
            return driving, *guard
        driving.close()
    raise NotDrivingError


def guards_off(machine, start):
    """Return the time from an instant to the guard's first off frame, s."""
    while select.select([machine.wire], [], [], 2.0)[0]:
        for piece in machine.wire.read():
            if piece.data == OFF:
                assert piece.source == f"127.0.0.1:{machine.gate_wire.port}", (
                    "AiO_26 obeys no other port than the gate's"
                )
                return piece.time - start
    raise AssertionError("the guard said nothing")


def released(machine, start):
    """Return the time from an instant to the first frame that says off, s."""
    for at, steers in machine.frames(2.0):
        if not steers:
            return at - start
    raise AssertionError("there was silence instead of off")


def spread(signal_name, times):
    """Return how long it took until off was on the wire."""
    milliseconds = sorted(1e3 * each for each in times)
    late = sum(each > 200.0 for each in milliseconds)
    return (
        f"off {milliseconds[0]:.1f} to {milliseconds[-1]:.1f} ms after {signal_name}, median "
        f"{milliseconds[len(milliseconds) // 2]:.1f} ms, {late} of {len(times)} above 200 ms"
    )


def test_killed_controllers_release_at_once_and_the_gate_ends_after_a_second_of_off(machine):
    chance, times = random.Random(0), []
    for _ in range(KILLS):
        (driving,) = still_driving(lambda: (machine(),), chance.uniform(0.0, 0.3))
        before = time.monotonic()
        driving.controller.kill()
        start = time.monotonic()
        times.append(released(driving, start))
        assert times[-1] <= 0.2 + SLACK
        rest = list(driving.frames(1.5))
        assert not any(steers for _, steers in rest)
        assert rest[-1][0] - before >= 0.9
        assert rest[-1][0] - start <= 1.3 + SLACK
        assert driving.gate.wait(WAIT) == GONE
        driving.close()
    print(spread("SIGKILL", times))  # docs/safety.md


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP], ids=lambda each: each.name)
def test_boards_of_gates_that_are_killed_or_frozen_are_released_by_the_guard(guarded, how):
    chance, times = random.Random(2), []
    for _ in range(max(KILLS // 2, 1)):
        driving, guard = still_driving(guarded, chance.uniform(0.0, 0.3))
        driving.gate.send_signal(how)
        start = time.monotonic()
        guard.terminate()  # as whoever looks after both may do: it stays until the boards have been released
        times.append(guards_off(driving, start))
        assert times[-1] <= 0.2 + SLACK
        assert guard.wait(WAIT) == 0
        if how is signal.SIGSTOP:
            driving.listen()  # to the rest of what the guard has said
            driving.gate.send_signal(signal.SIGCONT)
            assert released(driving, time.monotonic()) <= 0.2 + SLACK, "and the gate itself, once it goes on"
        driving.close()
    print("guard:", spread(how.name, times))  # docs/safety.md


def test_stopped_controllers_release_and_going_on_does_not_engage(machine):
    chance, times = random.Random(1), []
    for _ in range(KILLS):
        (driving,) = still_driving(lambda: (machine(),), chance.uniform(0.0, 0.3))
        driving.controller.send_signal(signal.SIGSTOP)
        start = time.monotonic()
        times.append(released(driving, start))
        assert times[-1] <= 0.2 + SLACK
        driving.controller.send_signal(signal.SIGCONT)
        end = time.monotonic() + 0.7
        while time.monotonic() < end:
            assert not any(steers for _, steers in driving.frames(0.0))
            time.sleep(0.02)
        driving.listen()
        assert driving.state.state is SupervisorState.FAULT
        driving.close()
    print(spread("SIGSTOP", times))  # docs/safety.md


class Flood:
    """Sends garbage to the operators' socket of a gate and to that to its actuator, as fast as they take it."""

    def __init__(self, machine):
        self.sent = {"operators": 0, "wire": 0}
        self._places = (str(machine.folder / "operators"), machine.gate_place())
        self._ended, self._thread = threading.Event(), threading.Thread(target=self._send)
        self._thread.start()

    def _send(self):
        chance, forever = random.Random(2), 2**62
        stops = [
            encode(OperatorMessage(
                time=1, valid_until=forever, action=action, lease=6, nonce=1, seen_sequence=0, seen_time=0
            ))
            for action in (Action.EMERGENCY, Action.RELEASE, Action.STOP)
        ]  # fmt: skip
        with contextlib.ExitStack() as opened:
            kinds = (socket.AF_UNIX, socket.AF_INET)
            ends = [opened.enter_context(socket.socket(kind, socket.SOCK_DGRAM)) for kind in kinds]
            for end in ends:
                end.setblocking(False)
            while not self._ended.is_set():
                broken = bytearray(chance.choice(stops))
                broken[chance.randrange(len(broken))] ^= 1 << chance.randrange(8)
                cut = broken[: chance.randrange(len(broken))]
                garbage = chance.choice((chance.randbytes(chance.randint(0, 300)), bytes(broken), bytes(cut)))
                for name, end, place in zip(self.sent, ends, self._places, strict=True):
                    with contextlib.suppress(BlockingIOError):
                        end.sendto(garbage, place)
                        self.sent[name] += 1

    def close(self):
        self._ended.set()
        self._thread.join()


def test_a_flood_of_garbage_neither_stops_it_nor_steers_and_is_counted(machine):
    driving = machine()
    driving.listen()
    before, flood, frames = driving.state, Flood(driving), 0
    end = time.monotonic() + 2.0
    try:
        while time.monotonic() < end:
            time.sleep(0.01)
            driving.ask(Action.PRESENT)
            for piece in driving.wire.read():
                steers, angle = struct.unpack("<Bd", piece.data)
                assert steers == 1
                assert 0.0 <= angle <= 0.001, "what the controller commands"
                frames += 1
            driving.listen()
            assert (driving.state.state, driving.state.lease) == (SupervisorState.ACTIVE, before.lease)
        assert frames > 10
        driving.ask_until_it_is_taken(Action.RELEASE)
        assert released(driving, time.monotonic()) <= 0.2 + SLACK
    finally:
        flood.close()

    def counted():
        driving.listen()
        return driving.state.dropped - before.dropped >= flood.sent["operators"] + 500  # the wire's may overflow

    until(counted)
    assert driving.state.dropped - before.dropped <= sum(flood.sent.values())
    assert min(flood.sent.values()) > 500
    print(f"flood: {flood.sent}, {driving.state.dropped - before.dropped} dropped")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_gate_that_is_told_to_end_releases_first(machine, number):
    driving = machine()
    driving.listen()
    before = time.monotonic()
    driving.gate.send_signal(number)
    assert released(driving, time.monotonic()) <= 0.2 + SLACK
    assert driving.gate.wait(WAIT) == ENDED
    assert time.monotonic() - before >= 0.9


@pytest.mark.parametrize(("fails_at", "code"), [("tick", FAILED), ("report", None)])
def test_a_program_that_fails_releases(machine, fails_at, code, tmp_path):
    broken = Machine(tmp_path, fails_at=fails_at)
    try:
        with pytest.raises(NotDrivingError):
            broken.come_to(SupervisorState.ACTIVE, 20.0)
        frames = [steers for _, steers in broken.frames(0.1)]
        if code is not None:
            assert broken.gate.wait(WAIT) == code
            assert "the gate's own program fails" in (tmp_path / "gate_runner.py").read_text()
            assert not any(frames)
        else:
            assert not frames[-1]
            assert broken.state.state is SupervisorState.FAULT
            assert "the program of the actuator fails" in (tmp_path / "gate_runner.py").read_text()
    finally:
        broken.close()
