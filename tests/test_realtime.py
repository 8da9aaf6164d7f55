"""Real-time habits: what is forbidden is said and does not end anything; the service manager hears of the loop."""

import gc
import os
import socket
import subprocess
import sys
import time

import pytest

from drawbar.realtime import Notifier, prefer, prepare, suspended_time

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real time is supported on Linux")


def in_a_child(code, **environment):
    """Run code in a process of its own: what it does to itself must not stay in the tests' process."""
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env={**os.environ, **environment}, timeout=300
    )
    assert run.returncode == 0, run.stderr
    return run.stdout.split("\n")


def test_a_prepared_process_does_not_collect_and_says_what_it_could_not_have():
    code = (
        "import gc, os, resource\n"
        "from drawbar.realtime import prepare\n"
        "words = prepare(50)\n"
        "print(gc.isenabled(), gc.get_freeze_count() > 0)\n"
        "print(os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK == os.SCHED_FIFO)\n"
        "print(os.sched_getscheduler(0) & os.SCHED_RESET_ON_FORK != 0)\n"
        "print('VmLck:\\t       0' not in open('/proc/self/status').read())\n"
        "print(*words, sep='\\n')\n"
    )
    collects, first, reset, locked, *words = in_a_child(code)
    assert collects == "False True"
    said = "\n".join(words)
    assert (first == "True") == ("not scheduled in real time" not in said)
    assert first == reset, "children must not inherit the scheduling"
    assert (locked == "True") == ("memory is not locked" not in said)
    for word in filter(None, words):
        assert "LimitMEMLOCK" in word or "LimitRTPRIO" in word, "each says what to do"


def test_a_process_is_preferred_or_says_what_forbids_it(monkeypatch):
    code = "import os\nfrom drawbar.realtime import prefer\nprint(prefer(-5))\nprint(os.getpriority(0, 0))\n"
    word, niceness, *_ = in_a_child(code)
    assert (niceness == "-5") == (word == "")

    def forbidden(*args):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "setpriority", forbidden)
    assert prefer(-5).endswith("allow it (LimitNICE=-5 in systemd, CAP_SYS_NICE)")
    monkeypatch.delattr(os, "setpriority")
    assert prefer(-5) == ""


@pytest.mark.parametrize(("seconds", "first", "said"), [(0.05, True, False), (1.0, False, True)])
def test_a_process_that_is_flooded_steps_back_and_one_that_is_not_does_not(seconds, first, said):
    code = (
        "import os, sys, time\nfrom drawbar.realtime import schedule_first, step_back_when_busy\n"
        "words = schedule_first(10)\nstep_back_when_busy(0.2, 'too much comes')\n"
        "sys.stderr = sys.stdout\n"
        "for _ in range(8):\n"
        f"    end = time.process_time() + {seconds} / 8\n"
        "    while time.process_time() < end:\n        pass\n"
        f"    time.sleep(0.001 if {first} else 0)\n"
        "print(words, os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK == os.SCHED_FIFO, sep='\\n')\n"
    )
    lines = in_a_child(code)
    allowed = "" in lines[:1] or lines[1] == ""
    if "not scheduled" in "".join(lines):
        pytest.skip("real-time scheduling is not allowed here")
    assert ("too much comes; no longer scheduled in real time" in lines) is said
    assert (lines[-2] == "True") is first
    assert allowed


def test_without_a_priority_the_scheduling_stays():
    code = (
        "import os\nfrom drawbar.realtime import prepare\n"
        "print(any('scheduled' in word for word in prepare(0)))\nprint(os.sched_getscheduler(0) == os.SCHED_OTHER)\n"
    )
    assert in_a_child(code)[:2] == ["False", "True"]


def test_what_the_system_forbids_is_reported_with_what_to_do(monkeypatch):
    def forbidden(*args):
        raise PermissionError(1, "Operation not permitted")

    class Library:
        def mlockall(self, flags):
            assert flags == 3
            return -1

    monkeypatch.setattr(os, "sched_setscheduler", forbidden)
    monkeypatch.setattr("ctypes.CDLL", lambda *args, **names: Library())
    try:
        words = prepare(50)
    finally:
        gc.unfreeze()
        gc.enable()
    assert [word.split(" (")[0] for word in words] == [
        "memory is not locked",
        "not scheduled in real time at priority 50",
    ]


def test_other_systems_run_on_without(monkeypatch):
    monkeypatch.setattr(sys, "platform", "darwin")
    monkeypatch.delattr(os, "SCHED_FIFO")
    try:
        words = prepare(50)
    finally:
        gc.unfreeze()
        gc.enable()
    assert ["darwin" in word for word in words] == [True, True]


def test_suspension_is_no_time_of_this_run():
    before = suspended_time()
    assert before >= -1e-3
    assert suspended_time() - before == pytest.approx(0.0, abs=0.01)


def test_a_process_that_is_stopped_while_it_reads_the_clocks_sees_no_suspension(monkeypatch):
    now, pauses = [100.0], iter([0.0, 0.7, 0.0, 0.0, 0.9])

    def read(clock):
        now[0] += next(pauses, 0.0)
        return now[0] + (30.0 if clock == time.CLOCK_BOOTTIME else 0.0)

    monkeypatch.setattr(time, "clock_gettime", read)
    assert suspended_time() == pytest.approx(30.0)


def test_systems_without_a_boot_clock_know_of_no_suspension(monkeypatch):
    monkeypatch.delattr("time.CLOCK_BOOTTIME")
    assert suspended_time() == 0.0


@pytest.fixture(params=["file", "abstract"])
def manager(request, tmp_path, monkeypatch):
    """Return a socket as a service manager has it."""
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    name = str(tmp_path / "notify") if request.param == "file" else f"@drawbar-{os.getpid()}-{tmp_path.name}"
    listener.bind(name if request.param == "file" else "\0" + name[1:])
    listener.setblocking(False)
    monkeypatch.setenv("NOTIFY_SOCKET", name)
    with listener:
        yield listener


def heard(listener):
    found = []
    while True:
        try:
            found.append(listener.recv(4096))
        except BlockingIOError:
            return found


def test_the_manager_hears_what_is_reported(manager):
    notifier = Notifier()
    notifier.tell("READY=1", "STATUS=STANDBY")
    assert heard(manager) == [b"READY=1\nSTATUS=STANDBY"]
    notifier.feed(1.0)
    assert heard(manager) == [], "no watchdog was asked for"
    notifier.close()


def test_the_watchdog_is_fed_at_twice_its_rate(manager, monkeypatch):
    monkeypatch.setenv("WATCHDOG_USEC", "1000000")
    notifier = Notifier()
    fed = []
    for tick in range(40):
        notifier.feed(10.0 + 0.05 * tick)
        fed += [tick] * len(heard(manager))
    assert fed == [0, 10, 20, 30]
    notifier.close()


def test_without_a_manager_nothing_happens(monkeypatch, tmp_path):
    monkeypatch.delenv("NOTIFY_SOCKET", raising=False)
    silent = Notifier()
    silent.tell("READY=1")
    silent.close()
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "gone"))
    deaf = Notifier()
    deaf.tell("READY=1")
    deaf.close()
    assert list(tmp_path.iterdir()) == []
