import math
from dataclasses import replace

import pytest

from drawbar.autopilot.gate import CommandGate
from drawbar.signals import Command

FIELDS = {"tractor_steering": 0.5, "trailer_steering": 0.3, "speed": 2.0}
GOOD = Command(time=1.0, tractor_steering=0.1, trailer_steering=-0.2, speed=1.5)


@pytest.fixture
def gate():
    return CommandGate(tractor_limit=0.5, trailer_limit=0.3, speed_limit=2.0)


def test_what_is_within_the_limits_passes_as_it_is(gate):
    limit = Command(time=2.0, tractor_steering=-0.5, trailer_steering=0.3, speed=-2.0)
    for command in (GOOD, limit, replace(GOOD, speed=0.0)):
        assert gate.check(command) is command


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, 1.0000001, -1.0000001])
def test_what_is_not_is_replaced_by_the_last_that_was(gate, field, wrong):
    gate.check(GOOD)
    bad = replace(GOOD, time=7.0, **{field: wrong * FIELDS[field]})
    assert gate.check(bad) == replace(GOOD, time=7.0)
    assert gate.check(bad) == replace(GOOD, time=7.0)
    better = replace(GOOD, time=8.0, tractor_steering=-0.1)
    assert gate.check(better) is better


def test_before_any_command_the_machine_is_told_to_stand(gate):
    stand = Command(time=3.0, tractor_steering=0.0, trailer_steering=0.0, speed=0.0)
    assert gate.check(replace(GOOD, time=3.0, speed=math.nan)) == stand
