"""What receivers report."""

import struct
from dataclasses import replace
from datetime import timedelta

from drawbar.machine.stand_in.breaking import freeze, moved, report_otherwise
from drawbar.machine.stand_in.receiver import of_quality
from drawbar.protocols.gnss.checksums import fletcher
from drawbar.signals import FixQuality
from drawbar.vehicle.parameters import BODIES


def receivers(trial, change, bodies=BODIES):
    """Let receivers report something else from the fault on; change(report, seconds since the fault)."""
    trial.begin = lambda: report_otherwise(trial.rehearsal.machine, change, bodies)


def shifted(report, trial, left):
    return moved(report, trial.rehearsal.machine, left)


def jump_of_10_cm(trial):
    receivers(trial, lambda report, since: shifted(report, trial, 0.10))


def jump_of_one_antenna(trial):
    trial.device("fix-jumps")


def jump_of_both(trial):
    trial.device("fixes-jump")


def jump_of_5_m(trial):
    receivers(trial, lambda report, since: shifted(report, trial, 5.0))


def slowest_drift(trial):
    receivers(trial, lambda report, since: shifted(report, trial, 0.02 * since))


def slow_drift(trial):
    trial.device("fixes-drift-slowly")


def fast_drift(trial):
    trial.device("fixes-drift")


def fast_drift_of_one(trial):
    trial.device("fix-drifts")


def slow_drift_of_one(trial):
    receivers(trial, lambda report, since: shifted(report, trial, 0.05 * since), ["tractor"])


def fast_drift_of_the_trailer(trial):
    receivers(trial, lambda report, since: shifted(report, trial, 0.3 * since), ["trailer"])


def far_away(trial):
    receivers(trial, lambda report, since: replace(report, latitude=report.latitude + 1.0))


def one_frozen(trial):
    trial.begin = lambda: freeze(trial.rehearsal.machine, ["tractor"])


def both_frozen(trial):
    trial.device("fixes-frozen")


def no_fix(trial):
    trial.device("fixes-lost")


def no_fix_for_1_s(trial):
    receivers(trial, lambda report, since: of_quality(report, FixQuality.NONE) if since < 1.0 else report)


def floating(trial):
    trial.device("fixes-float")


def float_flips(trial):
    qualities = (FixQuality.FIXED, FixQuality.FLOAT)
    receivers(trial, lambda report, since: of_quality(report, qualities[int(since / 0.6) % 2]))


def old_corrections(trial):
    receivers(trial, lambda report, since: replace(report, correction_age=30.0))


def speed_in_knots(trial):
    trial.device("speed-in-knots")


def zero_deviation(trial):
    receivers(trial, lambda report, since: replace(report, sigma_east=0.0, sigma_north=0.0))


def antennas_swapped(trial):
    trial.device("receivers-swapped")


def spoofing_reported(trial, bodies=BODIES):
    """Let receivers say that their signals are false ones: UBX NAV-STATUS, spoofing found."""
    status = bytes((0x01, 0x03)) + struct.pack("<HIBBBBII", 16, 0, 3, 1, 0, 2 << 3, 0, 0)
    frame = b"\xb5\x62" + status + fletcher(status)
    links = [f"{body} receiver" for body in bodies]
    trial.alter_links(links, lambda chance, start: lambda now, data: [(0.0, data + frame)])


def spoofing_reported_by_one(trial):
    spoofing_reported(trial, BODIES[:1])


def midnight(trial):
    """Let the receivers' clocks pass midnight two seconds or so behind the fault's place."""
    expected = 12.0 + trial.place / trial.configuration.speed
    encoders = trial.rehearsal.machine.encoders
    for body in BODIES:
        before = encoders[body]
        encoders[body] = lambda report, before=before: before(
            replace(report, time=report.time + timedelta(hours=18.0, seconds=-expected))
        )
