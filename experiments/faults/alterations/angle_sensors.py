"""What boards measure of their wheels' angles."""

import math

from drawbar.machine.stand_in.breaking import measure_otherwise


def measured(trial, change, *, loop=True):
    """Let the front wheels' board measure another angle from the fault on."""
    trial.begin = lambda: measure_otherwise(trial.rehearsal.machine, "tractor", change, loop=loop)


def tractor_angle_stuck(trial):
    trial.device("angle-stuck")


def trailer_angle_stuck(trial):
    trial.device("joint-angle-stuck")


def tractor_angle_off_2(trial):
    measured(trial, lambda true: true + math.radians(2.0))


def tractor_angle_off_5(trial):
    trial.device("angle-off")


def tractor_angle_drifts(trial):
    trial.device("angle-drifts")


def trailer_angle_drifts(trial):
    trial.device("joint-angle-drifts")


def tractor_angle_reversed(trial):
    trial.device("angle-reversed")


def tractor_angle_coarse(trial):
    measured(trial, lambda true: math.radians(round(math.degrees(true))), loop=False)


def tractor_angle_out_of_range(trial):
    measured(trial, lambda true: math.radians(60.0))
