"""A simulated tractor whose antenna stands where one says, driven in S-curves by hand."""

import math

import numpy as np

from drawbar.config import load_configuration
from drawbar.signals import Command
from drawbar.simulation import build_machine, build_path


def serpentine(forward, left, *, seed=0, seconds=150.0, half=4.0, right=1.0):
    """Return times, antenna's x and y, wheel speed and front wheels (SI) of S-curves.

    `half` s lead to each side; to the right the wheels turn `right` times as far as to the left.
    """
    masts = [f"machine.masts.tractor.forward={forward}", f"machine.masts.tractor.left={left}"]
    configuration = load_configuration("articulated", masts)
    machine, rows = build_machine(configuration, build_path(configuration)[0], seed), []
    while not rows or rows[-1][0] < seconds:
        seen = machine.read()
        rows.append((seen.time, seen.tractor_x, seen.tractor_y, seen.speed, seen.tractor_steering))
        angle = math.radians(24.0) * math.sin(math.pi * seen.time / half)
        angle *= right if angle < 0.0 else 1.0
        machine.write(Command(time=seen.time, tractor_steering=angle, trailer_steering=0.0, speed=1.0))
    return np.array(rows).T
