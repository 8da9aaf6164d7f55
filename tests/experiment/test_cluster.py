"""Calls on a cluster: every argument has its answer, and a bad call harms no other."""

import json
import math
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from distributed import Client
from waiting import until

from drawbar.errors import DrawbarError
from drawbar.experiment import cluster as cluster_module
from drawbar.experiment.cluster import Failure, call_all, open_cluster


def test_every_argument_has_its_answer(cluster: Client) -> None:
    arguments = {str(number): float(number) for number in range(50)}
    answers = list(call_all(cluster, math.sqrt, arguments))
    assert len(answers) == len(arguments)
    assert dict(answers) == {key: math.sqrt(value) for key, value in arguments.items()}


def test_nothing_to_do_is_done(cluster: Client) -> None:
    assert list(call_all(cluster, math.sqrt, {})) == []


def test_a_call_that_raises_says_why_and_harms_no_other(cluster: Client) -> None:
    answers = dict(call_all(cluster, math.sqrt, {"good": 9.0, "bad": -1.0, "best": 16.0}))
    assert answers == {"good": 3.0, "bad": Failure(reason="ValueError: math domain error"), "best": 4.0}


def test_a_call_that_kills_its_worker_is_given_up(cluster: Client) -> None:
    ((key, answer),) = call_all(cluster, os._exit, {"deadly": 3})
    assert key == "deadly"
    assert isinstance(answer, Failure)
    assert answer.reason.startswith("KilledWorker")
    assert dict(call_all(cluster, math.sqrt, {"after": 25.0})) == {"after": 5.0}


def test_calls_do_not_wait_for_ever_where_all_workers_are_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(cluster_module._CONFIGURATION, "distributed.scheduler.no-workers-timeout", 0.5)
    with open_cluster(jobs=1) as client:
        client.retire_workers()
        answers = dict(call_all(client, math.sqrt, {"a": 1.0, "b": 4.0, "c": 9.0}))
    assert answers.keys() == {"a", "b", "c"}
    assert all(isinstance(answer, Failure) for answer in answers.values())


def test_one_at_a_time_is_in_order(cluster: Client) -> None:
    waits = {"a": 0.3, "b": 0.0, "c": 0.1}
    assert [key for key, _ in call_all(cluster, time.sleep, waits, at_once=1)] == ["a", "b", "c"]


def test_an_address_without_scheduler_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("drawbar.experiment.cluster._PATIENCE", 0.2)
    for address in ("tcp://127.0.0.1:1", "nonsense://x"):
        with pytest.raises(DrawbarError, match="no Dask scheduler answers"), open_cluster(address):
            pass


def listening(processes: set[int]) -> list[str]:
    """Return the addresses on which processes listen, as /proc writes them."""
    sockets = set()
    for process in processes:
        for link in Path(f"/proc/{process}/fd").iterdir():
            target = os.readlink(link) if link.is_symlink() else ""
            sockets |= {target[8:-1]} if target.startswith("socket:[") else set()
    rows = [row.split() for table in ("tcp", "tcp6") for row in Path("/proc/net", table).read_text().splitlines()[1:]]
    return [row[1].partition(":")[0] for row in rows if row[3] == "0A" and row[9] in sockets]


@pytest.mark.skipif(sys.platform != "linux", reason="/proc")
def test_own_cluster_listens_on_loopback_alone(cluster: Client) -> None:
    workers = set(cluster.run(os.getpid).values())
    found = listening({os.getpid(), *workers})
    assert found
    assert set(found) == {socket.inet_aton("127.0.0.1")[::-1].hex().upper()}


@pytest.fixture
def scheduler(tmp_path: Path) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """A scheduler with one worker, both of its own process: the scheduler, and its address."""
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    program = (sys.executable, "-m", "dask")
    place = ("--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(tmp_path / "scheduler.json"))
    with (
        subprocess.Popen([*program, "scheduler", "--port", "0", *place], **quiet) as scheduler,
        subprocess.Popen([*program, "worker", *place, "--nthreads", "1"], **quiet) as worker,
    ):
        try:
            file = tmp_path / "scheduler.json"
            content = until(lambda: file.exists() and file.read_text().rstrip().endswith("}") and file.read_text())
            yield scheduler, json.loads(content)["address"]
        finally:
            scheduler.kill()
            worker.kill()


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_scheduler_that_dies_is_one_message(
    scheduler: tuple[subprocess.Popen[bytes], str], capfd: pytest.CaptureFixture[str]
) -> None:
    process, address = scheduler
    with open_cluster(address) as on:
        answers = call_all(on, time.sleep, {str(number): 0.05 for number in range(200)})
        next(answers)
        process.send_signal(signal.SIGKILL)
        with pytest.raises(DrawbarError, match="scheduler is gone; finished runs are kept"):
            list(answers)
    assert "Traceback" not in capfd.readouterr().err


@pytest.fixture
def starting(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Put a cluster in the place of Dask's; return what became of it, to which "interrupt" may be added before."""
    seen: list[str] = []

    class Starting:
        def __init__(self, *arguments: object, **settings: object) -> None:
            if os.name == "nt":
                assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN  # so workers inherit it
            else:
                assert signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, [])
            if "interrupt" in seen:
                signal.raise_signal(signal.SIGINT)

        def __enter__(self) -> None:
            seen.append("there")

        def __exit__(self, *error: object) -> None:
            seen.append("closed")

    monkeypatch.setattr(cluster_module, "LocalCluster", Starting)
    monkeypatch.setattr(cluster_module, "Client", Starting)
    return seen


def test_a_cluster_that_is_there_is_interrupted(starting: list[str]) -> None:
    with pytest.raises(KeyboardInterrupt), open_cluster():
        signal.raise_signal(signal.SIGINT)
    assert starting == ["there", "there", "closed", "closed"]


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_an_interrupt_while_a_cluster_starts_comes_as_soon_as_it_is_there(starting: list[str]) -> None:
    before = signal.getsignal(signal.SIGINT)  # Python's own, or Socket.IO's, which the console's tests bring in
    starting.append("interrupt")
    with pytest.raises(KeyboardInterrupt), open_cluster():
        starting.append("calls")
    assert starting == ["interrupt", "there", "there", "closed", "closed"]
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_who_ignores_interrupts_goes_on_doing_so() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)  # as nohup and & of a shell's script do
    try:
        with cluster_module._uninterrupted():
            signal.raise_signal(signal.SIGINT)
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
