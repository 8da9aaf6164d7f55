"""The tube in the loop: what is declared holds for the true chain, and bounds are kept because of it.

A quick version of experiments/tube, which drives hundreds of such runs: both steerings at their bounds, errors drawn
from their declared bounds. Here the true error and every bound are looked at anew, from truth and commands alone.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.simulation import Simulation, build_machine, build_path
from drawbar.step.build import build_tubes

FOLDER = Path(__file__).parents[2] / "experiments" / "tube"
MODES = ("propagated", "optimised", "predicted")
HARDEST = "bounded_errors.draw=adversarial"


@cache
def run(mode, *changes, seed=0):
    """Return vehicle, tubes and all records of a run."""
    configuration = load_configuration(str(FOLDER / f"{mode}.toml"), changes)
    return configuration.vehicle, build_tubes(configuration), list(Simulation(configuration, seed).steps())


def column(records, *names):
    values = list(records)
    for name in names:
        values = [getattr(value, name) for value in values]
    return np.array(values, float)


def true_errors(records, body):
    """Return x - x̄ (k, n): the deviation that the law saw, less the error of the estimate."""
    yaw = column(records, "truth", "tractor", "yaw")
    errors = {
        name: column(records, "estimate", *name) - column(records, "truth", *name)
        for name in (("tractor", "x"), ("tractor", "y"), ("tractor", "yaw"), ("trailer", "yaw"))
    }
    steering = column(records, "estimate", f"{body}_steering") - column(records, "truth", f"{body}_steering")
    turned = errors["tractor", "yaw"]
    across = np.cos(yaw) * errors["tractor", "y"] - np.sin(yaw) * errors["tractor", "x"]
    seen = (across, turned, steering) if body == "tractor" else (turned - errors["trailer", "yaw"], steering)
    return column(records, "plan", body, "deviation") - np.stack(seen, axis=1)


def asked(records, body):
    return column(records, f"{body}_steering", "nominal") + column(records, f"{body}_steering", "ancillary")


@pytest.mark.parametrize("body", ["tractor", "trailer"])
@pytest.mark.parametrize("mode", MODES)
def test_declared_errors_leave_the_vehicle_in_its_tube_and_its_bounds_alone(mode, body):
    vehicle, tubes, records = run(mode, HARDEST)
    tube, errors = getattr(tubes, body), true_errors(records, body)
    directions = np.random.default_rng(1).normal(size=(500, errors.shape[1])) / tube.support(np.eye(errors.shape[1]))
    assert (errors @ directions.T <= tube.support(directions) + 1e-9).all()
    assert column(records, f"{body}_steering", "margin").min() >= 0.0
    limit, rate = (getattr(vehicle, f"{body}_steering_{name}") for name in ("limit", "rate"))
    commands, steering = asked(records, body), column(records, "truth", f"{body}_steering")
    assert np.abs(commands).max() <= limit
    assert np.abs(steering).max() <= limit
    assert np.abs(commands - steering).max() <= rate * vehicle.steering_lag  # the cylinder can follow
    nominal = column(records, f"{body}_steering", "nominal")
    assert np.abs(nominal).max() == pytest.approx(tube.bounds["command"].tightened)  # the bound was in the way


@pytest.mark.parametrize("mode", MODES)
def test_the_same_run_without_tightening_asks_for_more_than_there_is(mode):
    vehicle, _, records = run(mode, HARDEST, "tube.tighten=false")
    for body in ("tractor", "trailer"):
        limit = getattr(vehicle, f"{body}_steering_limit")
        assert (np.abs(asked(records, body)) > limit).any()


# an optimised nominal state gives way, and takes twice what was declared to be left behind
@pytest.mark.parametrize(("mode", "scale"), [("propagated", 1.5), ("optimised", 2.0), ("predicted", 1.5)])
def test_errors_beyond_their_declaration_are_seen_before_a_bound_is_exceeded(mode, scale):
    vehicle, _, records = run(mode, HARDEST, f"bounded_errors.scale={scale}", seed=1)
    margins = np.array([column(records, f"{body}_steering", "margin") for body in ("tractor", "trailer")])
    assert margins.min() < 0.0
    for body, margin in zip(("tractor", "trailer"), margins, strict=True):
        exceeded = np.abs(asked(records, body)) > getattr(vehicle, f"{body}_steering_limit")
        assert not (exceeded & ~np.logical_or.accumulate(margin < 0.0)).any()


def test_without_errors_and_disturbances_the_vehicle_stays_near_the_centre():
    quiet = [f"bounded_errors.{kind}={{}}" for kind in ("ground", "estimate")]
    *_, records = run("propagated", *quiet)
    assert column(records, "tractor_steering", "margin").min() > 0.8


def test_an_adversary_needs_a_tube():
    configuration = load_configuration("lqr", [HARDEST, "bounded_errors.ground.tractor_crab=0.01"])
    with pytest.raises(ConfigurationError, match="needs tubes to attack"):
        build_machine(configuration, build_path(configuration)[0], seed=0)
