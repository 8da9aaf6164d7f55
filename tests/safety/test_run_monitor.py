"""When a run is given up: too far from the path, or blind for too long."""

import math
from dataclasses import replace

import numpy as np
import pytest
from ordinary import believed
from safeguards import RunMonitor
from scipy.optimize import brentq

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.safety.sanity import SanitySettings
from drawbar.signals import BodyReference, FixStatus, MonitorVerdict
from drawbar.vehicle.parameters import VehicleParameters

LOST, LEAVING, BLIND, DEVIATION = (
    getattr(SanitySettings(), name) for name in ("lost", "leaving", "blind", "blind_deviation")
)
HEADING, STEERING = 0.013, 0.0056
"""as in run_monitor.py, rad"""
BLIND_WAY = brentq(
    lambda way: way * math.hypot(HEADING, STEERING * way / (2.0 * VehicleParameters().wheelbase)) - DEVIATION,
    0.0,
    100.0,
)
"""m"""
LOST_FIX = FixStatus.MISSING
SEEN = believed(time=3.0)


def beside(error):
    return BodyReference(progress=0.0, lateral_error=error, closest=np.zeros(4), samples=np.zeros((2, 4)))


@pytest.mark.parametrize("error", [-LOST, -1.0, 0.0, LOST])
def test_near_the_path_the_run_goes_on(error):
    assert RunMonitor().watch(SEEN, beside(error)) is MonitorVerdict.ON_COURSE


@pytest.mark.parametrize("error", [-1.001 * LOST, 1.001 * LOST, math.inf, math.nan])
def test_too_far_from_the_path_or_nowhere_it_is_given_up(error):
    assert RunMonitor().watch(SEEN, beside(error)) is MonitorVerdict.OFF_COURSE


def followed(way=6.0, **watched):
    """Return a monitor of a tractor that has followed the path so far, m, and the estimate after that."""
    monitor = RunMonitor()
    for time in np.arange(3.0, 3.0 + way, 0.2):
        assert monitor.watch(replace(SEEN, time=time, speed=1.0), beside(0.09), **watched) is MonitorVerdict.ON_COURSE
    return monitor, replace(SEEN, time=time + 0.2, speed=1.0)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_tractor_that_has_followed_the_path_must_stay_nearer(side):
    monitor, now = followed()
    assert monitor.watch(now, beside(side * LEAVING)) is MonitorVerdict.ON_COURSE
    assert monitor.watch(replace(now, time=now.time + 0.2), beside(1.001 * side * LEAVING)) is MonitorVerdict.OFF_COURSE


def test_on_the_way_onto_another_path_it_may_be_as_far_from_it_as_at_the_start():
    monitor, now = followed()
    monitor.rejoin()
    assert monitor.watch(now, beside(LOST)) is MonitorVerdict.ON_COURSE


def test_one_that_only_crosses_the_path_or_is_steered_by_somebody_else_need_not():
    for monitor, now in (followed(4.0), followed(released=True)):
        assert monitor.watch(now, beside(LOST)) is MonitorVerdict.ON_COURSE


@pytest.mark.parametrize("lost", [FixStatus.MISSING, FixStatus.STALE, FixStatus.REJECTED])
def test_without_a_fix_that_is_believed_it_is_given_up_after_a_while(lost):
    monitor, blind = RunMonitor(), replace(SEEN, tractor_fix=lost, trailer_fix=lost)
    for begin in (3.0, 30.0):  # one fix starts the time anew
        monitor.watch(replace(SEEN, time=begin), beside(0.0))
        assert monitor.watch(replace(blind, time=begin + BLIND), beside(0.0)) is MonitorVerdict.ON_COURSE
        assert monitor.watch(replace(blind, time=begin + BLIND + 0.1), beside(0.0)) is MonitorVerdict.BLIND


@pytest.mark.parametrize("speed", [3.0, -2.0])
def test_a_fast_vehicle_is_given_up_after_a_way(speed):
    monitor, blind = RunMonitor(), replace(SEEN, speed=speed, tractor_fix=LOST_FIX, trailer_fix=LOST_FIX)
    for begin in (3.0, 30.0):  # one fix starts the way anew
        monitor.watch(replace(SEEN, time=begin, speed=speed), beside(0.0))
        half, whole = begin + 0.5 * BLIND_WAY / abs(speed), begin + BLIND_WAY / abs(speed)
        assert monitor.watch(replace(blind, time=half), beside(0.0)) is MonitorVerdict.ON_COURSE
        assert monitor.watch(replace(blind, time=whole - 0.1), beside(0.0)) is MonitorVerdict.ON_COURSE
        assert monitor.watch(replace(blind, time=whole + 0.1), beside(0.0)) is MonitorVerdict.BLIND


def test_a_way_that_is_not_a_number_is_given_up():
    monitor, blind = RunMonitor(), replace(SEEN, tractor_fix=LOST_FIX, trailer_fix=LOST_FIX)
    monitor.watch(SEEN, beside(0.0))
    assert monitor.watch(replace(blind, time=3.2, speed=math.nan), beside(0.0)) is MonitorVerdict.BLIND


@pytest.mark.parametrize("antenna", ["tractor_fix", "trailer_fix"])
def test_one_antenna_is_enough(antenna):
    monitor, half = RunMonitor(), replace(SEEN, **{antenna: FixStatus.MISSING})
    for time in (0.0, 2.0 * BLIND, 4.0 * BLIND):
        assert monitor.watch(replace(half, time=time), beside(0.0)) is MonitorVerdict.ON_COURSE


def test_a_run_that_begins_blind_is_given_the_same_time():
    monitor, blind = RunMonitor(), replace(SEEN, tractor_fix=FixStatus.MISSING, trailer_fix=FixStatus.MISSING)
    assert monitor.watch(replace(blind, time=100.0), beside(0.0)) is MonitorVerdict.ON_COURSE
    assert monitor.watch(replace(blind, time=100.1 + BLIND), beside(0.0)) is MonitorVerdict.BLIND


def test_a_run_may_begin_only_where_it_would_go_on():
    assert load_configuration("articulated").guidance.maximum_start_distance < LOST
    changes = ["guidance.maximum_start_distance=9.0"]
    with pytest.raises(ConfigurationError, match=r"sanity\.lost"):
        load_configuration("articulated", changes)
    assert load_configuration("articulated", [*changes, "sanity.lost=12.0"]).sanity.lost == 12.0
