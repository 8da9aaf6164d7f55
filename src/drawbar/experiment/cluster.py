"""Cluster: pure functions of plain data on Dask (Rocklin 2015, *Dask: parallel computation with blocked algorithms*).

A worker that dies loses nothing: Dask gives its calls to another one, up to `distributed.scheduler.allowed-failures`
times. A call that raises, or that kills every worker it meets, ends in a Failure and disturbs no other.
"""

import logging
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from itertools import islice
from multiprocessing import resource_tracker
from typing import Any, Self, TypeVar

import dask
from dask.system import CPU_COUNT
from distributed import Client, Future, LocalCluster, as_completed

from drawbar.errors import DrawbarError

T = TypeVar("T")
R = TypeVar("R")

_PATIENCE = 30.0
"""s, for a scheduler to answer and for its first worker"""
_CONFIGURATION: dict[str, Any] = {
    "distributed.scheduler.no-workers-timeout": 60.0,  # s; then the calls fail: all workers died, and none came back
    "distributed.worker.profile.enabled": False,  # nobody looks at the samples, and taking them costs a fifth
}
_LOCAL: dict[str, Any] = {
    "threads_per_worker": 1,
    "host": "127.0.0.1",
    "scheduler_kwargs": {"dashboard": False},  # it has no password
    "dashboard_address": "127.0.0.1:0",  # of Dask's plain web server, which cannot be left out: any free port
    "silence_logs": logging.CRITICAL,
    "preload": "drawbar.experiment.worker",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """Why a call has no result."""

    reason: str

    @classmethod
    def of(cls, error: BaseException) -> Self:
        """Return the failure of a call that raised."""
        return cls(reason=str(error) if isinstance(error, DrawbarError) else f"{type(error).__name__}: {error}")


@contextmanager
def open_cluster(address: str = "", jobs: int | None = None) -> Iterator[Client]:
    """Connect to the scheduler at the address, or, if that is empty, start a cluster on this machine; as a context.

    Args:
        address: of a running scheduler, e.g. tcp://10.0.0.1:8786, or empty.
        jobs: processes of the cluster on this machine; None: one per processor core.

    Raises:
        DrawbarError: no scheduler answers at the address, or it has no workers.
    """
    if address:
        with _connect(address) as client:
            yield client
        return
    with dask.config.set(_CONFIGURATION), ExitStack() as opened:
        with _uninterrupted():
            local = opened.enter_context(LocalCluster(n_workers=jobs or CPU_COUNT, **_LOCAL))
            client = opened.enter_context(Client(local))
        yield client


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Keep the keyboard's interrupt back for the second or two in which the cluster starts, and raise it then.

    Dask cannot close a cluster that is half started. Workers that are being started inherit that it is blocked, and so
    does the thread that starts them; on Windows it is ignored.
    """
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or before is signal.SIG_IGN:
        yield  # another thread is never interrupted
        return
    kept_back: list[int] = []
    can_block = hasattr(signal, "pthread_sigmask")
    signal.signal(signal.SIGINT, (lambda number, _: kept_back.append(number)) if can_block else signal.SIG_IGN)
    if can_block:
        resource_tracker.ensure_running()  # which would unblock it
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        if can_block:
            signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        signal.signal(signal.SIGINT, before)
    if kept_back:
        raise KeyboardInterrupt


def _connect(address: str) -> Client:
    # what Dask would log, tracebacks included, when a scheduler dies is reported by call_all in one message
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=_PATIENCE)
    except (OSError, ValueError) as error:
        raise DrawbarError(
            f"--cluster {address}: no Dask scheduler answers there ({error}); start one with: dask scheduler"
        ) from error
    try:
        client.wait_for_workers(1, timeout=_PATIENCE)
    except TimeoutError as error:
        client.close()
        raise DrawbarError(
            f"--cluster {address}: the scheduler has no workers; start one with: dask worker {address}"
        ) from error
    return client


def call_all(
    client: Client, function: Callable[[T], R], arguments: Mapping[str, T], *, at_once: int | None = None
) -> Iterator[tuple[str, R | Failure]]:
    """Call the function with every argument; yield each result under its key as soon as it is there.

    Args:
        client: of the cluster.
        function: pure, importable by the workers.
        arguments: plain data; the key distinguishes an argument from every other that this function is ever given.
        at_once: calls that may run at the same time; None: as many as there are workers.

    Raises:
        DrawbarError: the scheduler is gone.
    """
    waiting = iter(arguments.items())

    def submitted(count: int | None) -> Iterator[Future[Any]]:
        for key, argument in islice(waiting, count):
            keys[future := client.submit(function, argument, key=f"{function.__name__}-{key}")] = key
            yield future

    keys: dict[Future[Any], str] = {}
    completed = as_completed(list(submitted(at_once)), loop=client.loop, with_results=True, raise_errors=False)
    for future, outcome in completed:
        key = keys.pop(future)
        if future.status in ("cancelled", "lost"):  # nobody cancels here: the connection has ended
            raise DrawbarError(
                "the Dask scheduler is gone; finished runs are kept: start it again, with its workers, "
                "and the same command continues"
            )
        yield key, outcome if future.status == "finished" else _failure(outcome)
        completed.update(list(submitted(1)))


def _failure(outcome: Any) -> Failure:
    """Return the failure that Dask gives in place of a result: an exception, alone or with its traceback."""
    return Failure.of(outcome[1] if isinstance(outcome, tuple) else outcome)
