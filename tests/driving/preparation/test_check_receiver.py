"""`drawbar check` of a receiver and of a bare valve: what they say, as somebody at the machine reads it."""

import dataclasses
import datetime
import math
import re
import socket

import numpy as np
import pytest
from isobus_devices import isobus_devices
from pyubx2 import GET, POLL, UBXMessage
from receiver_frames import nmea, sbf, ubx

from drawbar.driving.preparation import check, check_receiver
from drawbar.driving.preparation import finding as finding_module
from drawbar.driving.preparation.finding import Finding
from drawbar.driving.stand_in.memory_transports import MemoryTransport
from drawbar.geometry import LocalFrame
from drawbar.machine.hardware.bare_valve_settings import BareValveSettings
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.receiver import ReceiverSettings
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.machine.stand_in.machine import HITCH_ANGLES, HITCH_COUNTS
from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.own_sentence import own_sentence
from drawbar.signals import FixQuality

BEGIN = datetime.datetime(2026, 11, 22, 12, tzinfo=datetime.UTC)


def finding_of(monkeypatch, told, rate=5.0, sample_time=0.2, write=None, alone=False):
    """Return what is found of a receiver that sends so many bytes, by the number of the epoch."""
    line = MemoryTransport()
    for step in range(5):
        line.arrive(10.0 + step / rate, told(step, BEGIN + datetime.timedelta(seconds=step / rate)))
    monkeypatch.setattr(line, "write", write or (lambda data: pytest.fail("it was told something")))
    monkeypatch.setattr(check_receiver, "open_transport", lambda _: line)
    monkeypatch.setattr(check_receiver, "poll_times", lambda *_: iter([10.0, 11.0, 12.0]))
    settings, frame = ReceiverSettings(transport="file:memory"), LocalFrame(latitude=50.0, longitude=4.0)
    return check_receiver.check_receiver(
        "tractor receiver", settings, frame, 1.0, sample_time, None, oldest=5.0, alone=alone
    )


def facts_of(monkeypatch, **changes):
    """Return what is told of a receiver of AgOpenGPS that turns to the left by 3 °/s."""

    def told(step, time):
        report = Report(time=time, latitude=50.0, longitude=4.0, height=0.0, **{k: v(step) for k, v in changes.items()})
        return nmea.gga(report) + nmea.panda(report)

    return finding_of(monkeypatch, told).facts


def test_bytes_are_read_when_they_come(monkeypatch):
    # an epoch whose messages are read 20 ms after each other would be two
    waited = []
    monkeypatch.setattr(finding_module.select, "select", lambda read, *_: waited.append(read))
    line, other = socket.socketpair()
    with line, other:
        times = finding_module.poll_times(60.0, line, MemoryTransport())
        assert next(times) <= next(times)
        assert waited == [[line.fileno()]]


