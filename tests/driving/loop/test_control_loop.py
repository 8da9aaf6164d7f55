"""The control loop: in which order the gate is told what a step has come to."""

from types import SimpleNamespace

import pytest

from drawbar.driving.loop.control_loop import ControlLoop
from drawbar.machine.hardware.sampler import Sampler


class Controller:
    """Takes a step, which ends the run or not."""

    receivers, has_corrected = 2, False

    def __init__(self, *, ends):
        self.ends = ends

    def receive_fixes(self, fixes):
        pass

    def feedback(self, measurement, now):
        return SimpleNamespace(what="command", time=now)

    def prepare(self, *, late):
        return None

    def state(self, now, **known):
        return SimpleNamespace(what="state")


@pytest.mark.parametrize(("ends", "told"), [(False, ["command", "state"]), (True, ["state", "command", "state"])])
def test_why_a_run_ends_is_told_before_the_command_that_ends_it(ends, told):
    sent = []
    loop = ControlLoop(
        Controller(ends=ends),
        Sampler(0.2),
        send=lambda message: sent.append(message.what),
        record=lambda record: None,
        clock=lambda: 0,
    )
    loop._sampler._start = 0
    loop.miss()
    assert sent == told
