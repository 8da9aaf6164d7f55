"""The step of an exported library, between real gate and run monitor and components that do what a measurement says."""

import ctypes
import math

import numpy as np
import pytest
from step_bench import ENDURANCE, ESTIMATE, LENGTH, MEASURED, SAMPLE, STATUS, statuses, told_by

from drawbar.signals import Flag, Status

STEP_ITERATIONS = 16


def test_one_step_is_the_block_diagram(driver):
    ctypes.memset(driver.calls(), 0, 64)
    assert driver.feedback() == 0
    assert driver.calls().value == b"mbBMPeagwtrs"
    assert driver.prepare() == 0
    assert driver.calls().value == b"mbBMPeagwtrsETR"
    assert driver.step()[0] == 0
    assert driver.calls().value == b"mbBMPeagwtrsETRMPeagwtrsETR"  # a run begins once


def test_a_command_is_what_the_laws_and_the_gate_made(driver):
    assert driver.step(tractor_steering=0.2, trailer_steering=-0.1) == (0, [driver.time, 0.2, -0.1, 1.0])
    status, command = driver.step(tractor_steering=0.45, trailer_steering=-0.1)
    assert (status, command) == (0, [driver.time, 0.45, -0.1, 1.0])
    status, command = driver.step(tractor_steering=-0.45, trailer_steering=-0.1)
    assert status == STATUS["LIMITED"]
    wheels = 0.45 - 0.1 * math.exp(-0.5)  # open for 0.15 s, then within the lag
    assert command == pytest.approx([driver.time, wheels - 0.3, -0.1, 1.0])


@pytest.mark.parametrize("part", ["controllers", "estimator"])
def test_a_solvers_failure_shows_and_its_command_counts(driver, part):
    status, command = driver.step(**{part: 4.0}, tractor_steering=0.1)
    assert (status, command) == (STATUS["SOLVER"], [driver.time, 0.1, 0.0, 1.0])
    assert driver.step()[0] == 0


def test_estimate_and_diagnostics_tell_of_the_last_step(driver):
    driver.step(progress=3.0, lateral_error=-0.5, controllers=2.0, estimator=4.0, fixes=1.0, tractor_steering=0.2)
    estimate = ESTIMATE.buffer()
    assert driver.library.drawbar_get_estimate(driver.state, estimate) == 0
    assert estimate[0] == driver.time
    told = told_by(driver)
    body = told.tractor
    assert (body.progress, body.lateral_error, body.nominal, body.ancillary, body.margin) == (3.0, -0.5, 0.2, 0.0, 0.25)
    assert (body.saturated, body.solver, body.fix) == (False, 2, 1)
    assert (told.estimator, told.gate, told.flags, told.missing) == (4, 0, Flag.SOLVER, 0)
    assert (told.speed, told.unsolved) == (1.0, SAMPLE)


@pytest.mark.parametrize("wrong", [math.inf, -math.inf, 1e8])
@pytest.mark.parametrize("name", MEASURED[1:])
def test_an_absurd_value_is_missing(driver, name, wrong):
    driver.step()
    status, command = driver.step(**{name: wrong})
    assert told_by(driver).missing == 1
    driver.step(time=math.nan)  # of which nothing is looked at
    assert told_by(driver).missing == 0
    assert np.isfinite(command).all()
    expected = {
        "lateral_error": "OFF_COURSE",  # of a position that nobody knows
        "tractor_steering": "REFUSED",  # the components here command what they measure
        "trailer_steering": "REFUSED",
    }
    assert status == STATUS[expected.get(name, "MEASUREMENT")]


def test_a_refused_command_is_repeated_then_the_vehicle_stops_for_good(driver):
    driver.step(tractor_steering=0.2)
    for _ in range(4):
        assert driver.step(tractor_steering=math.nan) == (STATUS["REFUSED"], [driver.time, 0.2, 0.0, 1.0])
    stop = (STATUS["STOPPED"], [0.2, 0.0, 0.0])
    for wish in (math.nan, 0.1, 0.1):
        status, command = driver.step(tractor_steering=wish)
        assert (status, command[1:]) == stop
    assert driver.set_path() == 0
    assert driver.step(tractor_steering=0.1) == (0, [driver.time, 0.1, 0.0, 1.0])


