"""Comparison: a probe that gives each of a solver's samples to acados as well."""

from pathlib import Path
from typing import Any

import numpy as np

from drawbar.benchmark.acados.declaration import QP_SOLVERS
from drawbar.benchmark.acados.iteration import AcadosIteration
from drawbar.benchmark.figures import microseconds
from drawbar.benchmark.probe import REPEATS, Probe
from drawbar.codegen import Component
from drawbar.geometry import Floats
from drawbar.optimal.transcription import transcribe
from drawbar.step.library import StepLibrary


class AcadosProbe(Probe):
    """Times of drawbar's solver and of acados', one for each way to solve its quadratic program."""

    def __init__(
        self, template: Any, folder: Path, name: str, library: StepLibrary, component: Component, *, with_peers: bool
    ) -> None:
        """Let the component's solver report its phases.

        Args:
            template: the module `acados_template`.
            folder: for what acados generates.
            name: of the problem.
            library: in which the solver is at work.
            component: the solver's.
            with_peers: as of Probe.
        """
        super().__init__(name, library, component, with_peers=with_peers)
        self._template, self._folder = template, folder
        self._solvers: dict[str, AcadosIteration] = {}
        self.acados: dict[str, list[float]] = {}
        """preparation and feedback, s, by how the quadratic program is solved"""
        self.differences: dict[str, float] = {}
        """largest one between a number of its plan and of drawbar's; NaN where it found no plan"""
        self.unsolved: dict[str, int] = {}
        """samples in which acados gave up"""
        self.compared: list[int] = []
        """the samples"""

    def _compare(self) -> None:
        workspace = self.solver.workspace
        if not self._solvers:
            self._solvers = self._built()
        found = {name: solver.run(workspace) for name, solver in self._solvers.items()}
        own = self._own_plan()
        self.compared.append(len(self.feedback) - 1)
        for name, (time, plan) in found.items():
            self.acados.setdefault(name, []).append(time)
            difference = np.nan if plan is None else np.abs(plan - own).max()
            self.differences[name] = float(np.fmax(self.differences.get(name, np.nan), difference))
            self.unsolved[name] = self.unsolved.get(name, 0) + (plan is None)

    def _built(self) -> dict[str, AcadosIteration]:
        transcription, workspace = transcribe(self.solver.problem), self.solver.workspace
        prefix = self.name.replace("-", "_")
        return {
            each.name: AcadosIteration(
                self._template, transcription, workspace, f"{prefix}_{i}", each, self._folder, repeats=REPEATS
            )
            for i, each in enumerate(QP_SOLVERS)
        }

    def _own_plan(self) -> Floats:
        """Return the solution of the same sample, prepared with its own parameters, as acados has them."""
        workspace = self.solver.workspace
        for phase in ("prepare", "feedback"):
            workspace.function(phase)()
        return np.concatenate([workspace.array("x").ravel(), workspace.array("u").ravel()])


def rows(probe: AcadosProbe) -> list[dict[str, Any]]:
    """Return the figures of drawbar and of each of acados' solvers, of the samples that all were given."""
    samples = [i for i in probe.compared if i < len(probe.iterations)]
    own = np.asarray(probe.prepare)[samples] + np.asarray(probe.feedback)[samples]
    bounded = float((np.asarray(probe.iterations)[samples] > 0).mean())
    first = {
        "problem": f"{probe.name}, bounds active in {bounded:.0%}",
        "solver": "drawbar",
        "total_us": microseconds(own),
    }
    return [first] + [
        {
            "problem": probe.name,
            "solver": f"acados, {name}",
            "total_us": microseconds(times[: len(samples)]),
            "largest_difference": probe.differences[name],
            "unsolved": probe.unsolved[name] / len(times),
        }
        for name, times in probe.acados.items()
    ]
