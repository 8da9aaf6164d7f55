"""`drawbar check` of a receiver and of a bare valve: what they say, as somebody at the machine reads it."""

import datetime

import pytest

from drawbar.driving import check
from drawbar.driving.memory import MemoryTransport
from drawbar.geometry import LocalFrame
from drawbar.machine.hardware.bare_valve_settings import BareValveSettings
from drawbar.machine.hardware.receiver import ReceiverSettings
from drawbar.machine.stand_in import nmea
from drawbar.machine.stand_in.machine import HITCH_ANGLES, HITCH_COUNTS
from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.own_sentence import own_sentence

BEGIN = datetime.datetime(2026, 11, 22, 12, tzinfo=datetime.UTC)


def facts_of(monkeypatch, **changes):
    """Return what is told of a receiver that turns to the left by 3 °/s."""
    line = MemoryTransport()
    for step in range(5):
        time = BEGIN + datetime.timedelta(seconds=0.2 * step)
        told = Report(time=time, latitude=50.0, longitude=4.0, height=0.0, **{k: v(step) for k, v in changes.items()})
        line.arrive(10.0 + 0.2 * step, nmea.gga(told) + nmea.panda(told))
    monkeypatch.setattr(check, "open_transport", lambda _: line)
    monkeypatch.setattr(check, "looks", lambda _: iter([10.0, 11.0]))
    settings, frame = ReceiverSettings(transport="file:memory"), LocalFrame(latitude=50.0, longitude=4.0)
    return check._receiver("tractor receiver", settings, frame, 1.0, None).facts


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_roll_and_yaw_rate_are_told_in_degrees(monkeypatch, side):
    yaw, roll, level = (lambda step: side * 0.0104720 * step), (lambda _: side * 0.04), (lambda _: 0.0)
    facts = facts_of(monkeypatch, inertial_yaw=yaw, roll=roll, pitch=level)
    assert f"roll {side * 2.3:.1f}°" in facts
    assert f"yaw rate {side * 3.0:.1f}°/s" in facts


def test_what_is_not_measured_is_not_told(monkeypatch):
    assert not any("roll" in fact or "yaw" in fact for fact in facts_of(monkeypatch))


@pytest.mark.parametrize(
    ("sentence", "facts", "problems"),
    [
        (own_sentence("PDBV", 1, 2448, 1), ["angle 14.3°", "switch held"], 0),
        (own_sentence("PDBV", 1, 2048, 0), ["angle 0.0°", "switch let go"], 0),
        (own_sentence("PDBV", 1, 9999, 0), ["angle nan°", "switch let go"], 1),
        (b"$PDBV,1,2048,1*00\r\n", [], 1),
    ],
)
def test_a_bare_valves_board_is_listened_to_and_told_nothing(monkeypatch, sentence, facts, problems):
    line = MemoryTransport()
    line.arrive(10.0, sentence)
    monkeypatch.setattr(check, "open_transport", lambda _: line)
    monkeypatch.setattr(check, "looks", lambda _: iter([10.0]))
    monkeypatch.setattr(line, "write", lambda data: pytest.fail("it was told something"))
    settings = BareValveSettings(transport="file:memory", counts=HITCH_COUNTS, angles=HITCH_ANGLES)
    finding = check._bare_valve(settings, 1.0)
    assert (finding.facts, len(finding.problems)) == (facts, problems)
