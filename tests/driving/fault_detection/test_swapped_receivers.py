"""Receivers of tractor and trailer that are exchanged: seen once the vehicle moves, and what the gate says of it."""

import math
from dataclasses import replace

import pytest
from fixes import fixes_of

from drawbar.config import load_configuration
from drawbar.driving.fault_detection.swapped_receivers import SwappedReceivers
from drawbar.driving.stand_in.rehearsal import Rehearsal
from drawbar.messages import SupervisorState
from drawbar.safety.causes import Cause
from drawbar.signals import FixQuality
from drawbar.simulation import build_path
from drawbar.vehicle.parameters import BODIES

AHEAD, BEHIND = (4.0, 1.0), (0.0, 0.0)


def epoch(tractor=AHEAD, trailer=BEHIND, courses=(0.1, 0.0), speed=1.0, **given):
    """Return an epoch of two antennas (m) that move so (rad, m/s)."""
    values = {}
    for body, (x, y), course in zip(BODIES, (tractor, trailer), courses, strict=True):
        values |= {f"{body}_x": x, f"{body}_y": y, f"{body}_speed": speed, f"{body}_course": course}
        values |= {f"{body}_quality": int(FixQuality.FIXED)}
    return fixes_of(**(values | given))


def after(*epochs):
    """Return whether receivers are swapped after epochs."""
    swapped = SwappedReceivers()
    for each in epochs:
        swapped.receive_fixes(each)
    return swapped.found


@pytest.mark.parametrize("courses", [(0.1, 0.0), (1.2, 0.4), (math.nan, 0.2), (-0.6, math.nan)])
def test_an_antenna_of_the_trailer_that_moves_ahead_is_seen_at_the_second_epoch(courses):
    right, wrong = epoch(courses=courses), epoch(BEHIND, AHEAD, courses)
    assert not after(right, right, right)
    assert not after(wrong)
    assert after(wrong, wrong)


def test_what_says_nothing_of_the_way_changes_nothing():
    wrong = epoch(BEHIND, AHEAD)
    still = epoch(AHEAD, BEHIND, courses=(math.nan, math.nan), speed=0.0)
    coarse = epoch(AHEAD, BEHIND, trailer_quality=int(FixQuality.FLOAT))
    for nothing in (still, coarse, epoch(AHEAD, AHEAD), epoch(trailer=(math.nan, math.nan))):
        assert not after(nothing, nothing, nothing)
        assert after(wrong, nothing, wrong)
        assert after(wrong, wrong, nothing)
    assert not after(wrong, epoch(), wrong)
    assert not after(wrong, wrong, epoch())


@pytest.mark.parametrize("courses", [(math.pi, 0.0), (math.pi / 2.0, math.pi / 2.0)])
def test_a_way_to_the_side_or_of_one_antenna_alone_is_none(courses):
    assert not after(*[epoch(BEHIND, AHEAD, courses)] * 5)


def exchange(machine):
    """Let both receivers report what the other one does, from now on."""
    encoders, last = dict(machine.encoders), {}

    def swapped(body, other):
        def encode(report):
            last[body] = report
            return encoders[body](replace(last.get(other, report), time=report.time))

        return encode

    machine.encoders.update({body: swapped(body, other) for body, other in zip(BODIES, BODIES[::-1], strict=True)})


@pytest.fixture
def rehearsal():
    configuration = load_configuration("articulated", ["path.radii=[8.0]", "safety.engage.wiggle_test=false"])
    return Rehearsal(configuration, build_path(configuration)[0], 3, configuration.safety)


def test_swapped_receivers_are_reported_as_soon_as_the_vehicle_moves_and_never_engage(rehearsal):
    exchange(rehearsal.machine)
    told = [(truth.speed, rehearsal.gate_state.refusals) for _, truth in rehearsal.run(30.0) if rehearsal.gate_state]
    refused = [(speed, Cause.RECEIVERS_SWAPPED.value in refusals) for speed, refusals in told]
    assert not any(swapped for speed, swapped in refused if speed < 0.2)
    assert all(swapped for _, swapped in refused[-50:])
    assert rehearsal.gate_state.state is SupervisorState.STANDBY


def test_receivers_that_change_places_while_driving_stop_it_by_their_own_name(rehearsal):
    for _ in rehearsal.run(45.0):
        pass
    assert rehearsal.gate_state.state is SupervisorState.ACTIVE
    exchange(rehearsal.machine)
    states = [(rehearsal.gate_state.state, rehearsal.gate_state.cause) for _ in rehearsal.run(1.5)]
    assert (SupervisorState.STOPPING, Cause.RECEIVERS_SWAPPED.value) in states
