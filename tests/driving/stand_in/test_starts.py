"""Drives that begin beside the line, across it or folded: each comes onto the line, or says why it does not begin."""

import math

import numpy as np
import pytest
from rehearsals import SEED, errors, rehearse

from drawbar.geometry import wrap
from drawbar.messages import SupervisorState
from drawbar.safety.causes import BY_CODE, Cause


def begin(hitch, *changes, creep=0.12):
    """Return a rehearsal that begins with a hitch angle, rad, and its path; the driver creeps at a speed, m/s."""
    rehearsal, path = rehearse(*changes)
    machine, driver = rehearsal.machine.world._machine, rehearsal.machine.driver
    machine._state[3] = machine._state[2] - hitch
    machine._settle(np.random.default_rng((SEED, 2)))
    rehearsal.machine.world.measurement = machine.read()
    driver.CREEP, driver.wait = creep, 10.5  # the fixes are then old enough, and the vehicle is engaged where it was
    return rehearsal, path


def hitch_of(truth):
    return wrap(truth.tractor.yaw - truth.trailer.yaw - truth.trailer_steering)


@pytest.mark.parametrize(
    ("speed", "left", "degrees", "hitch"),
    [
        (0.5, 0.4, 6.0, 0.0),
        (0.5, 0.6, 0.0, 0.0),
        (1.0, 0.0, 14.0, 30.0),
        (0.5, 0.0, 20.0, 44.0),
        (2.0, 0.0, 25.0, 50.0),
    ],
)
def test_a_drive_that_begins_off_the_line_or_folded_comes_onto_it(speed, left, degrees, hitch):
    # the wheels turn from lock to lock: a gate that let set points change less quickly than wheels do stopped it
    start = (f"speed={speed}", f"start.left={left}", f"start.yaw={math.radians(degrees)}")
    rehearsal, path = begin(math.radians(hitch), *start)
    steps, states, hitches = [], set(), []
    for record, truth in rehearsal.run(35.0):
        steps.append((record, truth))
        states.add(rehearsal.gate_state.state)
        hitches.append(hitch_of(truth) if rehearsal.gate_state.steers else 0.0)
    assert rehearsal.gate_state.state is SupervisorState.ACTIVE
    assert states.isdisjoint({SupervisorState.STOPPING, SupervisorState.STOPPED, SupervisorState.FAULT})
    assert np.abs(hitches).max() < math.radians(50.0)
    assert errors(steps, path).max() < 0.9
    assert errors(steps, path)[-10:].max() < 0.08


@pytest.mark.parametrize(
    ("hitch", "cause"), [(44.0, Cause.ACROSS_LINE), (65.0, Cause.HITCH_ANGLE), (85.0, Cause.HITCH_FOLDED)]
)
def test_a_vehicle_that_is_folded_too_far_is_refused_until_it_is_straighter(hitch, cause):
    rehearsal, _ = begin(math.radians(hitch), creep=0.2)
    refusals, engaged = set(), math.nan
    for _, truth in rehearsal.run(30.0):
        if rehearsal.gate_state.steers:
            engaged = hitch_of(truth)
            break
        refusals |= {BY_CODE[code] for code in rehearsal.gate_state.refusals if code}
    assert cause in refusals
    assert cause.advice
    assert abs(engaged) < math.radians(30.0)
