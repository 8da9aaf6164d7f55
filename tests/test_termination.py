"""SIGTERM raises within `termination_as_exit`, however deep, and nowhere else."""

import signal

from drawbar.termination import termination_as_exit


def test_what_is_nested_leaves_the_outer_one_in_force():
    before = signal.getsignal(signal.SIGTERM)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    try:
        with termination_as_exit():
            with termination_as_exit():
                pass
            assert signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL
        assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    finally:
        signal.signal(signal.SIGTERM, before)