def test_what_came_while_the_computer_was_busy_is_looked_at_after_the_end(monkeypatch):
    now = [100.0]

    def late(*_):
        now[0] += 3.0  # much longer than it was to wait, and than is listened to

    monkeypatch.setattr(finding_module.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(finding_module.select, "select", late)
    assert list(finding_module.poll_times(1.0)) == [100.0, 103.0]


def report_at(time):
    return Report(
        time=time, latitude=50.0, longitude=4.0, height=0.0, quality=FixQuality.FIXED, speed=0.0, correction_age=1.0
    )


def test_bytes_of_another_baud_rate_are_distinguished_from_silence(monkeypatch):
    noise = np.random.default_rng(0).integers(128, 256, 200, dtype=np.uint8).tobytes()
    (problem,) = finding_of(monkeypatch, lambda step, time: noise).problems
    assert problem.startswith("something comes, but nothing that is understood (")
    assert "noise bytes): check the baud rate, the sender" in problem
    (problem,) = finding_of(monkeypatch, lambda step, time: b"").problems
    assert problem == "nothing was received: check its power, its cable and its transport"


@pytest.mark.parametrize(("yaw", "alone", "missing"), [(0.5, True, 0), (math.nan, True, 1), (math.nan, False, 0)])
def test_the_only_receiver_has_to_tell_a_heading(monkeypatch, yaw, alone, missing):
    def told(step, time):
        return b"".join(nmea.sentences(dataclasses.replace(report_at(time), yaw=yaw)))

    finding = finding_of(monkeypatch, told, alone=alone)
    assert sum("it tells no heading" in problem for problem in finding.problems) == missing
    assert (f"heading {90.0 - math.degrees(0.5):.1f}°" in finding.facts) == math.isfinite(yaw)


def test_the_age_of_corrections_is_reported(monkeypatch):
    finding = finding_of(monkeypatch, lambda step, time: b"".join(nmea.sentences(report_at(time))))
    assert "corrections 1 s old" in finding.facts
    assert finding.problems == []


@pytest.mark.parametrize(("age", "told"), [(4.9, ""), (5.1, "5 s old"), (24.0, "24 s old")])
def test_corrections_too_old_to_engage_with_are_reported(monkeypatch, age, told):
    finding = finding_of(
        monkeypatch,
        lambda step, time: b"".join(nmea.sentences(dataclasses.replace(report_at(time), correction_age=age))),
    )
    missing = f"its corrections are {told}, and drawbar engages up to 5 s: check modem, caster and mount point"
    assert finding.problems == ([missing] if told else [])


def test_corrections_of_2_to_5_s_of_a_u_blox_receiver_are_not_too_old(monkeypatch):
    # it says no more than this class of the age
    told = lambda step, time: b"".join(ubx.frames(dataclasses.replace(report_at(time), correction_age=4.0)))  # noqa: E731
    finding = finding_of(monkeypatch, told, write=lambda data: True)
    assert "corrections 4 s old" in finding.facts
    assert finding.problems == []


@pytest.mark.parametrize(("decimals", "enough"), [(7, True), (6, True), (5, False), (4, False)])
def test_positions_with_too_few_decimals_are_reported(monkeypatch, decimals, enough):
    def told(step, time):
        cut = re.sub(r"(\d{4,5}\.)(\d{7,8}),([NE])", lambda m: f"{m[1]}{m[2][:decimals]},{m[3]}", sentences(time))
        return b"".join(nmea.sentence(line[1:].split("*")[0]) for line in cut.split())

    def sentences(time):
        return b"".join(nmea.sentences(report_at(time))).decode()

    problems = finding_of(monkeypatch, told).problems
    assert (problems == []) is enough
    assert enough or problems[-1].startswith("positions come in steps of 0.")


@pytest.mark.parametrize(
    ("rate", "sample_time", "enough"), [(5, 0.2, True), (4, 0.2, False), (10, 0.2, True), (5, 0.1, False)]
)
def test_a_receiver_that_is_slower_than_the_controller_is_reported(monkeypatch, rate, sample_time, enough):
    told = lambda step, time: b"".join(nmea.sentences(report_at(time)))  # noqa: E731
    finding = finding_of(monkeypatch, told, rate, sample_time)
    needed = f"{1.0 / sample_time:g}"
    problem = f"it sends {rate}.0 epochs a second, the controller takes {needed}: set it to {needed} Hz"
    assert finding.problems == ([] if enough else [problem])


@pytest.mark.parametrize(("apart", "told"), [(18.0, "+18.0 s"), (-2.0, "-2.0 s"), (0.4, ""), (-86399.9, "")])
def test_receivers_that_differ_about_the_time_are_reported(monkeypatch, apart, told):
    lines = []

    def line(_):
        ahead = datetime.timedelta(seconds=apart * len(lines))
        lines.append(MemoryTransport())
        for step in range(5):
            report = report_at(BEGIN + datetime.timedelta(seconds=0.2 * step) + ahead)
            lines[-1].arrive(10.0 + 0.2 * step, b"".join(nmea.sentences(report)))
        return lines[-1]

    monkeypatch.setattr(check_receiver, "open_transport", line)
    monkeypatch.setattr(check_receiver, "poll_times", lambda *_: iter([10.0, 11.0, 12.0]))
    findings = list(
        check.check(isobus_devices(gnss="file:memory"), LocalFrame(latitude=50.0, longitude=4.0), 0.1, 0.2, oldest=5.0)
    )
    problems = [problem for finding in findings[:2] for problem in finding.problems]
    assert (f"its time is {told} from" in "".join(problems)) is bool(told), problems


def mon_ver(*extensions):
    """Return u-blox's answer; the interface description's layout."""
    payload = b"EXT CORE 1.00 (61b2dd)".ljust(30, b"\0") + b"00190000".ljust(10, b"\0")
    payload += b"".join(text.ljust(30, b"\0") for text in extensions)
    return UBXMessage("MON", "MON-VER", GET, payload=payload).serialize()


BOARD = SteerBoardSettings(address="127.0.0.2:1", listen="127.0.0.1:9", max_angle=0.5)
FORWARD = "udp://0.0.0.0:0?peer={}:2233"


@pytest.mark.parametrize(
    ("quality", "sender", "forward", "told"),
    [
        (FixQuality.FLOAT, "192.168.5.126", (), 1),
        (FixQuality.FLOAT, "192.168.5.126", (FORWARD.format("192.168.6.126"),), 1),
        (FixQuality.FLOAT, "", ("tcp://192.168.5.126:9",), 1),
        (FixQuality.FLOAT, "192.168.5.126", (FORWARD.format("192.168.5.126"),), 0),
        (FixQuality.FLOAT, "192.168.5.126", (FORWARD.format("192.168.5.255") + "&broadcast=1",), 0),
        (FixQuality.FLOAT, "", (FORWARD.format("192.168.5.126"),), 0),
        (FixQuality.FIXED, "192.168.5.126", (), 0),  # it has corrections from elsewhere
    ],
)
def test_a_receiver_on_a_board_that_is_sent_no_corrections_is_reported(monkeypatch, quality, sender, forward, told):
    devices = DeviceSettings(
        tractor_receiver=ReceiverSettings(transport="udp://127.0.0.1:9", sender=sender),
        trailer_receiver=ReceiverSettings(transport="file:memory"),
        tractor_board=BOARD,
        trailer_board=BOARD.model_copy(update={"address": "127.0.0.3:1"}),
        corrections=CorrectionsSettings(host="127.0.0.1", mount="VRS", forward=forward),
    )
    fixed = quality is FixQuality.FIXED
    monkeypatch.setattr(
        check, "check_receiver", lambda name, *_, **__: Finding(device=name, received=True, fixed=fixed)
    )
    tractor, trailer = list(check.check(devices, devices.origin.frame(), 0.01, 0.2, oldest=5.0))[:2]
    assert len(tractor.problems) == told
    assert all(f"{sender or 'ADDRESS'}:2233" in problem for problem in tractor.problems)
    assert not trailer.problems, "it takes corrections over its own line"


@pytest.mark.parametrize(
    ("answer", "version"),
    [
        (mon_ver(b"ROM BASE 0x118B2060", b"FWVER=HPG 1.32", b"PROTVER=27.31", b"MOD=ZED-F9P"), "ZED-F9P, HPG 1.32"),
        (mon_ver(), "EXT CORE 1.00 (61b2dd)"),
    ],
)
def test_a_u_blox_receiver_is_asked_for_its_version_once(monkeypatch, answer, version):
    asked = []
    finding = finding_of(
        monkeypatch,
        lambda step, time: b"".join(ubx.frames(report_at(time))) + answer * (step == 4),
        write=lambda data: asked.append(data) is None,
    )
    assert finding.facts[0] == version
    assert asked == [UBXMessage("MON", "MON-VER", POLL).serialize()]


def test_what_septentrios_receiver_setup_says_is_reported(monkeypatch):
    body = bytes(2 + 60 + 20 + 20 + 40) + b"".join(text.ljust(20, b"\0") for text in (b"mosaic-X5", b"4.14.0"))
    body += bytes(20 + 20 + 12 + 20 + 40 + 40 + 20 + 10 + 1 + 1 + 3 + 21)
    block = sbf.block(5902, 4, report_at(BEGIN), body)
    finding = finding_of(monkeypatch, lambda step, time: b"".join(sbf.blocks(report_at(time))) + block)
    assert finding.facts[0] == "mosaic-X5, 4.14.0"


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_roll_and_yaw_rate_are_reported_in_degrees(monkeypatch, side):
    yaw, roll, level = (lambda step: side * 0.0104720 * step), (lambda _: side * 0.04), (lambda _: 0.0)
    facts = facts_of(monkeypatch, inertial_yaw=yaw, roll=roll, pitch=level)
    assert f"roll {side * 2.3:.1f}°" in facts
    assert f"yaw rate {side * 3.0:.1f}°/s" in facts


def test_a_receiver_whose_time_stands_still_is_reported(monkeypatch):
    line = MemoryTransport()

    def polls(*_):
        for step in range(20):
            report = Report(time=BEGIN, latitude=50.0, longitude=4.0, height=0.0, speed=float(step))
            line.arrive(10.0 + 0.2 * step, nmea.gga(report))
            yield from (10.0 + 0.2 * step, 10.1 + 0.2 * step)

    monkeypatch.setattr(check_receiver, "open_transport", lambda _: line)
    monkeypatch.setattr(check_receiver, "poll_times", polls)
    settings, frame = ReceiverSettings(transport="file:memory"), LocalFrame(latitude=50.0, longitude=4.0)
    finding = check_receiver.check_receiver("tractor receiver", settings, frame, 4.0, 0.2, None, oldest=5.0)
    assert "its time stands still: it has repeated an epoch 19 times" in finding.problems[0]
    assert math.isnan(finding.clock)


def test_a_receiver_that_sends_corrections_alone_is_not_silent(monkeypatch):
    rtcm = bytes.fromhex("d300133ed7d30202980edeef34b4bd62ac0941986f33360b98")
    finding = finding_of(monkeypatch, lambda *_: rtcm)
    assert not finding.received
    assert finding.problems[0].startswith(
        "something comes, but nothing that is understood (125 × byte of messages without a position): check the baud"
    )


def test_no_deviation_is_reported_without_a_fix(monkeypatch):
    def told(step, time):
        return nmea.gga(Report(time=time, latitude=50.0, longitude=4.0, height=0.0, quality=FixQuality.NONE))

    assert "fix none" in finding_of(monkeypatch, told).facts


def test_what_is_not_measured_is_not_reported(monkeypatch):
    assert not any("roll" in fact or "yaw" in fact for fact in facts_of(monkeypatch))


@pytest.mark.parametrize(
    ("sentence", "facts", "problems"),
    [
        (own_sentence("PDBV", 1, 2448, 1), ["angle 14.3°", "switch held"], 0),
        (own_sentence("PDBV", 1, 2048, 0), ["angle 0.0°", "switch released"], 0),
        (own_sentence("PDBV", 1, 9999, 0), ["angle nan°", "switch released"], 1),
        (b"$PDBV,1,2048,1*00\r\n", [], 1),
    ],
)
def test_a_bare_valves_board_is_listened_to_and_told_nothing(monkeypatch, sentence, facts, problems):
    line = MemoryTransport()
    line.arrive(10.0, sentence)
    monkeypatch.setattr(check, "open_transport", lambda _: line)
    monkeypatch.setattr(check, "poll_times", lambda *_: iter([10.0]))
    monkeypatch.setattr(line, "write", lambda data: pytest.fail("it was told something"))
    settings = BareValveSettings(transport="file:memory", counts=HITCH_COUNTS, angles=HITCH_ANGLES)
    finding = check._bare_valve(settings, 1.0)
    assert (finding.facts, len(finding.problems)) == (facts, problems)


@pytest.mark.parametrize(
    ("tractor", "trailer", "differ"),
    [(123, 123, False), (123, 124, True), (0, 124, False), (None, 7, False), (7, 65535, False)],
)
def test_two_base_stations_are_reported(tractor, trailer, differ):
    findings = [Finding(device="receiver", station=station) for station in (tractor, trailer)]
    told = check_receiver.other_station(*findings)
    assert bool(told) is differ
    assert not differ or told[0].startswith("its corrections are of station 124, the tractor receiver's of 123: ")


def test_the_station_of_the_corrections_is_reported(monkeypatch):
    found = finding_of(
        monkeypatch,
        lambda step, time: nmea.gga(dataclasses.replace(report_at(time), station=123)) + nmea.vtg(report_at(time)),
    )
    assert found.station == 123
    assert "corrections of station 123 1 s old" in found.facts


def test_stations_of_both_receivers_are_compared(monkeypatch):
    monkeypatch.setattr(
        check,
        "check_receiver",
        lambda name, *_, **__: Finding(device=name, received=True, station=3 if "tractor" in name else 4),
    )
    for others in ("_boards", "check_isobus"):
        monkeypatch.setattr(check, others, lambda *_, **__: iter([]))
    found = check.check(isobus_devices(), LocalFrame(latitude=50.0, longitude=4.0), 1.0, 0.2, oldest=5.0)
    problems = [any("station" in problem for problem in finding.problems) for finding in found]
    assert problems == [False, True]
