"""Real-time habits of every process that drives: memory locked, scheduled first, no garbage collector, watchdog fed.

Each of them may be forbidden to a user or missing from a system; then the process runs on, and prints that once. Linux;
elsewhere the collector alone is stopped. Without numpy.
"""

import ctypes
import gc
import os
import signal
import socket
import sys
import time
from contextlib import suppress

LOCK_ALL = 3
"""MCL_CURRENT | MCL_FUTURE"""
TOGETHER = 1e-3
"""two clocks are read within this time, or once more: the process may have been stopped in between, s"""
ATTEMPTS = 5


def prepare(priority: int) -> list[str]:
    """Make this process ready for a loop with deadlines, after it has loaded and built all that it needs.

    Garbage is collected once, what remains is frozen, and the collector is stopped; memory is locked into RAM; the
    process is scheduled before all others, its children not.

    Args:
        priority: of SCHED_FIFO, 1 to 99; 0: leave the scheduling as it is.

    Returns:
        A sentence for each thing that could not be had, with what it costs and what to do.
    """
    gc.collect()
    gc.freeze()
    gc.disable()
    return [word for word in (_lock_memory(), schedule_first(priority)) if word]


def _lock_memory() -> str:
    if not sys.platform.startswith("linux"):
        return f"memory is not locked: {sys.platform} has no mlockall here; expect pauses when memory is short"
    library = ctypes.CDLL(None, use_errno=True)
    if library.mlockall(LOCK_ALL) == 0:
        return ""
    reason = os.strerror(ctypes.get_errno())
    return (
        f"memory is not locked ({reason}): a page that was swapped out delays a tick; raise the limit of locked memory "
        f"(LimitMEMLOCK=infinity in systemd, ulimit -l) or drive with memory to spare"
    )


def schedule_first(priority: int) -> str:
    """Schedule this process before all others, its children not; return what forbids it, in a sentence, or nothing.

    priority: of SCHED_FIFO, 1 to 99; 0: leave the scheduling as it is.
    """
    if not priority:
        return ""
    if not hasattr(os, "SCHED_FIFO"):
        return f"not scheduled in real time: {sys.platform} has no SCHED_FIFO; expect late ticks under load"
    try:
        # children, a compiler for instance, would starve all else
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(priority))
    except (OSError, ValueError) as error:
        return (
            f"not scheduled in real time at priority {priority} ({error}): ticks come late when other programs are "
            f"busy; allow it (LimitRTPRIO=60 in systemd, CAP_SYS_NICE)"
        )
    return ""


def prefer(niceness: int) -> str:
    """Give this process and its later threads more of a busy computer than others; return what forbids it, or nothing.

    niceness: -20, the most, to 19.
    """
    if not hasattr(os, "setpriority"):
        return ""
    try:
        os.setpriority(os.PRIO_PROCESS, 0, niceness)
    except OSError as error:
        return (
            f"gets no more of this computer than others ({error.strerror}): it may not keep up when they are busy; "
            f"allow it (LimitNICE={niceness} in systemd, CAP_SYS_NICE)"
        )
    return ""


def step_back_when_busy(longest: float, why: str) -> None:
    """Have this process scheduled as any other, and print that, once it has been busy for a time (s) without waiting.

    For a process that can be flooded from outside: scheduled first, it would starve all others.
    """
    if not sys.platform.startswith("linux"):
        return
    import resource

    def step_back(number: int, frame: object) -> None:
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        say(f"{why}; no longer scheduled in real time")

    signal.signal(signal.SIGXCPU, step_back)
    _, most = resource.getrlimit(resource.RLIMIT_RTTIME)
    resource.setrlimit(resource.RLIMIT_RTTIME, (round(longest * 1e6), most))


def suspended_time() -> float:
    """Return for how long this computer has been suspended since it started, s; 0 where the system gives no time."""
    if not hasattr(time, "CLOCK_BOOTTIME"):
        return 0.0
    for _ in range(ATTEMPTS):
        before = time.clock_gettime(time.CLOCK_MONOTONIC)
        booted = time.clock_gettime(time.CLOCK_BOOTTIME)
        after = time.clock_gettime(time.CLOCK_MONOTONIC)
        if after - before <= TOGETHER:
            break
    return booted - after


def say(text: str) -> None:
    """Print on standard error, which a drive keeps in a file: that its disk is full ends no process."""
    with suppress(OSError):
        os.write(sys.stderr.fileno(), f"{text}\n".encode())  # what a buffer kept would fail again at the end


class Notifier:
    """Reports the state of this process to the service manager, if there is one, by datagrams of sd_notify(3)."""

    def __init__(self) -> None:
        """Read NOTIFY_SOCKET and WATCHDOG_USEC."""
        address = os.environ.get("NOTIFY_SOCKET", "")
        self._address = "\0" + address[1:] if address.startswith("@") else address
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) if address else None
        if self._socket is not None:
            self._socket.setblocking(False)
        self._period = int(os.environ.get("WATCHDOG_USEC", "0")) * 0.5e-6
        self._fed = float("-inf")

    def tell(self, *lines: str) -> None:
        """Send lines such as `READY=1`; a manager that does not listen is not waited for."""
        if self._socket is None:
            return
        try:
            self._socket.sendto("\n".join(lines).encode(), self._address)
        except OSError:
            return

    def feed(self, time: float) -> None:
        """Feed the manager's watchdog, at twice the rate it asks for; call from the loop that matters, time in s."""
        if self._period > 0.0 and not (time - self._fed < self._period):
            self._fed = time
            self.tell("WATCHDOG=1")

    def close(self) -> None:
        """Close the socket."""
        if self._socket is not None:
            self._socket.close()