@pytest.mark.parametrize("wrong", [100.2, 100.1, -1e300, math.nan, math.inf])
def test_a_time_that_does_not_go_on_is_refused(driver, wrong):
    driver.step(tractor_steering=0.2, time=100.2)
    assert driver.step(tractor_steering=0.1, time=wrong) == (STATUS["TIME"], [100.2, 0.2, 0.0, 1.0])
    assert driver.step(tractor_steering=0.1, time=100.4) == (0, [100.4, 0.1, 0.0, 1.0])


def test_a_clock_that_stands_still_stops_the_vehicle(driver):
    driver.step(tractor_steering=0.2)
    assert statuses(driver, 6, elapsed=0.0) == [STATUS["TIME"]] * 4 + [STATUS["STOPPED"]] * 2
    assert driver.command[3] == 0.0


def test_samples_left_out_are_reported_and_many_end_the_run(driver):
    driver.step(tractor_steering=0.1)
    assert [driver.step(elapsed=gap)[0] for gap in (0.05, 0.29, 0.31)] == [0, 0, Flag.LATE]
    assert driver.step(elapsed=1.05)[0] == Flag.LATE | Flag.SLOWED
    status, command = driver.step(elapsed=1.15)
    assert (status, command[0], command[2:]) == (STATUS["GAP"], driver.time, [0.0, 0.0])
    assert 0.0 < command[1] < 0.01, "the average of commands whose first was 0.1"
    assert driver.step()[0] == STATUS["GAP"]


def test_a_run_begins_as_soon_as_it_can(driver):
    stand = [0.0, 0.0, 0.0]
    for values, expected in (({"progress": math.nan}, "POSITION"), ({"progress": -1.0}, "START")):
        for _ in range(10):  # waiting is no failure
            status, command = driver.step(**values, elapsed=7.0)
            assert (status, command[1:]) == (STATUS[expected], stand)
    assert driver.step(elapsed=7.0)[0] == 0


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"lateral_error": 5.1}, "OFF_COURSE"),
        ({"lateral_error": math.nan}, "OFF_COURSE"),
        ({"guidance": 2.0}, "GUIDANCE"),
    ],
)
def test_what_ends_a_run_stops_the_vehicle_where_it_steers(driver, values, expected):
    driver.step(tractor_steering=0.2)
    for wish in (values, {}):  # and it stays so
        status, command = driver.step(**wish, tractor_steering=-0.1)
        assert (status, command[1:]) == (STATUS[expected], [0.2, 0.0, 0.0])


def test_the_end_of_the_path_ends_the_run(driver):
    assert statuses(driver, 3, progress=LENGTH) == [0, STATUS["FINISHED"], STATUS["FINISHED"]]


def test_a_long_time_without_a_fix_ends_the_run(driver):
    driver.step()
    blind = statuses(driver, 12, fixes=1.0)
    assert blind[:9] == [0] * 9
    assert blind[11] == STATUS["BLIND"]


def test_what_stood_still_stays_so_until_there_is_a_new_command(driver):
    driver.step(progress=LENGTH)
    driver.step()
    driver.set_path()
    assert driver.step(progress=math.nan)[1][3] == 0.0


def test_a_new_run_repeats_no_command_of_the_last(driver):
    driver.step(tractor_steering=0.2, trailer_steering=0.1)
    driver.set_path()
    assert driver.step(tractor_steering=math.nan, trailer_steering=-0.1)[1][1:] == [0.0, -0.1, 0.0]


def test_a_late_sample_lets_the_components_catch_up(driver):
    driver.step()
    ctypes.memset(driver.calls(), 0, 64)
    assert driver.step(elapsed=3 * SAMPLE)[0] == Flag.LATE
    assert driver.calls().value == b"sxsxyzMPeagwtrsETR"


