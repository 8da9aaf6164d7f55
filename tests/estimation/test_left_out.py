"""Samples that were left out: the estimate continues as if nothing had been measured in them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from estimators import ExtendedKalmanFilter, MovingHorizonEstimator

from drawbar.signals import Command, SolverStatus
from drawbar.vehicle.parameters import VehicleParameters

SAMPLE_TIME, COUNT = 0.2, 200
LAG = VehicleParameters().steering_lag
VALUES = ("tractor_x", "tractor_y", "trailer_x", "trailer_y", "hitch_angle", "speed")
NOTHING = dict.fromkeys((*VALUES, "tractor_steering", "trailer_steering"), math.nan)
MANY = [k for k in range(COUNT) if k % 10 in (3, 4, 5, 8)]
BOTH = pytest.mark.parametrize("kind", [MovingHorizonEstimator, ExtendedKalmanFilter])


@pytest.fixture(scope="module")
def drive(model, travel, measure):
    """Return measurements of 40 s on curves, exact and noisy, the commands, and both antennas' places (n, 2, 2)."""
    time = SAMPLE_TIME * np.arange(COUNT)
    start, p = np.array([5.0, -3.0, 2.8, 7.0, -3.7, 2.7]), np.array([0.92, 0.95, 0.9, 0.1, 1.0])
    inputs = np.stack([0.15 + 0.1 * np.sin(0.3 * time), 0.1 * np.sin(0.4 * time)], axis=1)
    if model.name == "articulated":
        start, p = np.array([5.0, -3.0, 2.8, 2.7, 0.1, 0.05]), np.array([0.92, 0.95, 0.01, 0.015, 1.0, -0.01])
        inputs = np.stack([0.05 * np.cos(0.3 * time), 0.02 * np.cos(0.4 * time)], axis=1)
    _, outputs = travel(model, start, p, inputs)
    lead = SAMPLE_TIME / -math.expm1(-SAMPLE_TIME / LAG)
    asked = outputs[:-1, 6:8] + lead * np.diff(outputs[:, 6:8], axis=0) / SAMPLE_TIME
    commands = [
        Command(time=0.0, tractor_steering=front, trailer_steering=rear, speed=1.0) for front, rear in asked.tolist()
    ]
    return measure(outputs)[:COUNT], measure(outputs, seed=9)[:COUNT], commands, outputs[:COUNT, :4].reshape(-1, 2, 2)


def estimates(estimator, measurements, commands, gaps, *, skip):
    """Return both antennas' estimated places (n, 2, 2), NaN in the gaps.

    skip: leave the gaps out; else hand them over as samples in which everything is missing.
    """
    found = np.full((len(measurements), 2, 2), math.nan)
    for k, (measurement, command) in enumerate(zip(measurements, commands, strict=True)):
        if k in gaps and skip:
            assert estimator.skip(command) is SolverStatus.SOLVED
            continue
        estimate = estimator.update(replace(measurement, **NOTHING) if k in gaps else measurement)
        assert estimate.status is SolverStatus.SOLVED
        if k not in gaps:
            found[k] = [(pose.x, pose.y) for pose in (estimate.tractor, estimate.trailer)]
        estimator.prepare(command)
    return found


def errors(places, truth):
    """Return the root of the mean square error of both antennas (2,), m."""
    return np.sqrt(np.nanmean(np.square(np.linalg.norm(places - truth, axis=2)), axis=0))


@BOTH
@pytest.mark.parametrize("gap", [2, 60], ids=["filling", "full"])
def test_one_sample_left_out_is_one_in_which_nothing_was_measured(model, drive, kind, gap):
    measurements, _, commands, truth = drive
    left_out, missing = (
        estimates(kind(model, measurements[0]), measurements, commands, [gap], skip=skip) for skip in (True, False)
    )
    assert left_out[:gap].tolist() == missing[:gap].tolist()
    after = slice(gap + 1, gap + 6)
    # the window takes a step more where it is told that there is nothing
    assert np.abs(left_out[after] - missing[after]).max() < (1e-4 if kind is MovingHorizonEstimator else 1e-6)
    assert np.linalg.norm(left_out[after] - truth[after], axis=2).max() < 0.004


@BOTH
def test_many_samples_left_out_are_followed_as_well(model, drive, kind):
    _, measurements, commands, truth = drive
    left_out, missing = (
        errors(estimates(kind(model, measurements[0]), measurements, commands, MANY, skip=skip), truth)
        for skip in (True, False)
    )
    assert (left_out < 1.05 * missing).all()
    assert (left_out < 0.05).all()


@BOTH
@pytest.mark.parametrize("model", ["articulated"], indirect=True)
def test_many_samples_left_out_are_followed_where_nobody_tells_of_commands(model, drive, kind):
    _, measurements, _, truth = drive
    left_out = estimates(kind(model, measurements[0]), measurements, [None] * COUNT, MANY, skip=True)
    assert (errors(left_out, truth) < 0.04).all()
