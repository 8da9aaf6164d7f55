"""A drive in processes, in real time, over real sockets on loopback."""

import json
import os
import resource
import signal
import socket
import sys
import time

import pytest
from mcap.records import Channel, Message
from mcap.stream_reader import StreamReader
from patience import ENGAGE, PATIENT, watch

from drawbar.config import load_configuration
from drawbar.driving.crew import CONFIGURATION_NAME, Crew
from drawbar.driving.demonstration import with_stand_ins
from drawbar.driving.front_end import FrontEnd
from drawbar.driving.replay import replay_drive
from drawbar.messages import SupervisorState
from drawbar.recording.drive_records import RawBytes, open_drive
from drawbar.recording.log import read_log
from drawbar.report.folder import write_report
from drawbar.safety.causes import Cause

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")


@pytest.fixture
def manager(tmp_path, monkeypatch):
    """Return the socket on which a service manager hears its service."""
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    listener.bind(str(tmp_path / "notify"))
    listener.setblocking(False)
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
    monkeypatch.setenv("WATCHDOG_USEC", "2000000")
    yield listener
    listener.close()


@pytest.fixture
def crew(tmp_path, manager):
    configuration = with_stand_ins(load_configuration("articulated", ["path.radii=[8.0]", *PATIENT]))
    (tmp_path / CONFIGURATION_NAME).write_text(configuration.to_toml(), "utf-8")
    with Crew(configuration, tmp_path, stand_ins=True) as crew:
        yield crew


def steers(front):
    return front.state is not None and front.state.state is SupervisorState.ACTIVE


def notes(manager):
    """Return what the service manager has been told since it was last asked."""
    told = []
    while True:
        try:
            told += manager.recv(4096).decode().splitlines()
        except BlockingIOError:
            return told


def test_it_steers_over_sockets_and_leaves_a_log_that_everybody_reads(crew, manager, tmp_path):
    front = FrontEnd(crew, demonstrates=True)
    watch(front, lambda front: "READY=1" in notes(manager), ENGAGE)
    watch(front, steers, ENGAGE)
    watch(front, lambda front: time.monotonic_ns() - front.state.since > 5e9, 30.0)
    assert front.state.state is SupervisorState.ACTIVE
    assert "WATCHDOG=1" in notes(manager)
    assert abs(front.controller.tractor_lateral_error) < 0.3
    front.close()
    crew.close()
    assert crew.ended() == list(crew.processes)
    log = read_log(tmp_path / "log.mcap")
    assert len(log.records) > 30
    metrics = write_report(tmp_path)
    assert metrics.error_m.trailer["all"].max < 0.3
    topics, seen = {}, set()
    with (tmp_path / "log.mcap").open("rb") as stream:
        for record in StreamReader(stream).records:
            if isinstance(record, Channel):
                topics[record.id] = record.topic
            elif isinstance(record, Message):
                seen.add(topics[record.channel_id])
                if topics[record.channel_id] == "/gate":
                    json.loads(record.data)
    with open_drive(tmp_path / "log.mcap") as records:
        devices = {record.device for record in records if isinstance(record, RawBytes)}
    assert devices == {"tractor_receiver", "trailer_receiver", "sensors"}
    again = replay_drive(tmp_path / "log.mcap")
    assert len(again.records) == len(log.records)
    assert again.differences == ()
    (first, *_) = replay_drive(tmp_path / "log.mcap", ["devices.tractor_receiver.latency=0.05"]).differences
    assert (first.step, first.signal, first.size) == (0, "fixes.epoch", pytest.approx(1e7, abs=1.0))
    assert seen >= {
        "/step",
        "/raw",
        "/order",
        "/fixes",
        "/command",
        "/controller",
        "/gate",
        "/tf",
        "/path",
        "/tractor/fix",
    }


