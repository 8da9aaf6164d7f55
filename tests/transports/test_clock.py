"""From the wall clock's stamps to monotonic time, also while somebody sets the wall clock."""

import pytest
from waiting import FakeClock

from drawbar.transports.clock import OLDEST, StampConverter


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
