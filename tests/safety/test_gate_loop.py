"""The gate's loop by a clock of ours: its pace, its end, what it tells the service manager, and a failing program."""

import itertools
import signal
import socket
from types import SimpleNamespace

import pytest
from gate_bench import Bench

from drawbar.messages import SupervisorState
from drawbar.protocols.actuator import SteeringRequest
from drawbar.protocols.speed_actuator import SpeedRequest
from drawbar.safety import gate_process
from drawbar.safety.gate_process import next_tick, run


class Clock:
    """Time that passes by waiting, and a little by looking."""

    def __init__(self, bench, jumps=()):
        self.bench, self.time, self.waits, self.jumps = bench, 100.0, [], dict(jumps)

    def __call__(self):
        self.time += 1e-6
        return self.time

    def wait(self, descriptors, duration):
        self.waits.append((tuple(descriptors), duration))
        self.time += max(duration, 0.0) + self.jumps.pop(len(self.waits), 0.0)
        self.bench.time = self.time
        self.bench.receive()


@pytest.fixture
def loop(monkeypatch):
    """Return a function that runs a gate on a bench by a clock of ours."""

    def start(bench, jumps=()):
        clock = Clock(bench, jumps)
        monkeypatch.setattr(gate_process, "prepare", lambda priority: ["memory is not locked"])
        return run(bench.gate, bench.settings, clock), clock

    return start


def end_at(bench, seconds, how):
    """Let something happen after so many seconds of the loop."""
    receive = bench.receive

    def heard():
        if bench.time >= 100.0 + seconds:
            how()
        return receive()

    bench.receive = heard


@pytest.mark.parametrize(("how", "code"), [("signal", 0), ("gone", 3)])
def test_it_says_off_for_a_second_and_ends(loop, how, code, capfd):
    bench = Bench()
    ends = {
        "signal": lambda: signal.raise_signal(signal.SIGTERM),
        "gone": lambda: setattr(bench.channel, "gone", True),
    }
    end_at(bench, 2.0, ends[how])
    result, clock = loop(bench)
    assert result == code
    assert 3.0 <= clock.time - 100.0 <= 3.2
    assert bench.transport.closed
    assert bench.state is SupervisorState.FAULT
    assert "gate: memory is not locked" in capfd.readouterr().err


def test_its_pace_counts_from_the_last_tick_and_missed_ticks_are_left_out(loop):
    bench = Bench()
    end_at(bench, 2.0, lambda: setattr(bench.gate.watch.troubles, "ended", True))
    _, _ = loop(bench, {40: 0.33})
    ticks = [time for time, _ in bench.tractor.requests]
    assert 0.3 < max(after - before for before, after in itertools.pairwise(ticks)) < 0.4
    assert min(after - before for before, after in itertools.pairwise(ticks)) > 0.01, "no burst"


def test_a_tick_is_late_by_what_is_beyond_the_period_after_the_last_one_though_it_may_come_sooner(loop):
    bench = Bench()
    end_at(bench, 2.0, lambda: setattr(bench.gate.watch.troubles, "ended", True))
    ticks, tick = [], bench.gate.tick
    bench.gate.tick = lambda time, late: (ticks.append((time, late)), tick(time, late))
    bench.gate.receive = lambda clock: len(ticks) == 20  # something new, as after the 20th tick
    loop(bench, {97: 0.1})
    assert ticks[0][1] <= 1e-5
    assert ticks[20][0] - ticks[19][0] < 0.011
    assert [late for _, late in ticks[1:]] == pytest.approx(
        [max(time - before - 0.05, 0.0) for (before, _), (time, _) in itertools.pairwise(ticks)]
    )
    assert 0.059 < max(late for _, late in ticks) < 0.061


@pytest.mark.parametrize(("since", "following"), [(0.02, 0.025), (0.01, 0.0125)])
def test_the_tick_after_a_command_comes_between_it_and_the_next_one_and_soon_after_one_just_before(
    loop, since, following
):
    bench, ticks = Bench(), []
    receive, tick = bench.gate.receive, bench.gate.tick
    bench.gate.receive = lambda clock: receive(clock) | (len(ticks) == 10 and clock() - ticks[-1] >= since)
    bench.gate.tick = lambda now, late: ticks.append(now) or tick(now, late)
    end_at(bench, 0.8, lambda: setattr(bench.gate.watch.troubles, "ended", True))
    loop(bench)
    gaps = [after - before for before, after in itertools.pairwise(ticks)]
    assert gaps[9] == pytest.approx(since, abs=1e-3)
    assert gaps[10] == pytest.approx(following, abs=1e-3)
    assert gaps[11:13] == pytest.approx([0.05, 0.05], abs=1e-3)


