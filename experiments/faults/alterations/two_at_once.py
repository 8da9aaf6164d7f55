"""Two faults in one drive, the second while drawbar still steers the vehicle to its stop, or slower, for the first."""

import math
import random
from dataclasses import replace

from drawbar.machine.stand_in.faults import FAULTS, moved, report_otherwise
from drawbar.machine.stand_in.machine import BODIES
from drawbar.machine.stand_in.receiver import of_quality
from drawbar.protocols.sensor_board import sentence
from drawbar.signals import FixQuality

LATER = 1.0
"""from the first fault to the second, s"""


def both(trial, first, second):
    """Let both begin; each is called with the trial at the fault's place, and waits by itself."""

    def begin():
        first(trial)
        second(trial)

    trial.begin = begin


def device(name):
    return lambda trial: FAULTS[name].begin(trial.rehearsal.machine)


def hitch(change):
    """Let the sensor board's counts of the hitch be change(counts, seconds since the fault)."""

    def begin(trial):
        start = trial.rehearsal.time

        def fault(now, data):
            milliseconds, counts, pulses = data[1:].partition(b"*")[0].split(b",")[1:]
            return [(0.0, sentence(int(milliseconds), change(int(counts), now - start), int(pulses)))]

        trial.rehearsal.links.faults["sensors"] = fault

    return begin


def broken(counts, since):
    return 0


def broken_later(counts, since):
    return 0 if since > LATER else counts


def aside(left, bodies=BODIES):
    """Let positions of receivers be left(seconds since the second fault) m to the left."""

    def begin(trial):
        machine = trial.rehearsal.machine
        report_otherwise(
            machine,
            lambda report, since: moved(report, machine, left(since - LATER)) if since > LATER else report,
            bodies,
        )

    return begin


def drift(since):
    return 0.3 * since


def jump(since):
    return 1.0


def quality(trial_quality):
    def begin(trial):
        report_otherwise(
            trial.rehearsal.machine,
            lambda report, since: of_quality(report, trial_quality) if since > LATER else report,
        )

    return begin


def hitch_broken_then_drift(trial):
    both(trial, hitch(broken), aside(drift))


def hitch_broken_then_jump(trial):
    both(trial, hitch(broken), aside(jump))


def drift_then_hitch_broken(trial):
    both(trial, hitch(broken_later), lambda each: report_otherwise(
        each.rehearsal.machine, lambda report, since: moved(report, each.rehearsal.machine, drift(since))
    ))  # fmt: skip


def jump_then_hitch_broken(trial):
    both(trial, hitch(broken_later), device("fixes-jump"))


def receiver_lost_then_drift_of_the_other(trial):
    both(trial, device("receiver-silent"), aside(drift, BODIES[1:]))


def receiver_lost_then_jump_of_the_other(trial):
    both(trial, device("receiver-silent"), aside(jump, BODIES[1:]))


def hitch_stuck_then_float(trial):
    kept = []

    def stuck(counts, since):
        kept.append(counts)
        return kept[0]

    both(trial, hitch(stuck), quality(FixQuality.FLOAT))


def yaw_rate_off_then_no_fix(trial):
    """Give the tractor a yaw-rate sensor, as yaw_rate.py, that is suddenly 5°/s off."""
    controller, world = trial.rehearsal.loop._controller, trial.rehearsal.machine.world
    chance, feedback, seen, begun = random.Random(trial.seed), controller.feedback, [], []

    def measured(measurement, now):
        seen.append((trial.rehearsal.time, world.truth.tractor.yaw))
        (earlier, before), (later, yaw) = seen[0], seen[-1]
        del seen[:-1]
        true = math.remainder(yaw - before, math.tau) / (later - earlier) if later > earlier else 0.0
        told = true + chance.gauss(0.0, math.radians(0.3)) + math.radians(5.0) * bool(begun)
        return feedback(replace(measurement, tractor_yaw_rate=told), now)

    controller.feedback = measured
    both(trial, lambda each: begun.append(True), quality(FixQuality.NONE))
