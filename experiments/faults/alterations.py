"""What breaks, and where: functions of a Trial, whose rehearsal drives everything with the real bytes in between.

A function of a place says where on the path the fault begins; one of a fault says what happens then.
"""

import math
import random
from dataclasses import replace
from datetime import timedelta

from drawbar.driving.rehearsal import Part
from drawbar.geometry import wrap
from drawbar.machine.stand_in.faults import freeze, measure_the_same, moved, report_otherwise, steer_otherwise
from drawbar.machine.stand_in.machine import BODIES
from drawbar.messages import Action
from drawbar.protocols.agopengps.steering import SteerCommand
from drawbar.protocols.sensor_board import sentence
from drawbar.signals import FixQuality

STRAIGHT, CURVE = 22.0, 27.0
"""arc lengths, m: on a straight of 60 m; in the first curve behind one of 15 m"""
YAW_RATE_NOISE = math.radians(0.3)
"""of a sensor that is right, standard deviation, rad/s"""


# Where


def straight(trial):
    trial.place = STRAIGHT


def curve(trial):
    trial.place = CURVE


def from_the_start(trial):
    trial.watched = 20.0


def for_long(trial):
    """Watch it from the first straight on; the path is longer."""
    trial.place, trial.watched, trial.interval = STRAIGHT, 1000.0, 0.1


# What receivers report


def receivers(trial, change, bodies=BODIES):
    """Let receivers report something else from the fault on; change(report, seconds since the fault)."""
    trial.begin = lambda: report_otherwise(trial.rehearsal.machine, change, bodies)


def shifted(report, trial, left):
    return moved(report, trial.rehearsal.machine, left)


def jump_of_10_cm(trial):
    receivers(trial, lambda report, since: shifted(report, trial, 0.10))


def jump_of_one_antenna(trial):
    receivers(trial, lambda report, since: shifted(report, trial, 1.0), ["tractor"])


def jump_of_both(trial):
    trial.device("fixes-jump")


def jump_of_5_m(trial):
    receivers(trial, lambda report, since: shifted(report, trial, 5.0))


def slow_drift(trial):
    receivers(trial, lambda report, since: shifted(report, trial, 0.05 * since))


def fast_drift(trial):
    receivers(trial, lambda report, since: shifted(report, trial, 0.3 * since))


def far_away(trial):
    receivers(trial, lambda report, since: replace(report, latitude=report.latitude + 1.0))


def one_frozen(trial):
    trial.begin = lambda: freeze(trial.rehearsal.machine, ["tractor"])


def both_frozen(trial):
    trial.device("fixes-frozen")


def no_fix(trial):
    quality(trial, FixQuality.NONE)


def no_fix_for_1_s(trial):
    receivers(trial, lambda report, since: replace(report, quality=FixQuality.NONE) if since < 1.0 else report)


def floating(trial):
    trial.device("fixes-float")


def quality(trial, quality):
    def begin():
        trial.rehearsal.machine.quality = dict.fromkeys(BODIES, quality)

    trial.begin = begin


def float_flips(trial):
    qualities = (FixQuality.FIXED, FixQuality.FLOAT)
    receivers(trial, lambda report, since: replace(report, quality=qualities[int(since / 0.6) % 2]))


def old_corrections(trial):
    receivers(trial, lambda report, since: replace(report, correction_age=30.0))


def speed_in_knots(trial):
    receivers(trial, lambda report, since: replace(report, speed=report.speed * 3600.0 / 1852.0))


def zero_deviation(trial):
    receivers(trial, lambda report, since: replace(report, sigma_east=0.0, sigma_north=0.0))


def antennas_swapped(trial):
    def begin():
        encoders = trial.rehearsal.machine.encoders
        last = {}

        def swapped(body, other):
            before = encoders[body]

            def encode(report):
                last[body] = report
                there = last.get(other, report)
                return before(replace(there, time=report.time))

            return encode

        one, two = BODIES
        encoders[one], encoders[two] = swapped(one, two), swapped(two, one)

    trial.begin = begin


def midnight(trial):
    """Let the receivers' clocks pass midnight two seconds or so behind the fault's place."""
    expected = 12.0 + trial.place / trial.configuration.speed
    encoders = trial.rehearsal.machine.encoders
    for body in BODIES:
        before = encoders[body]
        encoders[body] = lambda report, before=before: before(
            replace(report, time=report.time + timedelta(hours=18.0, seconds=-expected))
        )


# What happens to bytes on their way


RECEIVERS = ("tractor receiver", "trailer receiver")
BOARDS = ("tractor board", "trailer board")
SET_POINTS = ("tractor set point", "trailer set point")


def off(chance, start):
    return lambda now, data: []


def garbage(chance, start):
    return lambda now, data: [(0.0, chance.randbytes(len(data)))]


def delayed(by):
    return lambda chance, start: lambda now, data: [(by, data)]


def intermittent(share):
    return lambda chance, start: lambda now, data: [] if chance.random() < share else [(0.0, data)]


