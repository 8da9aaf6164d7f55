"""A drive in processes, in real time, over real sockets on loopback."""

import os
import re
import resource
import signal
import socket
import subprocess
import sys
import time
from types import SimpleNamespace

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from patience import ENGAGE, PATIENT, watch

from drawbar.config import load_configuration
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.driving.evaluation.replay import replay_drive
from drawbar.driving.operator.front_end import FrontEnd
from drawbar.driving.processes import drive_processes
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.driving.stand_in.demonstration import with_stand_ins
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
def processes(tmp_path, manager):
    configuration = with_stand_ins(load_configuration("articulated", ["path.radii=[8.0]", *PATIENT]))
    (tmp_path / CONFIGURATION_NAME).write_text(configuration.to_toml(), "utf-8")
    with DriveProcesses(configuration, tmp_path, stand_ins=True) as processes:
        yield processes


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


def test_it_steers_over_sockets_and_leaves_a_log_that_everybody_reads(processes, manager, tmp_path):
    front = FrontEnd(processes, demonstrates=True)
    watch(front, lambda front: "READY=1" in notes(manager), ENGAGE)
    watch(front, steers, ENGAGE)
    watch(front, lambda front: time.monotonic_ns() - front.state.since > 5e9, ENGAGE)
    assert front.state.state is SupervisorState.ACTIVE
    assert "WATCHDOG=1" in notes(manager)
    assert abs(front.controller.tractor_lateral_error) < 0.3
    front.close()
    processes.close()
    assert processes.ended() == list(processes.by_name)
    log = read_log(tmp_path / "log.mcap")
    assert len(log.records) > 30
    metrics = write_report(tmp_path)
    assert metrics.error_m.trailer["all"].max < 0.3
    with (tmp_path / "log.mcap").open("rb") as stream:
        log_reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        seen = {channel.topic for _, channel, _ in log_reader.iter_messages()}
        states = {each.decoded_message.state for each in log_reader.iter_decoded_messages(topics="/gate")}
    assert SupervisorState.ACTIVE in states
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


def test_a_controller_that_is_killed_ends_in_a_release_and_nothing_steers_again(processes):
    front = FrontEnd(processes, demonstrates=True)
    watch(front, steers, ENGAGE)
    os.kill(processes.by_name["controller"].pid, signal.SIGKILL)
    state = watch(front, lambda front: not front.state.steers, ENGAGE)
    assert state.state is SupervisorState.FAULT
    assert state.cause == Cause.CONTROLLER_GONE.value
    processes.by_name["gate"].wait(ENGAGE)
    assert not front.state.steers
    front.close()


def test_receivers_that_are_killed_end_in_a_stop_and_nothing_steers_again(processes, tmp_path):
    front = FrontEnd(processes, demonstrates=True)
    watch(front, steers, ENGAGE)
    os.kill(processes.by_name["receivers"].pid, signal.SIGKILL)
    watch(front, lambda front: front.state.stop, ENGAGE)
    watch(front, lambda front: not front.state.steers, ENGAGE)
    end = time.monotonic() + 3.0
    watch(front, lambda front: time.monotonic() > end or front.state.steers, ENGAGE)
    assert not front.state.steers
    front.close()
    processes.close()
    assert read_log(tmp_path / "log.mcap").records


def test_a_disk_that_fills_while_driving_costs_the_record_only_and_that_is_reported(processes, tmp_path):
    front, log = FrontEnd(processes, demonstrates=True), tmp_path / "log.mcap"
    watch(front, steers, ENGAGE)
    written = log.stat().st_size
    resource.prlimit(processes.by_name["recorder"].pid, resource.RLIMIT_FSIZE, (written, written))
    watch(front, lambda front: Cause.NOT_RECORDING.value in front.state.refusals, ENGAGE)
    end = time.monotonic() + 2.0
    watch(front, lambda front: time.monotonic() > end, ENGAGE)
    assert front.state.state is SupervisorState.ACTIVE
    front.close()
    processes.close()
    assert "the log cannot be written any further" in (tmp_path / "messages.txt").read_text()
    assert log.stat().st_size <= written
    assert read_log(log).records
    write_report(tmp_path)
    assert (tmp_path / "report.html").is_file()


