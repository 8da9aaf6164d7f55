"""SIGTERM raises within what heeds it, however deep, and nowhere else."""

import signal

from drawbar.termination import heeded_termination


def test_what_is_nested_leaves_the_outer_one_heeding():
    before = signal.getsignal(signal.SIGTERM)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    try:
        with heeded_termination():
            with heeded_termination():
                pass
            assert signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL
        assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    finally:
        signal.signal(signal.SIGTERM, before)
