"""A world that pulls to one side, and a tape measure that was wrong: one eight of radius 8 m, against the truth."""

import numpy as np
import pytest

ONSET = 25.0
NAMES = ("wheelbase", "hitch_length", "drawbar_length", "trailer_length")


def largest(run, body, after=0.0):
    late = run.column("measurement", "time") >= after
    return float(np.abs(run.true_errors(body).error[late]).max())


@pytest.mark.parametrize("crab", [0.0524, -0.0524])
def test_on_a_slope_the_bodies_share_what_the_trailer_cannot_steer_away(simulate, crab):
    slope = ("path.radii=[8.0]", f'machine.events=[{{kind="side_slope", start={ONSET}, crab={crab}}}]')
    shared, alone = simulate("articulated", *slope), simulate("articulated", *slope, "controller.sharing.share=0.0")
    for run in (shared, alone):
        assert run.column("solver_failures").sum() == 0
    assert largest(shared, "tractor") <= 0.15
    settled = ONSET + 10.0
    assert largest(shared, "trailer", settled) < largest(alone, "trailer", settled) - 0.015


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_lengths_wrong_by_a_tenth_are_driven(simulate, factor):
    lengths = ",".join(f"{name}={factor}" for name in NAMES)
    run = simulate("articulated", "path.radii=[8.0]", f"machine.lengths={{{lengths}}}")
    assert largest(run, "tractor") <= 0.14
    assert largest(run, "trailer") <= 0.12
    assert run.column("solver_failures").sum() == 0