@pytest.mark.parametrize(("free", "words"), [(8192, "the disk of .* is full: make room, .* --out"), (10**9, "it said")])
def test_a_process_that_dies_without_a_word_on_a_full_disk_is_explained(tmp_path, monkeypatch, free, words):
    monkeypatch.setattr(drive_processes.shutil, "disk_usage", lambda folder: SimpleNamespace(free=free))
    processes = DriveProcesses(with_stand_ins(load_configuration("articulated")), tmp_path, stand_ins=True)
    assert re.search(words, processes.last_output(["gate"]))
    processes.close()


def test_what_others_warn_of_is_no_reason_why_a_process_ended(tmp_path):
    processes = DriveProcesses(with_stand_ins(load_configuration("articulated")), tmp_path, stand_ins=True)
    processes.by_name |= dict.fromkeys(("gate", "receivers"))
    os.write(processes._output.descriptor, b"receivers: the line is lost\ngate: not locked\nport 9999 is taken\n")
    assert processes.last_output(["gate"]) == "gate: not locked / port 9999 is taken"
    processes.by_name.clear()
    processes.close()


def test_a_runs_folder_that_is_removed_while_driving_costs_the_record_only_and_that_is_reported(processes, tmp_path):
    front = FrontEnd(processes, demonstrates=True)
    watch(front, steers, ENGAGE)
    (tmp_path / "log.mcap").unlink()
    watch(front, lambda front: Cause.NOT_RECORDING.value in front.state.refusals, ENGAGE)
    assert front.state.state is SupervisorState.ACTIVE
    front.close()
    processes.close()
    assert "the log was removed while it was written" in (tmp_path / "messages.txt").read_text()


def test_a_recorder_whose_disk_hangs_is_ended_in_the_end(processes, monkeypatch):
    monkeypatch.setattr(drive_processes, "_WRITING", 0.5)
    os.kill(processes.by_name["recorder"].pid, signal.SIGSTOP)
    processes.close()
    assert processes.killed == ["recorder"]


def test_a_guard_that_is_frozen_is_reported_and_steering_goes_on(processes):
    front = FrontEnd(processes, demonstrates=True)
    watch(front, steers, ENGAGE)
    assert Cause.NOT_GUARDED.value not in front.state.refusals
    os.kill(processes.by_name["guard"].pid, signal.SIGSTOP)
    watch(front, lambda front: Cause.NOT_GUARDED.value in front.state.refusals, ENGAGE)
    assert front.state.state is SupervisorState.ACTIVE
    os.kill(processes.by_name["guard"].pid, signal.SIGCONT)
    watch(front, lambda front: Cause.NOT_GUARDED.value not in front.state.refusals, ENGAGE)
    front.close()


def test_a_gate_that_is_killed_is_reported_and_takes_the_controller_with_it(processes):
    front = FrontEnd(processes, demonstrates=True)
    watch(front, steers, ENGAGE)
    os.kill(processes.by_name["gate"].pid, signal.SIGKILL)
    processes.by_name["controller"].wait(ENGAGE)
    assert {"gate", "controller"} <= set(processes.ended())
    front.close()


def test_whatever_process_of_a_drive_crashes_leaves_where_it_was(processes, tmp_path):
    for process in processes.by_name.values():
        os.kill(process.pid, signal.SIGSTOP)  # so that each crashes by itself, whatever the others do
    for number, process in enumerate(processes.by_name.values(), 1):
        os.kill(process.pid, signal.SIGSEGV)
        os.kill(process.pid, signal.SIGCONT)
        assert process.wait(ENGAGE) == -signal.SIGSEGV
        assert "\n".join(processes.output()).count("Fatal Python error: Segmentation fault") == number
    assert "Fatal Python error: Segmentation fault" in processes.last_output(processes.by_name)
    processes.close()
    told = (tmp_path / "messages.txt").read_text()
    for name in ("recorder", "gate", "guard", "controller", "receivers"):
        assert re.search(rf"File .*{name}_main.py\", line \d+ in main", told), name


def test_the_gates_process_loads_no_numpy():
    words = (
        "import sys, drawbar.driving.processes.gate_main; sys.exit('numpy' in sys.modules or 'casadi' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", words]).returncode == 0
