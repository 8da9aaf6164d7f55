"""A world that pulls to one side, and a tape measure that was wrong: one eight of radius 8 m, against the truth."""

import numpy as np
import pytest

from drawbar.signals import FixStatus

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


LONG = (
    *("vehicle.wheelbase=2.8", "vehicle.hitch_length=1.6", "vehicle.drawbar_length=1.0", "vehicle.trailer_length=6.3"),
    *("vehicle.trailer_antenna=1.5", "vehicle.tractor_steering_limit=0.6", "vehicle.curvature_limit=0.12"),
    *("path.radii=[40.0]", "path.straight_length=10.0", "speed=3.0"),
)
"""a long trailer: both bodies share 40 cm of off-tracking in such curves"""


@pytest.mark.parametrize(
    "wrong", ["lengths.trailer_length=0.97", "lengths.trailer_length=1.03", "masts.tractor.forward=-0.1"]
)
@pytest.mark.parametrize("rate", [5.0, 20.0])
def test_fixes_of_half_a_centimetre_do_not_bend_a_vehicle_whose_lengths_are_wrong(simulate, wrong, rate):
    fine = ("sensors.position=0.005", "machine.sensors.position=0.005", f"sample_time={1.0 / rate}")
    run = simulate("articulated", *LONG, *fine, f"machine.{wrong}")
    assert max(largest(run, body, 15.0) for body in ("tractor", "trailer")) <= 0.28
    fixes = np.concatenate([run.column("estimate", f"{body}_fix") for body in ("tractor", "trailer")])
    assert (fixes == FixStatus.ACCEPTED).all()


@pytest.mark.parametrize("aside", ["tractor={left=0.1}", "trailer={left=-0.1}"])
def test_an_antenna_ten_centimetres_aside_does_not_make_a_fast_vehicle_swing(simulate, aside):
    fast = ("vehicle.trailer_length=3.0", "vehicle.trailer_steering_limit=0.45", "machine.actuators.trailer_stop=0.5")
    rig = [each for each in LONG if "trailer_length" not in each and "path" not in each]
    path = ("path.radii=[25.0]", "path.straight_length=25.0", "sample_time=0.1")
    run = simulate("articulated", *rig, *fast, *path, f"machine.masts={{{aside}}}")
    assert max(largest(run, body, 15.0) for body in ("tractor", "trailer")) <= 0.25
