"""What the sensor board says of hitch and wheels' speed."""

import math

from drawbar.machine.stand_in.breaking import drift_hitch, scale_wheel_speed
from drawbar.machine.stand_in.machine import COUNTS_PER_RADIAN


def hitch_stuck(trial):
    trial.device("hitch-stuck")


def hitch_drifts(trial):
    trial.device("hitch-drifts")


def hitch_drifts_slowly(trial):
    trial.begin = lambda: drift_hitch(trial.rehearsal.machine, math.radians(0.5) * COUNTS_PER_RADIAN)


def hitch_scaled(trial):
    def begin():
        trial.rehearsal.machine.hitch_counts = lambda right: 2048 + round(0.6 * (right - 2048))

    trial.begin = begin


def hitch_reversed(trial):
    trial.device("hitch-reversed")


def hitch_broken(trial):
    trial.device("hitch-broken")


def hitch_missing(trial):
    def begin():
        trial.rehearsal.machine.hitch_counts = lambda right: None

    trial.begin = begin


def wheel_speed_zero(trial):
    trial.device("wheel-speed-zero")


def wheel_speed_tenfold(trial):
    trial.begin = lambda: scale_wheel_speed(trial.rehearsal.machine, 10)


def sensors_silent(trial):
    trial.device("sensors-silent")
