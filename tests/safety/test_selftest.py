"""The gate's test of its own limits at the start."""

import math
from dataclasses import replace

import pytest
from gate_bench import BOUNDS

from drawbar.safety import envelope, selftest
from drawbar.safety.envelope import Envelope
from drawbar.safety.selftest import limits_hold
from drawbar.safety.settings import EnvelopeSettings, SafetySettings

SETTINGS = SafetySettings()


def test_limits_that_limit_pass_the_selftest():
    assert limits_hold(SETTINGS, BOUNDS)
    assert limits_hold(SETTINGS, replace(BOUNDS, tractor_limit=0.1, trailer_limit=0.1))


@pytest.mark.parametrize(
    ("method", "result"),
    [("admit", lambda self, *a: True), ("admit", lambda self, *a: False), ("angle_cap", lambda self, v: 9.0)],
)
def test_limits_that_do_not_limit_fail_the_selftest(monkeypatch, method, result):
    monkeypatch.setattr(Envelope, method, result)
    loose = SafetySettings(envelope=EnvelopeSettings(steering_reach=3.1, steering_rate=3.1, lateral_jerk=1e3))
    assert not limits_hold(loose, BOUNDS)


@pytest.mark.parametrize("name", ["_clamped", "_towards"])
def test_a_limit_that_lets_everything_through_fails_the_selftest(monkeypatch, name):
    monkeypatch.setattr(envelope, name, lambda *given: given[1] if len(given) == 3 else given[0])
    assert not limits_hold(SETTINGS, BOUNDS)


@pytest.mark.parametrize("time", [math.inf, -math.inf])
def test_an_envelope_that_obeys_what_has_expired_or_is_of_the_future_fails_the_selftest(monkeypatch, time):
    admit = Envelope.admit
    monkeypatch.setattr(Envelope, "admit", lambda self, command, now: now == time or admit(self, command, now))
    assert not limits_hold(SETTINGS, BOUNDS)


@pytest.mark.parametrize("body", [0, 1])
def test_an_envelope_that_lets_no_command_through_fails_the_selftest(monkeypatch, body):
    limit = Envelope.limit

    def limits(self, command, measured, speed):
        limited = limit(self, command, measured, speed)
        return replace(limited, angles=tuple(0.0 if body == each else limited.angles[each] for each in (0, 1)))

    monkeypatch.setattr(Envelope, "limit", limits)
    assert not limits_hold(SETTINGS, BOUNDS)


def test_records_that_are_not_checked_fail_the_selftest(monkeypatch):
    monkeypatch.setattr(selftest, "decode", lambda *given: None)
    assert not limits_hold(SETTINGS, BOUNDS)
