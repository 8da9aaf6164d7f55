"""Bounds found again in records of an error system whose disturbances are known."""

import numpy as np
import pytest

from drawbar.control.settings import Nominal
from drawbar.control.tube.identification import identified

SAMPLES = 400


def record(body, gain, nominal, rng):
    """Return deviations, corrections, errors of the estimate and disturbances of a run of the error system."""
    model = body.model
    n, acting = len(gain), [model.disturbances.index(name) for name in body.explaining]
    pushes = rng.uniform(-0.02, 0.02, size=(SAMPLES, n))
    estimates = rng.uniform(-0.01, 0.01, size=(SAMPLES + 1, n))
    deviations, corrections = np.zeros((SAMPLES + 1, n)), np.zeros(SAMPLES + 1)
    for k in range(SAMPLES):
        corrections[k] = gain @ deviations[k]
        # the true error starts at that of the estimate where the nominal state does
        error = -estimates[k] if nominal is Nominal.PREDICTED else deviations[k] - estimates[k]
        after = model.A[0] @ error + model.B[0] * corrections[k] + model.G[0][:, acting] @ pushes[k]
        deviations[k + 1] = after + estimates[k + 1]
    return deviations, corrections, estimates, pushes


@pytest.mark.parametrize("nominal", [Nominal.PREDICTED, Nominal.PROPAGATED])
@pytest.mark.parametrize(
    ("model", "name", "gain"),
    [
        ("articulated", "tractor", (-0.4, -1.2, -0.2)),
        ("articulated", "trailer", (-0.3, 0.0)),
        ("tricycle", "tractor", (-0.4, -1.2)),
        ("tricycle", "trailer", (-0.4, -1.2)),
    ],
)
def test_with_the_truth_every_source_is_found_again(model, name, gain, nominal, body):
    vehicle, rng = body(model, name), np.random.default_rng(5)
    deviations, corrections, estimates, pushes = record(vehicle, np.array(gain), nominal, rng)
    found = identified(
        vehicle.model,
        vehicle.explaining,
        nominal,
        deviations=deviations,
        corrections=corrections,
        estimate_errors=estimates,
    )
    by_name = {(one.section, one.name): one for one in found}
    for column, disturbance in enumerate(vehicle.explaining):
        one = by_name["disturbances", disturbance]
        assert one.magnitudes == pytest.approx(np.abs(pushes[:, column]), abs=1e-9)
        assert (
            one.unit == dict(zip(vehicle.model.disturbances, vehicle.model.disturbance_units, strict=True))[disturbance]
        )
    for column, state in enumerate(vehicle.model.states):
        assert by_name["estimation", state].magnitudes == pytest.approx(np.abs(estimates[:, column]))
        assert by_name["increments", state].magnitudes.max() <= 0.01 * (1.0 + np.abs(vehicle.model.A[0][column]).sum())


def test_without_the_truth_all_of_a_step_is_the_increment_of_the_estimate(body):
    vehicle, rng = body("articulated", "trailer"), np.random.default_rng(6)
    deviations, corrections, _, _ = record(vehicle, np.array([-0.3, 0.0]), Nominal.PREDICTED, rng)
    found = identified(
        vehicle.model,
        vehicle.explaining,
        Nominal.PREDICTED,
        deviations=deviations,
        corrections=corrections,
        estimate_errors=np.full_like(deviations, np.nan),
    )
    assert {(one.section, one.name) for one in found} == {("increments", "articulation"), ("increments", "steering")}
    fed_back = np.outer(corrections[:-1], vehicle.model.B[0])
    assert found[0].magnitudes == pytest.approx(np.abs(deviations[1:] - fed_back)[:, 0])


def test_samples_whose_nominal_state_was_reset_do_not_count(body):
    vehicle, rng = body("articulated", "trailer"), np.random.default_rng(6)
    deviations, corrections, estimates, _ = record(vehicle, np.array([-0.3, 0.0]), Nominal.PREDICTED, rng)
    deviations[[100, 200]] = 0.0
    found = identified(
        vehicle.model,
        vehicle.explaining,
        Nominal.PREDICTED,
        deviations=deviations,
        corrections=corrections,
        estimate_errors=estimates,
    )
    disturbances = [one.magnitudes for one in found if one.section == "disturbances"]
    assert all(len(magnitudes) == SAMPLES - 2 and magnitudes.max() <= 0.02 + 1e-9 for magnitudes in disturbances)
