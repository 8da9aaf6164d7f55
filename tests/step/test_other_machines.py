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
