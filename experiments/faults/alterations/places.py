"""Where on the path a fault begins, and for how long the drive is watched."""

STRAIGHT, CURVE = 22.0, 27.0
"""arc lengths, m: on a straight of 60 m; in the first curve behind one of 15 m"""


def straight(trial):
    trial.place = STRAIGHT


def curve(trial):
    trial.place = CURVE


def from_the_start(trial):
    trial.watched = 20.0


def for_long(trial):
    """Watch it from the first straight on; the path is longer."""
    trial.place, trial.watched = STRAIGHT, 1000.0


def does_not_creep(trial):
    trial.rehearsal.machine.driver.CREEP = 0.0