def test_left_out_samples_take_iterations_from_the_solvers(driver):
    iterations = ctypes.c_int32.in_dll(driver.library, "iterations")
    driver.step()
    in_time = iterations.value
    driver.step(elapsed=3 * SAMPLE)
    assert (in_time, iterations.value) == (STEP_ITERATIONS, STEP_ITERATIONS - 2)


def test_flags_are_a_set(driver):
    driver.step(tractor_steering=0.45)
    status, _ = driver.step(elapsed=2 * SAMPLE, tractor_steering=-0.45, estimator=4.0, fixes=math.inf)
    assert status == Flag.LATE | Flag.LIMITED | Flag.SOLVER | Flag.MEASUREMENT
    assert driver.library.drawbar_status_text(status) == b"a new command; several flags are set"
    assert told_by(driver).flags == status


@pytest.mark.parametrize("part", ["controllers", "estimator"])
def test_without_a_solution_the_vehicle_slows_down_and_stops(driver, part):
    driver.step()
    speeds, ends = [], []
    for _ in range(20):
        status, command = driver.step(**{part: 4.0})
        speeds.append(command[3])
        ends.append(status)
    kept, stopped = round(ENDURANCE / 6 / SAMPLE), round(ENDURANCE / SAMPLE)
    assert speeds[:kept] == [1.0] * kept
    assert (np.diff(speeds[kept : stopped - 1]) < 0.0).all()
    assert ends[kept : stopped - 1] == [Flag.SOLVER | Flag.SLOWED] * (stopped - 1 - kept)
    assert ends[stopped - 1 :] == [Status.UNSOLVED] * (len(ends) - stopped + 1)
    assert speeds[stopped - 1 :] == [0.0] * (len(ends) - stopped + 1)


def test_a_solution_in_time_lets_the_vehicle_speed_up_again(driver):
    driver.step()
    slow = [driver.step(estimator=4.0)[1][3] for _ in range(10)][-1]
    assert slow < 0.5
    faster = [driver.step()[1][3] for _ in range(10)]
    assert faster[0] == pytest.approx(slow + 0.5 * SAMPLE)
    assert faster[-1] == 1.0


@pytest.mark.parametrize("elapsed", [0.6, 0.7, 0.8, 0.9, 1.0, 1.1])
def test_a_caller_who_is_always_late_is_slowed_and_stopped(driver, elapsed):
    driver.step()
    ends = statuses(driver, 12, elapsed=elapsed)
    assert ends[0] & Flag.LATE
    assert Flag.SLOWED & ends[2]
    assert ends[-1] == Status.OVERDUE
    assert driver.command[3] == 0.0


@pytest.mark.parametrize(("elapsed", "calls"), [(0.1, 12), (0.16, 35), (0.25, 35)])
def test_a_caller_at_another_rate_is_stopped(driver, elapsed, calls):
    driver.step()
    ends = statuses(driver, calls, elapsed=elapsed)
    assert ends[0] == 0
    assert ends[-1] == Status.RATE
    assert driver.command[3] == 0.0


@pytest.mark.parametrize("shares", [(0.96, 0.96), (1.04, 1.04), (0.6, 1.4), (1.45, 0.55), (1.8, 0.2)])
def test_jitter_and_clocks_that_differ_a_little_are_no_other_rate(driver, shares):
    driver.step()
    for share in 30 * shares:
        assert statuses(driver, 1, elapsed=share * SAMPLE)[0] < STATUS["REFUSED"]


def test_a_command_is_repeated_for_a_second_by_the_clock_too(driver):
    driver.step(tractor_steering=0.2)
    ends = statuses(driver, 3, elapsed=0.6, tractor_steering=math.nan)
    assert ends == [STATUS["REFUSED"], STATUS["STOPPED"], STATUS["STOPPED"]]
