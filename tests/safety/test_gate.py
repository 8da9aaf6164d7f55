"""What the gate lets pass, what it brings nearer, what it repeats and when it stops the vehicle."""

import math
from dataclasses import replace

import numpy as np
import pytest
from ordinary import measured
from safeguards import CommandGate
from scipy.integrate import solve_ivp

from drawbar.safety.gate import PATIENCE
from drawbar.signals import Command, GateVerdict
from drawbar.vehicle.parameters import VehicleParameters

SAMPLE = 0.2
REPEATS = 4
"""Samples after its own for which a command acts: a second in all"""
VEHICLE = VehicleParameters(
    tractor_steering_limit=0.5,
    trailer_steering_limit=0.3,
    tractor_steering_rate=0.4,
    trailer_steering_rate=0.2,
    steering_lag=0.3,
)
RATES = {"tractor_steering": 0.4, "trailer_steering": 0.2}
CHANGES = {field: rate * 0.8 for field, rate in RATES.items()}
"""Largest changes at once: rate times twice the lag and a sample, rad"""
LIMITS = {"tractor_steering": 0.5, "trailer_steering": 0.3, "speed": 2.0}
GOOD = Command(time=1.0, tractor_steering=0.1, trailer_steering=-0.2, speed=1.5)
PASSED, LIMITED, REPEATED, STOPPED = GateVerdict
SETTLING = 0.5
"""time constant of the average that a stop holds, s"""


def standing(tractor, trailer, vehicle=VEHICLE):
    """Return a gate in front of a vehicle that stands with its wheels so."""
    first = measured(time=0.5, tractor_steering=tractor, trailer_steering=trailer)
    return CommandGate(vehicle, first, speed_limit=2.0, sample_time=SAMPLE)


@pytest.fixture
def gate():
    return standing(0.05, -0.15)


def stopped(times, acted):
    """Return the stops at these times after commands that each acted for a sample since the fixture began."""
    held = {}
    for field, average in (("tractor_steering", 0.05), ("trailer_steering", -0.15)):
        for command in acted:
            average += (1.0 - math.exp(-SAMPLE / SETTLING)) * (getattr(command, field) - average)
        held[field] = pytest.approx(average, abs=1e-15)
    return [(Command(time=time, speed=0.0, **held), STOPPED) for time in times]


def test_what_is_within_the_limits_passes_as_it_is(gate):
    limit = Command(time=2.0, tractor_steering=-0.1, trailer_steering=-0.25, speed=-2.0)
    for command in (GOOD, limit, replace(GOOD, speed=0.0)):
        assert gate.check(command) == (command, PASSED)


@pytest.mark.parametrize("field", LIMITS)
@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, 1.0000001, -1.0000001])
def test_what_is_not_is_replaced_by_the_last_that_was(gate, field, wrong):
    gate.check(GOOD)
    for time in (1.2, 1.4):
        bad = replace(GOOD, time=time, **{field: wrong * LIMITS[field]})
        assert gate.check(bad) == (replace(GOOD, time=time), REPEATED)
    better = replace(GOOD, time=1.6, tractor_steering=-0.1)
    assert gate.check(better) == (better, PASSED)


def test_before_any_command_the_machine_is_told_to_stand(gate):
    times = [0.5 + SAMPLE * k for k in range(1, REPEATS + 2)]
    answers = [gate.check(replace(GOOD, time=time, speed=math.nan)) for time in times]
    stand = Command(time=0.0, tractor_steering=0.05, trailer_steering=-0.15, speed=0.0)  # with its wheels as they are
    verdicts = [REPEATED] * REPEATS + [STOPPED]
    assert answers == [(replace(stand, time=time), verdict) for time, verdict in zip(times, verdicts, strict=True)]


@pytest.mark.parametrize(
    ("measured", "sign", "known"),
    [((0.1, 0.2), -1, (0.1, -0.2)), ((math.nan, math.inf), 1, (0.0, 0.0)), ((0.7, -9.0), 1, (0.5, -0.3))],
)
def test_the_first_command_goes_from_where_the_wheels_are(measured, sign, known):
    gate = standing(*measured, VEHICLE.model_copy(update={"joint_sign": sign}))
    wanted = Command(time=3.0, tractor_steering=-0.5, trailer_steering=0.3, speed=1.0)
    given, _ = gate.check(wanted)
    assert given.tractor_steering == pytest.approx(max(-0.5, known[0] - 0.2))
    assert given.trailer_steering == pytest.approx(min(0.3, known[1] + 0.1))


