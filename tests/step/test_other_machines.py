"""Machines that are not the paper's, on which bounds that were declared for it hold all the same."""

import numpy as np


def test_a_slow_quick_reacting_steering_follows_its_line(simulate):
    run = simulate(
        "articulated",
        "sample_time=0.1",
        "speed=0.6",
        "vehicle.wheelbase=2.9",
        "vehicle.steering_lag=0.13",
        "vehicle.tractor_steering_rate=0.12",
        "machine.actuators.tractor_rate=0.12",
        "path.radii=[12.0]",
    )
    assert np.abs(run.true_errors("tractor").error).max() <= 0.12


def test_a_slow_steering_comes_back_to_its_line_with_the_horizon_that_is_advised(simulate):
    beside = (
        "sample_time=0.1",
        "start.left=1.2",
        "start.yaw=0.2",
        "vehicle.tractor_steering_rate=0.2",
        "machine.actuators.tractor_rate=0.2",
        "vehicle.curvature_limit=0.12",
        "path.radii=[15.0]",
    )
    swinging, advised = simulate("articulated", *beside), simulate("articulated", *beside, "controller.horizon=32")
    worst = [
        np.abs(run.true_errors("tractor").error[run.column("measurement", "time") > 25.0]).max()
        for run in (swinging, advised)
    ]
    assert worst[0] > 0.3
    assert worst[1] <= 0.08


def test_long_plans_are_found_from_beside_the_line(simulate):
    run = simulate(
        "articulated",
        "controller.horizon=60",
        "speed=2.0",
        "start.left=1.2",
        "start.yaw=0.2",
        "vehicle.tractor_steering_rate=0.1",
        "machine.actuators.tractor_rate=0.1",
        "vehicle.curvature_limit=0.12",
        "path.radii=[15.0]",
    )
    assert run.column("solver_failures").sum() == 0


def test_plans_of_a_vehicle_that_is_sampled_seldom_are_found(simulate):
    run = simulate(
        "articulated",
        "sample_time=1.0",
        "vehicle.wheelbase=2.8",
        "vehicle.tractor_steering_limit=0.4",
        "vehicle.tractor_steering_rate=0.2",
        "machine.actuators.tractor_rate=0.2",
        "path.radii=[8.0]",
    )
    assert run.column("solver_failures").sum() == 0


def test_a_long_trailer_that_was_measured_wrong_is_no_contradiction_to_fixes_of_a_centimetre(simulate):
    run = simulate(
        "articulated",
        "speed=3.0",
        "sample_time=0.05",
        "sensors.position=0.01",
        "machine.sensors.position=0.01",
        "vehicle.wheelbase=2.6",
        "vehicle.hitch_length=2.0",
        "vehicle.drawbar_length=0.8",
        "vehicle.trailer_length=6.3",
        "vehicle.curvature_limit=0.12",
        "path.radii=[15.5]",
        "machine.lengths.trailer_length=1.04",
    )
    for name in ("hitch_angle", "trailer_steering"):
        found = run.column("estimate", name) - run.column("measurement", name)
        assert np.abs(found).mean() < 0.03
