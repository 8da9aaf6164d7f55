"""What the sensor board says of hitch and wheels' speed."""

from drawbar.protocols.sensor_board import sentence


def sensed(trial, change):
    """Change what the sensor board says: change(counts of the hitch, pulses, seconds since the fault)."""

    def make(chance, start):
        def fault(now, data):
            milliseconds, counts, pulses = data[1:].partition(b"*")[0].split(b",")[1:]
            return [(0.0, sentence(int(milliseconds), *change(int(counts), int(pulses), now - start)))]

        return fault

    trial.alter_links(["sensors"], make)


def hitch_stuck(trial):
    kept = []

    def change(counts, pulses, since):
        kept.append(counts)
        return kept[0], pulses

    sensed(trial, change)


def hitch_reversed(trial):
    sensed(trial, lambda counts, pulses, since: (4096 - counts, pulses))


def hitch_broken(trial):
    sensed(trial, lambda counts, pulses, since: (0, pulses))


def hitch_missing(trial):
    sensed(trial, lambda counts, pulses, since: (None, pulses))


def wheel_speed_zero(trial):
    kept = []

    def change(counts, pulses, since):
        kept.append(pulses)
        return counts, kept[0]

    sensed(trial, change)


def wheel_speed_tenfold(trial):
    kept = []

    def change(counts, pulses, since):
        kept.append(pulses)
        return counts, kept[0] + 10 * (pulses - kept[0])

    sensed(trial, change)


def sensors_silent(trial):
    trial.device("sensors-silent")
