"""Where on the path a fault begins, with which sensors, and for how long the drive is watched."""

import math
import random
from dataclasses import replace

from drawbar.geometry import wrap

STRAIGHT, CURVE = 22.0, 27.0
"""arc lengths, m: on a straight of 60 m; in the first curve behind one of 15 m"""
YAW_RATE_NOISE = math.radians(0.3)
"""of a sensor that is right, standard deviation, rad/s"""


def straight(trial):
    trial.place = STRAIGHT


def curve(trial):
    trial.place = CURVE


def straight_with_yaw_rate(trial):
    straight(trial)
    _measure_yaw_rate(trial)


def curve_with_yaw_rate(trial):
    curve(trial)
    _measure_yaw_rate(trial)


def _measure_yaw_rate(trial):
    """Give the tractor a yaw-rate sensor, which says trial.yaw_rate(true yaw rate, rad/s, chance), and its noise.

    It is put between sampler and controller: stand-ins have no such sensor, and no wire carries it.
    """
    controller, world = trial.rehearsal.loop._controller, trial.rehearsal.machine.world
    chance, feedback, seen = random.Random(trial.seed), controller.feedback, []
    trial.yaw_rate = lambda true, chance: true

    def measured(measurement, now):
        seen.append((trial.rehearsal.time, world.truth.tractor.yaw))
        (earlier, before), (later, yaw) = seen[0], seen[-1]
        del seen[:-1]
        true = wrap(yaw - before) / (later - earlier) if later > earlier else 0.0
        noisy = trial.yaw_rate(true, chance) + chance.gauss(0.0, YAW_RATE_NOISE)
        return feedback(replace(measurement, tractor_yaw_rate=noisy), now)

    controller.feedback = measured


def from_the_start(trial):
    trial.watched = 20.0


def for_long(trial):
    """Watch it from the first straight on; the path is longer."""
    trial.place, trial.watched = STRAIGHT, 1000.0


def does_not_creep(trial):
    trial.rehearsal.machine.driver.CREEP = 0.0
