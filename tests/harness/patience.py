"""Patience with drives in real time, on machines that are busy with other tests."""

import time

ENGAGE = 90.0
"""longest time until it steers on a busy machine, s"""
# a test machine may be too busy for the times of a real one; the rehearsal and the gate's tests prove those
PATIENT = [
    "safety.timing.command=0.5",
    "safety.timing.controller=5.0",
    "safety.timing.angle=5.0",
    "safety.timing.angle_lost=6.0",
    "safety.timing.speed=5.0",
    "safety.timing.recorder=20.0",
    "safety.timing.guard=5.0",
    "safety.timing.lease=30.0",
    "safety.timing.late=2.0",
    "safety.drive.operator=30.0",
    "safety.drive.overruns=1000",
    "safety.engage.quiet=0.1",
    "safety.engage.seen=5.0",
    "safety.engage.fixed=2.0",
]


def watch(front, until, longest):
    """Let a front end wait until something holds; return the gate's state."""
    end = time.monotonic() + longest
    while not until(front):
        front.wait(0.05)
        assert time.monotonic() < end, front.state
    return front.state
