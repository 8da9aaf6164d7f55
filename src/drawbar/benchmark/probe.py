"""Probe of one solver at work in a closed loop: every phase is timed from the very state in which it is called."""

import ctypes

import numpy as np

from drawbar.benchmark.floor import build_floor
from drawbar.benchmark.peers.race import Race
from drawbar.benchmark.stopwatch import Stopwatch
from drawbar.codegen import Component, Workspace, build
from drawbar.codegen.library import load
from drawbar.optimal import ControlSolver, EstimationSolver, SolverUnit
from drawbar.optimal.problem import ControlProblem, EstimationProblem
from drawbar.optimal.solver_source import introspection
from drawbar.optimal.transcription import transcribe
from drawbar.signals import SolverStatus
from drawbar.step.library import StepLibrary

REPEATS = 5
"""Runs per measurement in C; the shortest counts."""
_FREE_RACE_EVERY = 10
"""Steps between problems without active bounds that peers are given; of those with bounds active they are given all."""
_PREPARE, _FEEDBACK, _SHIFT, _SLIDE = range(4)
_PHASES = {_PREPARE: "prepare", _SHIFT: "shift", _SLIDE: "slide"}
"""enum solver_phase (unit.h)"""


class Probe:
    """Times of one solver, step by step, s. Phases between two feedbacks belong to the first of them."""

    def __init__(self, name: str, library: StepLibrary, component: Component, *, with_peers: bool) -> None:
        """Let the component's solver report its phases.

        Args:
            name: of the problem, e.g. `paper-tractor`.
            library: in which the solver is at work.
            component: the solver's; each of its phases is timed on a copy.
            with_peers: also give stage problems to HPIPM, DAQP and PIQP.
        """
        assert isinstance(component.unit, SolverUnit)
        problem = component.unit.problem
        transcription = transcribe(problem)
        self.name, self.stages = name, transcription.intervals
        self.solver = _copy_of(problem)
        """a solver of the same problem that is given the watched one's state before each phase"""
        self.prepare: list[float] = []
        self.feedback: list[float] = []
        self.floor: list[float] = []
        self.iterations: list[int] = []
        memory = self.solver.workspace.memory
        self._live = component.live.memory[: memory.size]
        alone = build(transcription.name, self.solver.source + introspection(transcription))
        self._watch = Stopwatch(alone, memory, repeats=REPEATS)
        floor = build_floor(transcription)
        self._floor_data = Workspace(floor)
        self._floor_watch = Stopwatch(floor, self._floor_data.memory, repeats=REPEATS)
        self.race = Race(free_initial=transcription.free_initial) if with_peers else None
        """the peers on this solver's stage problems"""
        self._solve = self.solver.workspace.function("feedback")
        self._watcher = ctypes.CFUNCTYPE(None, ctypes.c_int32)(self._called)  # lives as long as the probe
        getattr(load(library.file), f"drawbar_{component.name}_set_watcher")(self._watcher)

    def _called(self, phase: int) -> None:
        """Time a phase that is about to begin."""
        memory = self.solver.workspace.memory
        memory[: self._live.size] = self._live
        if phase == _FEEDBACK:
            self._before_feedback()
        elif self.feedback:
            self._note_iterations()
            self.prepare[-1] += self._watch.time(_PHASES[phase])

    def _note_iterations(self) -> None:
        """Look at what the feedback before this phase has left."""
        if len(self.iterations) < len(self.feedback):
            self.iterations.append(self.solver.iterations)

    def _before_feedback(self) -> None:
        self._time_floor()
        self.feedback.append(self._watch.time("feedback"))
        self.prepare.append(0.0)
        if len(self.feedback) > self.stages + 1:
            self._compare()

    def _compare(self) -> None:
        """Compare the feedback that is about to begin, once the estimator's window is full."""
        if self.race:
            self._race(self.race)

    def _race(self, race: Race) -> None:
        """Let the peers solve the problem of this feedback."""
        if self._solve() == SolverStatus.SOLVED and (
            self.solver.iterations > 0 or len(self.feedback) % _FREE_RACE_EVERY == 0
        ):
            race.run(self.solver.workspace, self._watch.time("optimise"))

    def _time_floor(self) -> None:
        data = self._floor_data.array
        data("x")[:], data("u")[:] = self.solver.x[:-1], self.solver.u
        if isinstance(self.solver, ControlSolver):
            data("p")[:, :-1] = self.solver.p[:-1]
        self.floor.append(self._floor_watch.time("linearise"))


def _copy_of(problem: ControlProblem | EstimationProblem) -> ControlSolver | EstimationSolver:
    if isinstance(problem, ControlProblem):
        return ControlSolver(problem)
    return EstimationSolver(problem, np.zeros(len(problem.prior_deviation)))
