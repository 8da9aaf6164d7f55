"""The floor evaluates the very linearisation that the solver uses."""

import numpy as np
from condensing_route import transcription_now

from drawbar.benchmark.floor import build_floor
from drawbar.benchmark.probe import Probe
from drawbar.codegen import Workspace


def test_floor_agrees_with_the_solvers_own_linearisation(probes: list[Probe]) -> None:
    for probe in probes:
        transcription = transcription_now(probe.solver)
        floor, array = Workspace(build_floor(transcription)), probe.solver.workspace.array
        floor.array("x")[:], floor.array("u")[:] = probe.solver.x[:-1], probe.solver.u
        if transcription.p.numel():
            floor.array("p")[:, :-1] = array("p")[:-1]
        floor.function("linearise")()
        probe.solver.workspace.function("linearise")()
        rows = transcription.x.numel() - transcription.constant_states
        nx = transcription.x.numel()
        slope = floor.array("slope").T
        np.testing.assert_allclose(floor.array("step"), array("qp.c")[-1, :rows], rtol=0, atol=1e-12)
        np.testing.assert_allclose(slope[:, :nx], array("qp.A")[-1, :rows], rtol=0, atol=1e-12)
        np.testing.assert_allclose(slope[:, nx:], array("qp.B")[-1, :rows], rtol=0, atol=1e-12)
