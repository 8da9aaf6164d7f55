"""What the tractor's yaw-rate sensor says, where a place of places.py gives it one."""

import math

from drawbar.machine.stand_in.breaking import report_otherwise
from drawbar.machine.stand_in.receiver import of_quality
from drawbar.signals import FixQuality


def yaw_rate(trial, change):
    """Let the sensor say change(true yaw rate, rad/s, chance) from the fault on."""

    def begin():
        trial.yaw_rate = change

    trial.begin = begin


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
