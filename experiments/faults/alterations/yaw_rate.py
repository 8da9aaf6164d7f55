"""What the tractor's yaw-rate sensor says."""

import math
import random
from dataclasses import replace

from drawbar.geometry import wrap
from drawbar.machine.stand_in.breaking import report_otherwise
from drawbar.machine.stand_in.receiver import of_quality
from drawbar.signals import FixQuality

YAW_RATE_NOISE = math.radians(0.3)
"""of a sensor that is right, standard deviation, rad/s"""


def yaw_rate(trial, change):
    """Give the tractor a yaw-rate sensor that from the fault on says change(true yaw rate, rad/s, chance).

    It is put between sampler and controller: stand-ins have no such sensor, and no wire carries it.
    """
    controller, world = trial.rehearsal.loop._controller, trial.rehearsal.machine.world
    chance, feedback, seen, begun = random.Random(trial.seed), controller.feedback, [], []

    def measured(measurement, now):
        seen.append((trial.rehearsal.time, world.truth.tractor.yaw))
        (earlier, before), (later, yaw) = seen[0], seen[-1]
        del seen[:-1]
        true = wrap(yaw - before) / (later - earlier) if later > earlier else 0.0
        told = change(true, chance) if begun else true
        noisy = told + chance.gauss(0.0, YAW_RATE_NOISE)
        return feedback(replace(measurement, tractor_yaw_rate=noisy), now)

    controller.feedback = measured
    trial.begin = lambda: begun.append(True)


def yaw_rate_reversed(trial):
    yaw_rate(trial, lambda true, chance: -true)


def yaw_rate_stuck(trial):
    kept = []

    def change(true, chance):
        kept.append(true)
        return kept[0]

    yaw_rate(trial, change)


def yaw_rate_off_5(trial):
    yaw_rate(trial, lambda true, chance: true + math.radians(5.0))


def yaw_rate_noisy(trial):
    yaw_rate(trial, lambda true, chance: true + chance.gauss(0.0, math.radians(5.0)))


def yaw_rate_off_then_no_fix(trial):
    """Two faults: a second after the yaw rate has gone wrong both receivers lose their fix."""
    yaw_rate_off_5(trial)
    first = trial.begin

    def begin():
        first()
        report_otherwise(
            trial.rehearsal.machine,
            lambda report, since: of_quality(report, FixQuality.NONE) if since > 1.0 else report,
        )

    trial.begin = begin
