"""Every shipped configuration drives, and differs from its base in what its name says."""

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.configurations import shipped_names
from drawbar.signals import GateVerdict

BASES = ("articulated", "paper", "pure-pursuit", "lqr")
CHANGED = {
    "centralised": {"controller"},
    "ekf": {"estimator"},
    "ideal": {"estimator"},
    "measured": {"controller"},
    "planned": {"controller"},
    "neglected": {"controller"},
    "no-ancillary": {"tube"},
    "pi": {"controller"},
    "steering-off": {"vehicle", "controller", "tube"},
}
SHORT = ("path.radii=[8.0]", "path.straight_length=4.0")


@pytest.mark.parametrize("name", shipped_names())
def test_every_shipped_configuration_drives_a_short_eight(simulate, name):
    run = simulate(name, *SHORT)
    for record in run.records:
        assert np.isfinite([record.command.tractor_steering, record.command.trailer_steering]).all()
        for plan in (record.plan.tractor, record.plan.trailer):
            assert np.isfinite(plan.poses).all()
            assert np.isfinite(plan.steerings).all()
    assert run.column("solver_failures").sum() == 0
    assert run.column("gate").max() <= GateVerdict.LIMITED
    largest = 1.5 if name.startswith("paper") else 0.2
    for body in ("tractor", "trailer"):
        assert np.abs(run.true_errors(body).error).max() < largest


@pytest.mark.parametrize("name", [name for name in shipped_names() if name not in BASES])
def test_a_comparator_differs_from_its_base_in_what_its_name_says(name):
    (base,) = (base for base in BASES if name.startswith(f"{base}-"))
    here, there = (load_configuration(each).model_dump() for each in (name, base))
    assert {key for key in here if here[key] != there[key]} == {"name", *CHANGED[name.removeprefix(f"{base}-")]}


def mean_error(run, body):
    return float(np.abs(run.true_errors(body).error).mean())


@pytest.mark.parametrize("law", ["pure-pursuit", "lqr"])
def test_the_proportional_integral_joint_halves_the_trailers_error(simulate, law):
    straight, steered = simulate(law, *SHORT), simulate(f"{law}-pi", *SHORT)
    assert np.ptp(straight.column("truth", "trailer_steering")) < 1e-9
    assert mean_error(steered, "trailer") < 0.5 * mean_error(straight, "trailer")


@pytest.mark.parametrize("law", ["pure-pursuit", "lqr"])
def test_the_comparators_are_no_straw_men(simulate, law):
    assert mean_error(simulate(f"{law}-pi", *SHORT), "tractor") < 0.03
    offset = simulate(f"{law}-pi", *SHORT, "start.left=2.0", "path.straight_length=40.0").true_errors("tractor").error
    assert offset[0] > 1.9
    assert np.abs(offset[60:90]).max() < 0.15  # settled after 12 s, on the straight


def test_the_true_state_is_the_upper_limit(simulate):
    for base in ("articulated", "paper"):
        ideal, estimated = simulate(f"{base}-ideal", *SHORT), simulate(base, *SHORT)
        assert np.array_equal(ideal.column("estimate", "tractor", "yaw"), ideal.column("truth", "tractor", "yaw"))
        assert mean_error(ideal, "tractor") < mean_error(estimated, "tractor")


def test_the_trailers_steering_is_off(simulate):
    run = simulate("articulated-steering-off", *SHORT)
    assert np.abs(run.column("truth", "trailer_steering")).max() < 1e-5
