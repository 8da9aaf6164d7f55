"""The latency of fixes that no receiver tells is found while driving, with a yaw-rate sensor alone."""

import pytest

from drawbar.config import load_configuration
from drawbar.simulation import simulate

ATTITUDE = "machine.attitude={tractor={present=true},trailer={present=true}}"


def found(latency: float, reported: bool, *changes: str) -> list[float]:
    """Return what was reckoned with at each step of a figure-eight with the seed 0, s."""
    delays = f"machine.delays={{fix={{latency={latency}}},reported={str(reported).lower()}}}"
    configuration = load_configuration("articulated", ["path.radii=[8.0]", "speed=2.0", delays, *changes])
    log = simulate(configuration, seed=0)
    assert log.outcome is not None
    assert log.outcome.finished
    return [record.actuation.fix_latency for record in log.records]


@pytest.mark.parametrize(("latency", "reported"), [(0.0, False), (0.1, False), (0.2, False), (0.2, True)])
@pytest.mark.parametrize("kind", ["simulated", "physics"])
def test_a_latency_that_no_receiver_reports_is_found(kind: str, latency: float, reported: bool) -> None:
    if kind == "physics":
        pytest.importorskip("mujoco", reason="the extra `physics` is not installed")
    reckoned = found(latency, reported, ATTITUDE, f"machine.kind={kind}")
    assert reckoned[-1] == pytest.approx(0.0 if reported else latency, abs=0.05)


def test_without_a_yaw_rate_sensor_nothing_is_found() -> None:
    assert set(found(0.2, False)) == {0.0}
