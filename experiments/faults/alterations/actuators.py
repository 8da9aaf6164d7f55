"""Where steerings turn to, and who steers them besides."""

import math

from drawbar.machine.stand_in.breaking import steer_otherwise
from drawbar.protocols.agopengps.steering import SteerCommand


def actuator(trial, body, change):
    trial.begin = lambda: steer_otherwise(trial.rehearsal.machine, body, change)


def tractor_stuck(trial):
    trial.device("wheels-stuck")


def trailer_stuck(trial):
    trial.device("joint-stuck")


def tractor_reversed(trial):
    trial.device("wheels-reversed")


def tractor_off_3(trial):
    trial.device("wheels-off")


def tractor_slow(trial):
    """Turn at 10°/s at most."""
    actuator(trial, "tractor", lambda wanted, true: true + clipped(wanted - true, 0.5 * math.radians(10.0) * 0.6))


def tractor_lags(trial):
    """Answer with a third of the speed."""
    actuator(trial, "tractor", lambda wanted, true: true + (wanted - true) / 3.0)


def clipped(value, limit):
    return min(max(value, -limit), limit)


def board_restarts(trial):
    trial.device("board-restarts")


def operator_takes_over(trial):
    trial.device("operator-steers")


def other_master(trial):
    """Let another program steer the front wheels' board straight, ten times a second."""

    def begin():
        rehearsal, inner = trial.rehearsal, trial.rehearsal.links.faults.get("tractor set point")
        foreign = SteerCommand(steer=True, angle=0.0, speed=1.0).encode()
        wire = rehearsal.wires["tractor"]

        def fault(now, data):
            wire.arrive(now, foreign, "192.168.5.10:9999")
            return [*(inner(now, data) if inner else [(0.0, data)]), (0.01, foreign)]

        rehearsal.links.faults["tractor set point"] = fault

    trial.begin = begin
