"""Worker of this machine's own cluster: every one loads this module as it starts (Dask calls it a preload)."""

import signal

from distributed import Worker


def dask_setup(_worker: Worker) -> None:
    """Leave an interrupt at the keyboard, which reaches all processes, to the one that started the workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