def duplicated(chance, start):
    return lambda now, data: [(0.0, data), (0.01, data)]


def reordered(chance, start):
    return lambda now, data: [(0.25 if chance.random() < 0.2 else 0.0, data)]


def bit_errors(share):
    def flip(data, chance):
        if chance.random() >= share:
            return data
        bit = chance.randrange(8 * len(data))
        spoilt = bytearray(data)
        spoilt[bit // 8] ^= 1 << bit % 8
        return bytes(spoilt)

    return lambda chance, start: lambda now, data: [(0.0, flip(data, chance))]


def silent_for(seconds):
    return lambda chance, start: lambda now, data: [] if now < start + seconds else [(0.0, data)]


def nan_positions(trial):
    trial.tap(RECEIVERS, lambda chance, start: lambda now, data: [(0.0, without_latitude(data))])


def without_latitude(data):
    """Return NMEA whose latitudes are the letters nan, with right checksums."""
    lines = []
    for line in data.split(b"\r\n"):
        body = line[1:].partition(b"*")[0].split(b",")
        if body[0].endswith(b"GGA"):
            body[2] = b"nan"
            text, total = b",".join(body), 0
            for byte in text:
                total ^= byte
            line = b"$" + text + f"*{total:02X}".encode()
        lines.append(line)
    return b"\r\n".join(lines)


def receivers_silent(trial):
    trial.device("receivers-silent")


def one_receiver_silent(trial):
    trial.device("receiver-silent")


def receivers_silent_for_1_s(trial):
    trial.tap(RECEIVERS, silent_for(1.0))


def receivers_silent_for_10_s(trial):
    trial.watched = 25.0
    trial.tap(RECEIVERS, silent_for(10.0))


def receivers_garbage(trial):
    trial.device("receivers-garbage")


def receivers_bit_errors(trial):
    trial.tap(RECEIVERS, bit_errors(0.2))


def receivers_lose_a_fifth(trial):
    trial.tap(RECEIVERS, intermittent(0.2))


def receivers_late(trial):
    trial.tap(RECEIVERS, delayed(0.4))


def receivers_duplicated(trial):
    trial.tap(RECEIVERS, duplicated)


def receivers_reordered(trial):
    trial.tap(RECEIVERS, reordered)


def board_silent(trial):
    trial.device("board-silent")


def boards_lose_a_fifth(trial):
    trial.tap(BOARDS, intermittent(0.2))


def boards_garbage(trial):
    trial.tap(BOARDS, garbage)


def board_bit_errors(trial):
    trial.tap(BOARDS, bit_errors(0.05))


def set_points_lost(trial):
    trial.tap(SET_POINTS[:1], off)


def set_points_lose_a_fifth(trial):
    trial.tap(SET_POINTS, intermittent(0.2))


def set_points_duplicated(trial):
    trial.tap(SET_POINTS, duplicated)


def set_points_late(trial):
    trial.tap(SET_POINTS, delayed(0.3))


def controller_bit_errors(trial):
    trial.tap(["controller"], bit_errors(0.05))


def controller_replayed(trial):
    trial.tap(["controller"], duplicated)


def controller_late(trial):
    trial.tap(["controller"], delayed(0.3))


def operator_garbage(trial):
    """Let everything for the desk be followed by a hundred datagrams of nonsense."""
    trial.tap(
        ["operator"],
        lambda chance, start: (
            lambda now, data: [
                (0.0, data),
                *((0.001 * i, chance.randbytes(chance.randrange(200))) for i in range(1, 100)),
            ]
        ),
    )


# Sensors


def sensed(trial, change):
    """Change what the sensor board says: change(counts of the hitch, pulses, seconds since the fault)."""

    def make(chance, start):
        def tap(now, data):
            milliseconds, counts, pulses = data[1:].partition(b"*")[0].split(b",")[1:]
            return [(0.0, sentence(int(milliseconds), *change(int(counts), int(pulses), now - start)))]

        return tap

    trial.tap(["sensors"], make)


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


def yaw_rate(trial, change):
    """Give the tractor a yaw-rate sensor that from the fault on says change(true yaw rate, rad/s, chance).

    It is put between sampler and controller: stand-ins have no such sensor, and no wire carries it.
    """
    controller, world = trial.rehearsal.loop._controller, trial.rehearsal.machine.world
    chance, feedback, seen, begun = random.Random(trial.seed), controller.feedback, [], []

    def measured(measurement, now):
        seen.append((trial.rehearsal.time, world.truth.tractor.yaw))
        (earlier, before), (later, yaw) = seen[0], seen[-1]
        del seen[:-1]
        true = wrap(yaw - before) / (later - earlier) if later > earlier else 0.0
        told = change(true, chance) if begun else true
        noisy = told + chance.gauss(0.0, YAW_RATE_NOISE)
        return feedback(replace(measurement, tractor_yaw_rate=noisy), now)

    controller.feedback = measured
    trial.begin = lambda: begun.append(True)


def yaw_rate_reversed(trial):
    yaw_rate(trial, lambda true, chance: -true)


def yaw_rate_stuck(trial):
    kept = []

    def change(true, chance):
        kept.append(true)
        return kept[0]

    yaw_rate(trial, change)


def yaw_rate_off_5(trial):
    yaw_rate(trial, lambda true, chance: true + math.radians(5.0))


def yaw_rate_noisy(trial):
    yaw_rate(trial, lambda true, chance: true + chance.gauss(0.0, math.radians(5.0)))


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


# Actuators


def actuator(trial, body, change):
    trial.begin = lambda: steer_otherwise(trial.rehearsal.machine, body, change)


def tractor_stuck(trial):
    trial.device("wheels-stuck")


def trailer_stuck(trial):
    actuator(trial, "trailer", lambda wanted, true: true)


def tractor_reversed(trial):
    actuator(trial, "tractor", lambda wanted, true: true - 4.0 * (wanted - true))


def tractor_off_3(trial):
    actuator(trial, "tractor", lambda wanted, true: wanted + math.radians(3.0))


def tractor_slow(trial):
    """Turn at 10°/s at most."""
    actuator(trial, "tractor", lambda wanted, true: true + clipped(wanted - true, 0.5 * math.radians(10.0) * 0.6))


def tractor_lags(trial):
    """Answer with a third of the speed."""
    actuator(trial, "tractor", lambda wanted, true: true + (wanted - true) / 3.0)


def clipped(value, limit):
    return min(max(value, -limit), limit)


def board_restarts(trial):
    def begin():
        trial.rehearsal.machine.boards["trailer"][0].restart(trial.rehearsal.time, outage=0.5)

    trial.begin = begin


def operator_takes_over(trial):
    def begin():
        trial.rehearsal.machine.boards["tractor"][0].override()

    trial.begin = begin


def other_master(trial):
    """Let another program steer the front wheels' board straight, ten times a second."""

    def begin():
        rehearsal, inner = trial.rehearsal, trial.rehearsal.post.taps.get("tractor set point")
        foreign = SteerCommand(steer=True, angle=0.0, speed=1.0).encode()
        wire = rehearsal.wires["tractor"]

        def tap(now, data):
            wire.arrive(now, foreign, "192.168.5.10:9999")
            return [*(inner(now, data) if inner else [(0.0, data)]), (0.01, foreign)]

        rehearsal.post.taps["tractor set point"] = tap

    trial.begin = begin


# Processes and people


def stopped(trial, part, seconds=math.inf):
    """Let a part stand still, for a time."""

    def begin():
        end, rehearsal = trial.rehearsal.time + seconds, trial.rehearsal
        rehearsal.stopped.add(part)
        before = rehearsal.machine.advance

        def advance(now):
            if now >= end:
                rehearsal.stopped.discard(part)
            return before(now)

        rehearsal.machine.advance = advance

    trial.begin = begin


def controller_ends(trial):
    trial.begin = trial.rehearsal.end_controller


def controller_freezes(trial):
    stopped(trial, Part.CONTROLLER)


def controller_freezes_for_1_s(trial):
    stopped(trial, Part.CONTROLLER, 1.0)


def controller_late_once(trial):
    stopped(trial, Part.CONTROLLER, 0.08)


def controller_late_for_long(trial):
    stopped(trial, Part.CONTROLLER, 0.2)


def controller_late_often(trial):
    """Let every other step begin 60 ms after its epoch."""
    until = [-math.inf, 0]
    before = trial.rehearsal.machine.advance

    def advance(now):
        if now < until[0]:
            trial.rehearsal.stopped.add(Part.CONTROLLER)
        else:
            trial.rehearsal.stopped.discard(Part.CONTROLLER)
        return before(now)

    def make(chance, start):
        trial.rehearsal.machine.advance = advance

        def hear(now, data):
            until[1] += 1
            if until[1] % 2:
                until[0] = now + 0.06
            return [(0.01, data)]

        return hear

    trial.tap(RECEIVERS[:1], make)


def receivers_freeze(trial):
    stopped(trial, Part.RECEIVERS)


def recorder_gone(trial):
    stopped(trial, Part.RECORDER)


def gate_gone(trial):
    stopped(trial, Part.GATE)


def gate_freezes_for_1_s(trial):
    stopped(trial, Part.GATE, 1.0)


def suspended(trial):
    def begin():
        trial.rehearsal.gate._suspended_before -= 2.0

    trial.begin = begin


def operator_gone(trial):
    stopped(trial, Part.OPERATOR)


def operator_stops(trial):
    trial.begin = lambda: trial.rehearsal.ask(Action.STOP)


def emergency(trial):
    trial.begin = lambda: trial.rehearsal.ask(Action.EMERGENCY)


def driver_ignores_the_stop(trial):
    def begin():
        trial.rehearsal.machine.driver.REACTION = 1e9
        trial.rehearsal.ask(Action.STOP)

    trial.begin = begin


# Before engaging


def does_not_creep(trial):
    trial.rehearsal.machine.driver.CREEP = 0.0
