"""Peers are given the very problem that the solver solves, and find the same answer; a missing one is told."""

import numpy as np
import pytest

from drawbar.benchmark.peers import race as race_module
from drawbar.benchmark.peers.base import MissingPeerError, Peer, casadi_library, stage_problem
from drawbar.benchmark.peers.piqp import Piqp
from drawbar.benchmark.peers.race import PEERS, Race, same
from drawbar.benchmark.probe import Probe
from drawbar.optimal.stage_problem import StageProblem
from drawbar.optimal.transcription import transcribe


def solved(probe: Probe) -> tuple[StageProblem, np.ndarray]:
    """Return the stage problem of the state in which the probe ended, and its solution."""
    work = probe.solver.workspace
    before = work.memory.copy()
    work.function("prepare")()
    assert work.function("feedback")() == 0
    problem = stage_problem(work, free_initial=transcribe(probe.solver.problem).free_initial)
    z = work.array("qp.z").copy()
    work.memory[:] = before  # other tests look at it too
    return problem, z


def test_a_recorded_problem_is_solved_by_the_recorded_solution(probes: list[Probe]) -> None:
    for probe in probes:
        problem, z = solved(probe)
        assert np.abs(problem.defects(z)).max() < 1e-9
        assert problem.violations(z)[:, np.isinf(problem.soft_linear)].max(initial=0.0) < 1e-9


@pytest.mark.parametrize("peer", PEERS, ids=lambda peer: peer.name)
def test_a_peer_finds_the_same_answer(probes: list[Probe], peer: type[Peer]) -> None:
    for probe in probes:
        problem, z = solved(probe)
        try:
            made = peer(problem)
        except MissingPeerError as error:
            pytest.skip(str(error))
        for _ in range(2):  # the second one in memory that has been used
            time, answer = made.solve(problem)
            assert 0.0 < time < 1.0
            if peer is not Piqp or "estimator" not in probe.name:  # it stops early there, which the table tells
                assert same(problem, z, answer)


def test_another_answer_is_noticed(probes: list[Probe]) -> None:
    problem, z = solved(probes[0])
    assert same(problem, z, z)
    assert not same(problem, z, z + 1e-4)
    assert not same(problem, z, np.full_like(z, np.nan))


def test_all_were_given_the_same_problems(probes: list[Probe]) -> None:
    for probe in probes:
        assert probe.race is not None
        times = probe.race.times
        assert set(times) == {"drawbar", *(peer.name for peer in PEERS)} - set(probe.race.missing)
        assert len({(len(each.free), len(each.active)) for each in times.values()}) == 1
        assert times["drawbar"].free or times["drawbar"].active


def test_a_missing_peer_is_left_out_with_the_reason(probes: list[Probe], monkeypatch: pytest.MonkeyPatch) -> None:
    class Missing(Piqp):
        name = "missing"

        def __init__(self, problem: StageProblem) -> None:
            casadi_library("no-such-solver")

    monkeypatch.setattr(race_module, "PEERS", (Missing,))
    solved(probes[0])
    race = Race(free_initial=False)
    race.run(probes[0].solver.workspace, 1e-6)
    assert list(race.times) == ["drawbar"]
    assert "no-such-solver" in race.missing["missing"]
