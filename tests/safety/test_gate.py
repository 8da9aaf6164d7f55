"""What the gate lets pass, what it brings nearer, what it repeats and when it stops the vehicle."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drawbar.safety.gate import PATIENCE, CommandGate
from drawbar.signals import Command, GateVerdict, Measurement
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


def standing(tractor, trailer, vehicle=VEHICLE):
    """Return a gate in front of a vehicle that stands with its wheels so."""
    first = Measurement(
        time=0.5,
        tractor_x=0.0,
        tractor_y=0.0,
        trailer_x=-2.0,
        trailer_y=0.0,
        hitch_angle=0.0,
        speed=0.0,
        tractor_steering=tractor,
        trailer_steering=trailer,
    )
    return CommandGate(vehicle, first, speed_limit=2.0, sample_time=SAMPLE)


@pytest.fixture
def gate():
    return standing(0.05, -0.15)


def test_what_is_within_the_limits_passes_as_it_is(gate):
    limit = Command(time=2.0, tractor_steering=-0.1, trailer_steering=-0.25, speed=-2.0)
    for command in (GOOD, limit, replace(GOOD, speed=0.0)):
        assert gate.check(command) == (command, PASSED)


@pytest.mark.parametrize("field", LIMITS)
@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, 1.0000001, -1.0000001])
def test_what_is_not_is_replaced_by_the_last_that_was(gate, field, wrong):
    gate.check(GOOD)
    bad = replace(GOOD, time=7.0, **{field: wrong * LIMITS[field]})
    assert gate.check(bad) == (replace(GOOD, time=7.0), REPEATED)
    assert gate.check(bad) == (replace(GOOD, time=7.0), REPEATED)
    better = replace(GOOD, time=8.0, tractor_steering=-0.1)
    assert gate.check(better) == (better, PASSED)


def test_before_any_command_the_machine_is_told_to_stand(gate):
    stand = Command(time=3.0, tractor_steering=0.05, trailer_steering=-0.15, speed=0.0)  # with its wheels as they are
    answers = [gate.check(replace(GOOD, time=3.0, speed=math.nan)) for _ in range(REPEATS + 1)]
    assert answers == [(stand, REPEATED)] * REPEATS + [(stand, STOPPED)]


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
    for _ in range(2):  # a command that passes between starts the count anew
        assert [gate.check(bad)[1] for _ in range(REPEATS)] == [REPEATED] * REPEATS
        assert gate.check(replace(bad, time=9.0)) == (replace(GOOD, time=9.0, speed=0.0), STOPPED)
        assert gate.check(replace(bad, time=math.nan))[0].speed == 0.0
        assert gate.check(GOOD) == (GOOD, PASSED)


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


def test_the_wheels_go_on_while_a_command_is_repeated():
    gate = standing(-0.5, -0.2)
    gate.check(replace(GOOD, tractor_steering=-0.5))
    first, _ = gate.check(replace(GOOD, tractor_steering=0.5))
    gate.check(replace(GOOD, tractor_steering=math.nan))
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
