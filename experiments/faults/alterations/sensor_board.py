"""What the sensor board says of hitch and wheels' speed."""

from drawbar.machine.stand_in.breaking import scale_wheel_speed


def hitch_stuck(trial):
    trial.device("hitch-stuck")


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
