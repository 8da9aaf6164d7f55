"""Processes that end, freeze or come late, and people."""

import math

from drawbar.driving.stand_in.rehearsal import Participant
from drawbar.machine.stand_in.faults import FAULTS
from drawbar.messages import Action


def stopped(trial, participant, seconds=math.inf):
    """Let a participant stand still, for a time."""

    def begin():
        end, rehearsal = trial.rehearsal.time + seconds, trial.rehearsal
        rehearsal.stopped.add(participant)
        before = rehearsal.machine.advance

        def advance(now):
            if now >= end:
                rehearsal.stopped.discard(participant)
            return before(now)

        rehearsal.machine.advance = advance

    trial.begin = begin


def ended(trial, participant):
    """Let a participant end."""
    trial.begin = lambda: trial.rehearsal.end(participant)


def controller_ends(trial):
    ended(trial, Participant.CONTROLLER)


def controller_freezes(trial):
    stopped(trial, Participant.CONTROLLER)


def controller_freezes_for_1_s(trial):
    stopped(trial, Participant.CONTROLLER, 1.0)


def controller_late_once(trial):
    stopped(trial, Participant.CONTROLLER, 0.08)


def controller_late_for_long(trial):
    stopped(trial, Participant.CONTROLLER, 0.2)


def controller_late_often(trial):
    """Let every other step begin 60 ms after its epoch."""
    until = [-math.inf, 0]
    before = trial.rehearsal.machine.advance

    def advance(now):
        if now < until[0]:
            trial.rehearsal.stopped.add(Participant.CONTROLLER)
        else:
            trial.rehearsal.stopped.discard(Participant.CONTROLLER)
        return before(now)

    def make(chance, start):
        trial.rehearsal.machine.advance = advance

        def pass_on(now, data):
            until[1] += 1
            if until[1] % 2:
                until[0] = now + 0.06
            return [(0.01, data)]

        return pass_on

    trial.alter_links(["tractor receiver"], make)


def receivers_freeze(trial):
    stopped(trial, Participant.RECEIVERS)


def receivers_end(trial):
    ended(trial, Participant.RECEIVERS)


def guard_freezes(trial):
    stopped(trial, Participant.GUARD)


def recorder_freezes(trial):
    stopped(trial, Participant.RECORDER)


def recorder_gone(trial):
    ended(trial, Participant.RECORDER)


def gate_gone(trial):
    ended(trial, Participant.GATE)


def gate_freezes_for_1_s(trial):
    stopped(trial, Participant.GATE, 1.0)


def suspended(trial):
    def begin():
        trial.rehearsal.gate._suspended_before -= 2.0

    trial.begin = begin


def operator_gone(trial):
    ended(trial, Participant.OPERATOR)


def operator_stops(trial):
    trial.begin = lambda: trial.rehearsal.ask(Action.STOP)


def emergency(trial):
    trial.begin = lambda: trial.rehearsal.ask(Action.EMERGENCY)


def driver_ignores_the_stop(trial):
    def begin():
        FAULTS["driver-stays"].begin(trial.rehearsal.machine)
        trial.rehearsal.ask(Action.STOP)

    trial.begin = begin