def test_a_command_is_repeated_for_a_while_then_the_vehicle_stops_with_its_steering_held(gate):
    gate.check(GOOD)
    bad = replace(GOOD, tractor_steering=math.nan)
    assert (REPEATS + 1) * SAMPLE == PATIENCE
    acted = []
    for _ in range(2):  # a command that passes between starts the count anew
        assert [gate.check(bad)[1] for _ in range(REPEATS)] == [REPEATED] * REPEATS
        acted += [GOOD] * (1 + REPEATS)
        assert [gate.check(replace(bad, time=9.0))] == stopped([9.0], acted)
        assert gate.check(replace(bad, time=math.nan))[0].speed == 0.0
        acted += [gate.stop(9.2)[0]] * 2
        assert gate.check(GOOD) == (GOOD, PASSED)


@pytest.mark.parametrize(("step", "repeats"), [(0.21, 4), (0.29, 3), (0.32, 2), (0.6, 1), (0.95, 0)])
def test_repeats_end_by_the_clock_as_well_as_by_their_number(gate, step, repeats):
    acted = []
    for _ in range(2):  # a command that passes between starts the clock anew
        gate.check(GOOD)
        later = [GOOD.time + step * k for k in range(1, 7)]
        answers = [gate.check(replace(GOOD, time=time, speed=math.nan)) for time in later]
        assert answers[:repeats] == [(replace(GOOD, time=time), REPEATED) for time in later[:repeats]]
        acted += [GOOD] * (1 + repeats)
        assert answers[repeats:] == stopped(later[repeats:], acted)
        acted += [command for command, _ in answers[repeats:]]


def test_a_sample_without_any_command_is_one_with_a_bad_one(gate):
    gate.check(GOOD)
    assert [gate.hold(1.0 + SAMPLE * k)[1] for k in range(1, REPEATS + 2)] == [REPEATED] * REPEATS + [STOPPED]
    gate.check(GOOD)
    assert gate.hold(1.6) == (replace(GOOD, time=1.6), REPEATED)
    assert gate.hold(2.2)[1] is STOPPED


@pytest.mark.parametrize("time", [math.nan, math.inf])
def test_a_time_that_is_none_repeats_nothing(gate, time):
    gate.check(GOOD)
    assert gate.hold(time)[1] is STOPPED


def test_a_stop_lasts_until_a_command_passes(gate):
    gate.check(GOOD)
    assert [gate.stop(time) for time in (1.2, 1.4)] == stopped([1.2, 1.4], [GOOD])
    assert gate.hold(1.6)[1] is STOPPED
    assert gate.check(replace(GOOD, time=1.8)) == (replace(GOOD, time=1.8), PASSED)


def test_a_stop_holds_what_the_commands_were_on_average_not_the_noise_of_the_last(gate):
    noise = np.random.default_rng(3).normal(0.0, 0.02, 200).tolist()
    wanted = [replace(GOOD, time=0.2 * i, tractor_steering=0.1 + each) for i, each in enumerate(noise)]
    assert [gate.check(each) for each in wanted] == [(each, PASSED) for each in wanted]
    assert [gate.stop(40.0)] == stopped([40.0], wanted)


def test_a_stop_moves_the_steering_no_further_than_an_actuator_can_tell():
    quick = VEHICLE.model_copy(update={"steering_lag": 0.05})
    gate = standing(0.4, 0.0, quick)
    for i in range(10):  # the wheels turn as fast as they can, and the average comes after
        given, _ = gate.check(Command(time=0.2 * i, tractor_steering=-0.5, trailer_steering=0.0, speed=1.0))
    held, _ = gate.stop(2.0)
    most = RATES["tractor_steering"] * (2.0 * quick.steering_lag + SAMPLE)
    assert 0.5 * most < held.tractor_steering - given.tractor_steering <= most
    assert gate.stop(2.2)[0].tractor_steering == held.tractor_steering


def test_a_wrong_call_is_told_to_stand_and_changes_nothing(gate):
    gate.check(GOOD)
    for _ in range(REPEATS + 1):
        assert gate.stand(1.1) == (replace(GOOD, time=1.1, speed=0.0), STOPPED)
    assert gate.hold(1.2) == (replace(GOOD, time=1.2), REPEATED)


