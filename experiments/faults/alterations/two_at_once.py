"""Two faults in one drive, the second while drawbar still steers the vehicle to its stop, or slower, for the first."""

from drawbar.machine.stand_in.breaking import moved, report_otherwise
from drawbar.machine.stand_in.faults import FAULTS
from drawbar.machine.stand_in.receiver import of_quality
from drawbar.protocols.sensor_board import sentence
from drawbar.signals import FixQuality
from drawbar.vehicle.parameters import BODIES

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


def aside(left, bodies=BODIES, after=LATER):
    """Let positions be left(seconds since) m to the left, from `after` seconds after the first fault on."""

    def begin(trial):
        machine = trial.rehearsal.machine
        report_otherwise(
            machine,
            lambda report, since: moved(report, machine, left(since - after)) if since > after else report,
            bodies,
        )

    return begin


def drift(since):
    return 0.3 * since


def jump(since):
    return 1.0


def quality(reported):
    """Let both receivers report another quality, from the second fault on."""

    def begin(trial):
        report_otherwise(
            trial.rehearsal.machine,
            lambda report, since: of_quality(report, reported) if since > LATER else report,
        )

    return begin


def hitch_broken_then_drift(trial):
    both(trial, hitch(broken), aside(drift))


def hitch_broken_then_jump(trial):
    both(trial, hitch(broken), aside(jump))


def drift_then_hitch_broken(trial):
    both(trial, hitch(broken_later), aside(drift, after=0.0))


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
