"""Sentences of drawbar's own small boards: what is intact comes out, whatever else comes raises nothing."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.errors import HardwareError
from drawbar.protocols.bare_valve import ValveBoard, ValveReport, commanded_drives, drive_sentence
from drawbar.protocols.own_sentence import SentenceReader, own_sentence
from drawbar.protocols.sensor_board import SensorBoard, sentence
from drawbar.protocols.sensors import Encoder


def test_a_report_and_a_drive_are_those_bytes():
    assert own_sentence("PDBV", 120, 2048, 1) == b"$PDBV,120,2048,1*20\r\n"
    assert drive_sentence(-0.25) == b"$PDBD,-250*24\r\n"
    assert ValveBoard().push(b"$PDBV,120,2048,1*20\r\n", 3.0) == [ValveReport(3.0, 2048, True)]
    assert commanded_drives(SentenceReader("PDBD"), b"$PDBD,-250*24\r\n") == [-0.25]


@pytest.mark.parametrize("drive", [1.01, -1.01, float("nan")])
def test_no_drive_beyond_the_full_one_is_reported(drive):
    with pytest.raises(HardwareError, match="-1 to 1"):
        drive_sentence(drive)


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=200), st.integers(0, 5000), st.booleans(), st.integers(1, 250))
def test_whatever_comes_before_an_intact_report_comes_out(noise, counts, permitted, piece):
    board, reports = ValveBoard(), []
    stream = noise + own_sentence("PDBV", 1, counts, int(permitted))
    for start in range(0, len(stream), piece):
        reports += board.push(stream[start : start + piece], 1.0)
    assert reports[-1] == ValveReport(1.0, counts, permitted)


@pytest.mark.parametrize(
    ("line", "kind"),
    [
        (own_sentence("PDBV", 1, 2, 3), "neither 0 nor 1"),
        (own_sentence("PDBV", 1, None, 1), "no number"),
        (own_sentence("PDBV", 1, -2, 1), "not three whole numbers"),
        (own_sentence("PDBV", 1, 2), "not three whole numbers"),
        (own_sentence("PDBS", 1, 2, 1), "no sentence of this board"),
        (b"$PDBV,120,2048,1*21\r\n", "checksum"),
        (b"$PDBV,120,2048,1*xy\r\n", "checksum"),
        (b"$" * 100, "too long"),
    ],
)
def test_what_is_no_report_is_counted_by_kind(line, kind):
    board = ValveBoard()
    assert board.push(line, 1.0) == []
    assert len(board.dropped) == 1
    assert kind in next(iter(board.dropped))


def test_the_sensor_board_speaks_the_same_form():
    board = SensorBoard(None, None)
    assert len(board.push(sentence(2**32 + 5, None, 7), 2.0)) == 1
    assert board.push(own_sentence("PDBS", None, 1, 2) + own_sentence("PDBS", 1, -1, 2), 2.0) == []
    assert board.dropped == {"no time": 1, "not three whole numbers": 1}


def sensed(*milliseconds):
    """Return the wheel speeds of a board that rolls at 2 m/s, and what it has dropped; ms wrap at 2³²."""
    board = SensorBoard(None, Encoder(pulses_per_metre=100.0, bits=32))
    data = b"".join(sentence(each, None, round(0.2 * (each % 2**31))) for each in milliseconds)
    return [report.wheel_speed for report in board.push(data, 1.0)], board.dropped


def test_datagrams_that_overtake_each_other_or_come_twice_make_no_speed():
    speeds, dropped = sensed(0, 100, 200, 150, 200, 300, 250, 100, 400)
    assert speeds[1:] == pytest.approx([2.0] * 4)
    assert dropped == {"not after the one before": 4}


def test_a_board_that_has_begun_anew_is_heard_after_five_reports():
    speeds, dropped = sensed(50000, 50100, *range(0, 1000, 100))
    assert dropped == {"not after the one before": 4}
    assert speeds[-5:] == pytest.approx([2.0] * 5)


def test_a_board_whose_milliseconds_wrap_goes_on():
    speeds, dropped = sensed(2**31 - 100, 2**31 - 50)
    assert not dropped
    board = SensorBoard(None, None)
    assert len(board.push(sentence(2**32 - 40, None, 0) + sentence(10, None, 0), 1.0)) == 2
    assert not board.dropped
    assert len(speeds) == 2


def ages(came, *, rate=1.0, period=0.05):
    """Return how old each report is said to be, s, of a board whose clock goes at a rate; came(t) is its delay, s."""
    board, found = SensorBoard(None, None), []
    for k in range(4000):
        received = period * k + came(period * k)
        [report] = board.push(sentence(round(1e3 * rate * period * k), None, 0), received)
        found.append(received - report.time)
    return found


def test_a_line_that_becomes_slower_makes_reports_older():
    found = ages(lambda t: 0.02 if t < 30.0 else 0.37)
    assert max(found[:600]) < 0.001
    assert found[601] == pytest.approx(0.35 - 0.006 * 0.45, abs=0.001)
    assert found[801] == pytest.approx(0.35 - 0.006 * 10.45, abs=0.001)


def test_reports_that_come_in_bursts_have_their_own_times():
    found = ages(lambda t: 0.1 - t % 0.1 if t % 0.1 > 0.001 else 0.0)
    assert found[501:505] == pytest.approx([0.05, 0.0] * 2, abs=0.003)


@pytest.mark.parametrize("rate", [0.995, 1.005])
def test_a_clock_that_is_wrong_by_half_a_percent_ages_nothing(rate):
    assert max(ages(lambda t: 0.02, rate=rate)) < 0.001


def test_a_clock_that_stood_still_is_no_delay():
    board = SensorBoard(None, None)
    board.push(sentence(0, None, 0), 1.0)
    assert board.push(sentence(50, None, 0), 11.0)[0].time == 11.0