def test_a_controller_that_is_killed_ends_in_letting_go_and_nothing_steers_again(crew):
    front = FrontEnd(crew, demonstrates=True)
    watch(front, steers, ENGAGE)
    os.kill(crew.processes["controller"].pid, signal.SIGKILL)
    state = watch(front, lambda front: not front.state.steers, 5.0)
    assert state.state is SupervisorState.FAULT
    assert state.cause == Cause.CONTROLLER_GONE.value
    crew.processes["gate"].wait(10.0)
    assert not front.state.steers
    front.close()


def test_receivers_that_are_killed_end_in_a_stop_and_nothing_steers_again(crew, tmp_path):
    front = FrontEnd(crew, demonstrates=True)
    watch(front, steers, ENGAGE)
    os.kill(crew.processes["receivers"].pid, signal.SIGKILL)
    watch(front, lambda front: front.state.stop, ENGAGE)
    watch(front, lambda front: not front.state.steers, ENGAGE)
    end = time.monotonic() + 3.0
    watch(front, lambda front: time.monotonic() > end or front.state.steers, ENGAGE)
    assert not front.state.steers
    front.close()
    crew.close()
    assert read_log(tmp_path / "log.mcap").records


def test_a_disk_that_fills_while_driving_costs_the_record_only_and_that_is_told(crew, tmp_path):
    front, log = FrontEnd(crew, demonstrates=True), tmp_path / "log.mcap"
    watch(front, steers, ENGAGE)
    written = log.stat().st_size
    resource.prlimit(crew.processes["recorder"].pid, resource.RLIMIT_FSIZE, (written, written))
    watch(front, lambda front: Cause.NOT_RECORDING.value in front.state.refusals, ENGAGE)
    end = time.monotonic() + 2.0
    watch(front, lambda front: time.monotonic() > end, ENGAGE)
    assert front.state.state is SupervisorState.ACTIVE
    front.close()
    crew.close()
    assert "the log cannot be written any further" in (tmp_path / "messages.txt").read_text()
    assert log.stat().st_size <= written
    assert read_log(log).records
    write_report(tmp_path)
    assert (tmp_path / "report.html").is_file()


def test_a_runs_folder_that_is_removed_while_driving_costs_the_record_only_and_that_is_told(crew, tmp_path):
    front = FrontEnd(crew, demonstrates=True)
    watch(front, steers, ENGAGE)
    (tmp_path / "log.mcap").unlink()
    watch(front, lambda front: Cause.NOT_RECORDING.value in front.state.refusals, ENGAGE)
    assert front.state.state is SupervisorState.ACTIVE
    front.close()
    crew.close()
    assert "the log was removed while it was written" in (tmp_path / "messages.txt").read_text()


def test_a_guard_that_is_frozen_is_told_and_steering_goes_on(crew):
    front = FrontEnd(crew, demonstrates=True)
    watch(front, steers, ENGAGE)
    assert Cause.NOT_GUARDED.value not in front.state.refusals
    os.kill(crew.processes["guard"].pid, signal.SIGSTOP)
    watch(front, lambda front: Cause.NOT_GUARDED.value in front.state.refusals, ENGAGE)
    assert front.state.state is SupervisorState.ACTIVE
    os.kill(crew.processes["guard"].pid, signal.SIGCONT)
    watch(front, lambda front: Cause.NOT_GUARDED.value not in front.state.refusals, ENGAGE)
    front.close()


def test_a_gate_that_is_killed_is_told_and_takes_the_controller_with_it(crew):
    front = FrontEnd(crew, demonstrates=True)
    watch(front, steers, ENGAGE)
    os.kill(crew.processes["gate"].pid, signal.SIGKILL)
    crew.processes["controller"].wait(10.0)
    assert {"gate", "controller"} <= set(crew.ended())
    front.close()


def test_the_gates_process_loads_no_numpy():
    import subprocess

    words = "import sys, drawbar.driving.gate_main; sys.exit('numpy' in sys.modules or 'casadi' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", words]).returncode == 0