def test_a_first_tick_is_late_by_what_the_first_look_took(loop):
    bench, lateness = Bench(), []
    receive, tick = bench.gate.receive, bench.gate.tick

    def looks(clock):
        if not lateness:
            clock.time += 0.2
        return receive(clock)

    bench.gate.receive = looks
    bench.gate.tick = lambda now, late: lateness.append(late) or tick(now, late)
    end_at(bench, 0.5, lambda: setattr(bench.gate.watch.troubles, "ended", True))
    loop(bench)
    assert lateness[0] == pytest.approx(0.2, abs=1e-4)
    assert lateness[1] <= 1e-4


@pytest.mark.parametrize(
    ("since", "urgent", "following"), [(0.0, False, 1.0), (0.2, True, 0.25), (0.25, True, 0.5), (0.9, True, 0.5)]
)
def test_the_next_tick_is_due_after_a_period_or_half_of_it_or_a_quarter(since, urgent, following):
    assert next_tick(10.0, 1.0, since, urgent=urgent) == 10.0 + following


def test_a_program_that_fails_says_off_before_it_ends(loop, capfd):
    bench = Bench(speed_actuator=True)

    def fail(*given):
        raise RuntimeError("the gate's own program fails")

    end_at(bench, 1.0, lambda: setattr(bench.gate, "tick", fail))
    result, clock = loop(bench)
    assert result == 4
    off = [(time, request) for time, request in bench.tractor.requests if time >= 101.0]
    assert {request for _, request in off} == {SteeringRequest(steer=False, angle=0.0, speed=0.0)}
    fast = bench.settings.drive.emergency_deceleration
    stops = {request for time, request in bench.speed_actuator.requests if time >= 101.0}
    assert stops == {SpeedRequest(drive=False, speed=0.0, deceleration=fast)}
    assert len(off) == 20
    assert off[-1][0] - off[0][0] == pytest.approx(0.95, abs=0.01)
    assert "the gate's own program fails" in capfd.readouterr().err
    assert bench.transport.closed
    assert clock.time - 100.0 >= 2.0


def test_it_wakes_when_the_command_expires():
    bench = Bench().drive()
    waits = []
    clock = SimpleNamespace(wait=lambda descriptors, duration: waits.append(duration))
    bench.transport.fileno = bench.channel.fileno = bench.operators.fileno = lambda: 5
    gate_process._wait(bench.gate, clock, bench.time, bench.time + 9.0)
    assert waits[-1] == pytest.approx(0.2, abs=1e-4)
    assert not bench.gate.watch.command_valid(bench.time + waits[-1]), "once, and not a moment too soon"
    gate_process._wait(bench.gate, clock, bench.time + 5.0, bench.time + 9.0)
    assert waits[-1] <= 0.0
    resting = Bench().run()
    resting.transport.fileno = resting.channel.fileno = resting.operators.fileno = lambda: 5
    gate_process._wait(resting.gate, clock, resting.time, resting.time + 9.0)
    assert waits[-1] == pytest.approx(9.0)
    resting.transport.fileno = lambda: -1
    gate_process._wait(resting.gate, clock, resting.time, resting.time + 9.0)
    assert waits[-1] == pytest.approx(0.01)


def test_it_wakes_for_the_controller_until_that_is_gone():
    bench, waits = Bench().run(), []
    clock = SimpleNamespace(wait=lambda descriptors, duration: waits.append((set(descriptors), duration)))
    bench.transport.fileno, bench.channel.fileno, bench.operators.fileno = lambda: 5, lambda: 6, lambda: 0
    gate_process._wait(bench.gate, clock, bench.time, bench.time + 9.0)
    bench.channel.gone = True
    gate_process._wait(bench.gate, clock, bench.time, bench.time + 9.0)
    assert waits == [({0, 5, 6}, pytest.approx(9.0)), ({0, 5}, pytest.approx(9.0))]


def test_the_service_manager_hears_of_the_loop_itself(loop, tmp_path, monkeypatch):
    manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    manager.bind(str(tmp_path / "notify"))
    manager.setblocking(False)
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
    monkeypatch.setenv("WATCHDOG_USEC", "1000000")
    bench, heard = Bench(), []

    def listen():
        while True:
            try:
                heard.append(manager.recv(4096).decode())
            except BlockingIOError:
                return

    end_at(bench, 0.0, listen)
    end_at(bench, 3.0, lambda: setattr(bench.gate.watch.troubles, "ended", True))
    loop(bench)
    listen()
    manager.close()
    assert heard.index("STATUS=SELFTEST") < heard.index("READY=1") < heard.index("STATUS=STANDBY")
    assert heard.count("READY=1") == 1
    assert heard[-1] == "STOPPING=1"
    assert 6 <= heard.count("WATCHDOG=1") <= 9
