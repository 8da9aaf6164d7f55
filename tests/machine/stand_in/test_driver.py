"""The stand-in's driver: stands while nobody is there who could steer, creeps, drives, stops."""

from drawbar.machine.stand_in.driver import Driver
from drawbar.machine.stand_in.world import TICK

SPEED = 1.0


def driven(driver: Driver, begin: float, seconds: float, *, attended: bool, steered: bool = False) -> list[float]:
    """Return the speed at each tick, m/s."""
    speeds = []
    for tick in range(round(seconds / TICK)):
        time = begin + tick * TICK
        driver.attend(time, attended=attended)
        driver.tick(time, steered)
        speeds.append(driver.speed)
    return speeds


def test_it_stands_for_hours_until_somebody_is_there_and_a_moment_longer() -> None:
    driver = Driver(SPEED)
    assert not any(driven(driver, 0.0, 100.0, attended=False))
    coming = driven(driver, 3600.0, 10.0, attended=True)
    assert not any(coming[: round(Driver.WAIT / TICK) - 1])
    assert coming[-1] == Driver.CREEP


def test_it_stands_again_when_who_commands_is_gone_before_steering() -> None:
    driver = Driver(SPEED)
    assert driven(driver, 0.0, 10.0, attended=True)[-1] == Driver.CREEP
    assert driven(driver, 10.0, 2.0, attended=False)[-1] == 0.0
    assert driven(driver, 12.0, Driver.WAIT - 0.1, attended=True)[-1] == 0.0


def test_after_a_drive_it_is_ready_for_the_next_one() -> None:
    driver = Driver(SPEED)
    for begin in (0.0, 1000.0):
        assert driven(driver, begin, 10.0, attended=True)[-1] == Driver.CREEP
        assert driven(driver, begin + 10.0, 10.0, attended=True, steered=True)[-1] == SPEED
        rolling = driven(driver, begin + 20.0, 10.0, attended=False)
        assert rolling[0] > 0.9, "it does not stop before it has seen that nobody steers"
        assert rolling[-1] == 0.0


def test_what_a_drive_told_it_holds_no_longer_than_that_drive() -> None:
    driver = Driver(SPEED)
    driver.stop_requested = True  # until the emergency stop has been tried, which that drive never did
    assert not any(driven(driver, 0.0, 10.0, attended=True))
    driven(driver, 10.0, 1.0, attended=False)
    assert driven(driver, 11.0, 10.0, attended=True)[-1] == Driver.CREEP


def test_without_looking_for_anybody_it_creeps_as_rehearsals_want_it() -> None:
    driver = Driver(SPEED)
    for tick in range(round(8.0 / TICK)):
        driver.tick(tick * TICK, steered=False)
    assert driver.speed == Driver.CREEP


def test_where_nobody_tells_it_to_it_stands_longer() -> None:
    driver = Driver(SPEED)
    driver.wait = Driver.WAIT_UNTOLD
    assert not any(driven(driver, 0.0, Driver.WAIT_UNTOLD, attended=True)[:-1])
    assert driven(driver, Driver.WAIT_UNTOLD, 3.0, attended=True)[-1] == Driver.CREEP
