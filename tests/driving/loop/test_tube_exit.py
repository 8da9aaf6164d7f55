"""A body outside its tube: how long that is ordinary, and a drive that ends for it."""

import math
from dataclasses import replace

import pytest

from drawbar.config import load_configuration
from drawbar.driving.loop.tube_exit import TubeExit
from drawbar.driving.stand_in.rehearsal import Rehearsal
from drawbar.messages import SupervisorState
from drawbar.safety.causes import Cause
from drawbar.simulation import Simulation, build_path

SEED, SAMPLE_TIME = 3, 0.2


@pytest.fixture(scope="module")
def step():
    return next(iter(Simulation(load_configuration("articulated"), SEED).steps()))


def margins(step, tractor, trailer):
    return replace(
        step,
        tractor_steering=replace(step.tractor_steering, margin=tractor),
        trailer_steering=replace(step.trailer_steering, margin=trailer),
    )


def told(records, *, engaged=True):
    tube, seen = TubeExit(SAMPLE_TIME), []
    for record in records:
        tube.update(record, engaged=engaged)
        seen.append(tube.notices)
    return seen


@pytest.mark.parametrize("outside", [(-0.01, 0.5), (0.5, -0.01), (-0.3, math.nan)])
def test_it_is_told_after_a_second_and_ends_the_drive_after_two(step, outside):
    seen = told([margins(step, *outside)] * 12)
    assert seen[:4] == [()] * 4
    assert seen[4:9] == [(Cause.OUTSIDE_TUBE.value,)] * 5
    assert seen[9:] == [(Cause.TUBE_LOST.value,)] * 3


def test_a_sample_inside_begins_it_anew(step):
    outside, inside = margins(step, -0.1, 0.5), margins(step, 0.0, 0.0)
    assert not any(told([outside] * 4 + [inside] + [outside] * 4))


def test_without_a_tube_or_not_engaged_nothing_is_outside(step):
    assert not any(told([margins(step, math.nan, math.nan)] * 20))
    assert not any(told([margins(step, -1.0, -1.0)] * 20, engaged=False))


def test_a_drive_that_its_tube_was_not_made_for_is_slowed_down_and_stopped():
    tiny = "disturbances={tractor_crab=1e-5,steering_offset=1e-5,steering_rate=1e-4}"
    estimation = "estimation={lateral=1e-4,yaw=1e-4,steering=1e-4}"
    increments = "increments={lateral=1e-4,yaw=1e-4,steering=1e-4}"
    configuration = load_configuration(
        "articulated",
        [
            "safety.engage.wiggle_test=false",
            "safety.engage.fixed=1.0",
            f"tube.tractor={{lateral=-0.1,yaw=-0.3,kept_rate=1.0,{tiny},{estimation},{increments}}}",
        ],
    )
    rehearsal = Rehearsal(configuration, build_path(configuration)[0], SEED, configuration.safety)
    causes = []
    while rehearsal.gate_state is None or rehearsal.gate_state.state is not SupervisorState.STOPPED:
        assert rehearsal.time < 90.0
        rehearsal.advance()
        state = rehearsal.gate_state
        if state is not None and state.state is SupervisorState.DEGRADED and state.cause not in causes:
            causes.append(state.cause)
    assert Cause.OUTSIDE_TUBE.value in causes
    assert rehearsal.gate_state.cause == Cause.TUBE_LOST.value
