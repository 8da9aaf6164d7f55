"""A probe watches without disturbing, and both routes answer the same problem."""

from itertools import islice

import numpy as np
import pytest
from condensing_route import CondensingRoute, transcription_now

from drawbar.benchmark.closed_loop import HORIZON, probed_runs
from drawbar.benchmark.probe import Probe
from drawbar.config import load_configuration
from drawbar.optimal import EstimationSolver
from drawbar.simulation import Simulation

STAGES, STEPS = 5, 30


def test_every_step_is_timed_once(probes: list[Probe]) -> None:
    assert [probe.name.split("-")[1] for probe in probes] == ["tractor", "trailer", "estimator"]
    for probe in probes:
        steps = STEPS + STAGES + 1
        assert len(probe.feedback) == len(probe.prepare) == len(probe.floor) == len(probe.iterations) == steps
        assert all(time > 0.0 for times in (probe.prepare, probe.feedback, probe.floor) for time in times)


def test_beside_a_centralised_controller_only_its_one_solver_is_measured() -> None:
    (probe,) = probed_runs("paper-centralised", [STAGES], 3, with_peers=False)[0]
    assert probe.name == "paper-centralised"
    assert [variable.name for variable in probe.solver.problem.model.inputs] == ["tractor_steering", "trailer_steering"]
    assert len(probe.feedback) == len(probe.floor) == 3 + STAGES + 1


def test_the_watched_run_is_the_run(probes: list[Probe]) -> None:
    changes = [f"controller.horizon={STAGES}", f"estimator.window={STAGES}", f"sample_time={HORIZON / STAGES}"]
    changes += [f"machine.step={HORIZON / STAGES / 20}"]
    configuration = load_configuration(probes[0].name.split("-")[0], changes)
    simulation = Simulation(configuration)
    *_, record = islice(simulation.steps(), STEPS + STAGES + 1)
    estimator = simulation.autopilot.library.components["estimator"].live
    assert record.step == STEPS + STAGES
    watched = probes[2]
    watched.solver.prepare()  # the probe looked last before this phase
    np.testing.assert_array_equal(estimator.array("x"), watched.solver.x)


def test_both_routes_take_the_same_step() -> None:
    pytest.importorskip("daqp", reason="the other route needs daqp")
    worst = 0.0
    for name in ("paper", "articulated", "paper-centralised", "articulated-centralised"):
        for probe in probed_runs(name, [STAGES], 25, with_peers=False)[0]:
            solver = probe.solver
            route = CondensingRoute(transcription_now(solver), solver)
            solver.prepare()
            x, u = solver.x.copy(), solver.u.copy()
            route.prepare()
            xi = route.feedback()
            assert solver.feedback() == 0
            moved = np.concatenate(
                [(solver.x - x)[0] if isinstance(solver, EstimationSolver) else [], (solver.u - u).ravel()]
            )
            worst = max(worst, float(np.abs(xi - moved).max()))
    assert worst < 1e-6
