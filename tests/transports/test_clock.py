"""From the wall clock's stamps to monotonic time, also while somebody sets the wall clock."""

import os
import time

import pytest
from waiting import FakeClock

from drawbar.transports import clock
from drawbar.transports.clock import OLDEST, MachineClock, StampConverter


@pytest.fixture
def clocks() -> tuple[FakeClock, FakeClock]:
    return FakeClock(50.0), FakeClock(1.7e9)


def test_stamp_keeps_its_age(clocks: tuple[FakeClock, FakeClock]) -> None:
    monotonic, wall = clocks
    converter = StampConverter(monotonic, wall)
    monotonic.now += 3.0
    wall.now += 3.0
    assert converter.monotonic(wall.now - 0.125) == pytest.approx(52.875)


@pytest.mark.parametrize("jump", [-3600.0, -0.5, 0.5, 3600.0])
def test_set_wall_clock_gives_the_time_of_reading_once(clocks: tuple[FakeClock, FakeClock], jump: float) -> None:
    monotonic, wall = clocks
    converter = StampConverter(monotonic, wall)
    stamp = wall.now
    monotonic.now += 0.1
    wall.now += 0.1 + jump
    assert converter.monotonic(stamp) == monotonic.now
    assert converter.monotonic(wall.now - 0.01) == pytest.approx(monotonic.now - 0.01)


@pytest.mark.parametrize("jump", [-3600.0, -1.0, 0.2, 1.0, 3600.0])
def test_what_waited_while_the_wall_clock_was_set_is_no_older_than_it_is(
    clocks: tuple[FakeClock, FakeClock], jump: float
) -> None:
    monotonic, wall = clocks
    converter = StampConverter(monotonic, wall)
    stamps = [wall.now, wall.now + 0.004, wall.now + 0.008]
    monotonic.now += 0.01
    wall.now += 0.01 + jump
    assert [converter.monotonic(stamp) for stamp in stamps] == [monotonic.now] * 3


def test_process_stopped_between_two_looks_is_no_set_clock(clocks: tuple[FakeClock, FakeClock]) -> None:
    monotonic, wall = clocks
    stops = [0.0, 0.0, 0.03, 0.02, 0.0]

    def stopped_wall_clock() -> float:
        shown = wall.now
        stop = stops.pop(0) if stops else 0.0
        monotonic.now += stop
        wall.now += stop
        return shown

    converter = StampConverter(monotonic, stopped_wall_clock)
    stamp, moment = wall.now, monotonic.now
    for _ in range(3):
        assert converter.monotonic(stamp) == pytest.approx(moment)


@pytest.mark.parametrize("age", [-0.001, OLDEST + 0.1, float("nan"), float("inf")])
def test_senseless_stamp_gives_the_time_of_reading(clocks: tuple[FakeClock, FakeClock], age: float) -> None:
    monotonic, wall = clocks
    assert StampConverter(monotonic, wall).monotonic(wall.now - age) == monotonic.now


@pytest.fixture
def computer(monkeypatch: pytest.MonkeyPatch) -> FakeClock:
    """Return the monotonic clock of a computer, s, which this module then reads."""
    monotonic = FakeClock(50.0)
    monkeypatch.setattr(clock.time, "monotonic_ns", lambda: round(monotonic.now * 1e9))
    return monotonic


@pytest.mark.parametrize("pace", [1, 10])
def test_a_stand_ins_time_passes_at_its_pace_and_is_the_same_everywhere(computer: FakeClock, pace: int) -> None:
    one, other = MachineClock(pace), MachineClock(pace)
    assert one() == other() == 50.0 * pace
    begun = one.from_now()
    computer.now += 0.25
    assert begun() == 0.25 * pace
    assert begun.from_now()() == 0.0
    assert one.nanoseconds() == other.nanoseconds() == 50_250_000_000 * pace


@pytest.mark.parametrize("pace", [1, 10])
def test_it_waits_for_so_many_seconds_of_its_own(monkeypatch: pytest.MonkeyPatch, pace: int) -> None:
    waits: list[float] = []
    monkeypatch.setattr(clock.select, "select", lambda *given: (waits.append(given[3]), ([], [], []))[1])
    assert not MachineClock(pace).wait([], 0.5)
    assert not MachineClock(pace).wait([], -1.0)
    assert waits == [0.5 / pace, 0.0]


def test_it_says_whether_something_came() -> None:
    reading, writing = os.pipe()
    os.write(writing, b"!")
    assert MachineClock(10).wait([reading], 5.0)
    for each in (reading, writing):
        os.close(each)


def test_a_stamp_is_as_many_times_as_old_as_the_stand_in_is_fast(computer: FakeClock) -> None:
    wall = FakeClock(1.7e9)
    converter = StampConverter(MachineClock(10), wall)
    computer.now += 3.0
    wall.now += 3.0
    assert converter.monotonic(wall.now - 0.125) == pytest.approx(528.75)
    wall.now += 0.5
    assert converter.monotonic(wall.now - 0.01) == 530.0, "the wall clock was set"
    assert converter.monotonic(wall.now - 0.01) == pytest.approx(529.9)


def test_real_time_is_the_computers() -> None:
    assert MachineClock().nanoseconds() == pytest.approx(time.monotonic_ns(), abs=1e9)
