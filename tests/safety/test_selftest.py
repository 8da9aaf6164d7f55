"""The gate's test of its own limits at the start."""

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


def test_records_that_are_not_checked_fail_the_selftest(monkeypatch):
    monkeypatch.setattr(selftest, "decode", lambda *given: None)
    assert not limits_hold(SETTINGS, BOUNDS)
