"""Plans of a steering that is at its bound throughout: they are found within a step's iterations."""

import pytest

from drawbar.config import load_configuration
from drawbar.driving.loop.curve_limits import within_envelope
from drawbar.simulation import Simulation
from drawbar.statuses import SolverStatus

CURVE = ["speed=3.0", "path.radii=[16.0]", "path.straight_length=60.0"]
"""which needs more of the front wheels than their bound leaves beside an offset of 5°"""


@pytest.mark.parametrize(("offset", "seed"), [(-0.087, 0), (-0.087, 1), (0.087, 0)])
def test_a_steering_at_its_bound_is_planned_for(offset: float, seed: int) -> None:
    changes = [*CURVE, f"machine.ground.steering_offset={offset}"]
    with Simulation(within_envelope(load_configuration("articulated", changes)), seed) as simulation:
        log = simulation.log()
    statuses = [record.plan.tractor.status for record in log.records[:-1]]  # the last step has no plan
    unsolved = sum(status is not SolverStatus.SOLVED for status in statuses)
    assert "m from it (limit 1.5 m" in log.outcome.reason  # not that solutions were missing
    assert max(abs(record.reference.tractor.lateral_error) for record in log.records) < 2.0
    assert unsolved < 0.25 * sum(abs(record.estimate.tractor_steering) > 0.15 for record in log.records)
