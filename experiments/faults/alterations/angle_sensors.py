"""What boards measure of their wheels' angles."""

import math

from drawbar.machine.stand_in.faults import measure_the_same, steer_otherwise


class SpoiltWheel:
    """What a board measures of a wheel: what `change` makes of its true angle."""

    def __init__(self, wheel, change):
        self._wheel, self._change, self.true = wheel, change, wheel.angle

    @property
    def angle(self):
        return self._wheel.angle

    @angle.setter
    def angle(self, true):
        self.true, self._wheel.angle = true, self._change(true)


def measured(trial, body, change, *, loop=True):
    """Let a board measure another angle of its wheel from the fault on.

    Its position loop goes by what it measures: it turns the wheel until that is where it should be, or to the stop.
    """

    def begin():
        board, wheel = trial.rehearsal.machine.boards[body]
        spoilt = SpoiltWheel(wheel, change)
        trial.rehearsal.machine.boards[body] = (board, spoilt)
        spoilt.angle = wheel.angle
        if loop:
            steer_otherwise(trial.rehearsal.machine, body, lambda wanted, true: true + 4.0 * (wanted - spoilt.angle))

    trial.begin = begin


def tractor_angle_stuck(trial):
    trial.device("angle-stuck")


def trailer_angle_stuck(trial):
    trial.begin = lambda: measure_the_same(trial.rehearsal.machine, "trailer")


def tractor_angle_off_2(trial):
    measured(trial, "tractor", lambda true: true + math.radians(2.0))


def tractor_angle_off_5(trial):
    measured(trial, "tractor", lambda true: true + math.radians(5.0))


def tractor_angle_reversed(trial):
    measured(trial, "tractor", lambda true: -true)


def tractor_angle_coarse(trial):
    measured(trial, "tractor", lambda true: math.radians(round(math.degrees(true))), loop=False)


def tractor_angle_out_of_range(trial):
    measured(trial, "tractor", lambda true: math.radians(60.0))