def test_before_a_run_there_is_nothing_to_repeat():
    gate = CommandGate(VEHICLE, None, speed_limit=2.0, sample_time=SAMPLE)
    nothing = Command(time=0.1, tractor_steering=0.0, trailer_steering=0.0, speed=0.0)
    assert gate.hold(0.1) == (nothing, STOPPED)


def test_in_a_sample_that_was_left_out_the_last_command_acts_and_no_repeat_is_counted(gate):
    gate.check(GOOD)
    assert [gate.skip() for _ in range(REPEATS + 1)] == [GOOD] * (REPEATS + 1)
    assert gate.hold(1.8) == (replace(GOOD, time=1.8), REPEATED)


@pytest.mark.parametrize("field", CHANGES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_command_beyond_what_an_actuator_can_tell_leads_it_no_further_than_that(field, sign):
    limit, rate = LIMITS[field], RATES[field]
    start, end = (replace(GOOD, **{field: side * sign * limit}) for side in (-1.0, 1.0))
    gate = standing(start.tractor_steering, start.trailer_steering)
    gate.check(start)
    seen, verdicts = [], []
    while not verdicts or verdicts[-1] is LIMITED:
        given, verdict = gate.check(end)
        assert replace(given, **{field: 0.0}) == replace(end, **{field: 0.0})
        seen.append(sign * getattr(given, field))
        verdicts.append(verdict)
    assert seen[0] == pytest.approx(-limit + rate * (VEHICLE.steering_lag + SAMPLE))
    assert np.diff(seen[:-1]) == pytest.approx(rate * SAMPLE)  # the wheels go at their rate
    assert seen[-1] == limit
    assert verdicts == [LIMITED] * (len(seen) - 1) + [PASSED]


@pytest.mark.parametrize(
    "pass_by",
    [lambda gate: gate.check(replace(GOOD, tractor_steering=math.nan)), CommandGate.skip],
    ids=["bad", "skip"],
)
def test_the_wheels_go_on_while_a_command_is_repeated_or_a_sample_left_out(pass_by):
    gate = standing(-0.5, -0.2)
    gate.check(replace(GOOD, tractor_steering=-0.5))
    first, _ = gate.check(replace(GOOD, tractor_steering=0.5))
    pass_by(gate)
    second, verdict = gate.check(replace(GOOD, tractor_steering=0.5))
    wheels = angle_after(angle_after(-0.5, first.tractor_steering), first.tractor_steering)
    assert verdict is LIMITED
    assert second.tractor_steering == pytest.approx(wheels + 0.4 * (VEHICLE.steering_lag + SAMPLE), abs=1e-8)


def angle_after(angle, command):
    """Return where the tractor's steering is after a sample, rad: a lag within a rate, finely integrated."""

    def rate(_, z):
        return np.clip((command - z) / VEHICLE.steering_lag, -VEHICLE.tractor_steering_rate, 0.4)

    return solve_ivp(rate, (0.0, SAMPLE), [angle], rtol=1e-10, atol=1e-12, max_step=0.01).y[0, -1]


def test_no_actuator_moves_differently_for_being_limited(gate):
    rng = np.random.default_rng(1)
    wanted = np.repeat(rng.uniform(-0.5, 0.5, 40), rng.integers(1, 5, 40)).tolist()
    free = limited = 0.05
    verdicts = []
    for value in wanted:
        given, verdict = gate.check(replace(GOOD, tractor_steering=value))
        free, limited = angle_after(free, value), angle_after(limited, given.tractor_steering)
        assert limited == pytest.approx(free, abs=1e-7)
        verdicts.append(verdict)
    assert 10 < verdicts.count(LIMITED) < len(wanted) - 10


def test_random_commands_never_break_a_limit(gate):
    rng = np.random.default_rng(3)
    last = Command(time=0.0, tractor_steering=0.05, trailer_steering=-0.15, speed=0.0)
    for time in range(3000):
        values = rng.uniform(-1.2, 1.2, 3) * list(LIMITS.values())
        values[rng.random(3) < 0.1] = rng.choice([np.nan, np.inf, -np.inf, 1e300])
        given, _ = gate.check(Command(time=time, **dict(zip(LIMITS, values.tolist(), strict=True))))
        for field, limit in LIMITS.items():
            assert abs(getattr(given, field)) <= limit
        for field, change in CHANGES.items():
            assert abs(getattr(given, field) - getattr(last, field)) <= change + 1e-12
        last = given
