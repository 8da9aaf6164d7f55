"""Watch one solver at work in a closed loop: time every phase from the very state in which it is called."""

import time
from collections.abc import Callable
from pathlib import Path

from drawbar.benchmark.condensing import CondensingRoute
from drawbar.benchmark.floor import build_floor
from drawbar.benchmark.stopwatch import Stopwatch
from drawbar.codegen import Workspace, build
from drawbar.optimal.solver import ControlSolver, EstimationSolver
from drawbar.optimal.transcription import transcribe

_REPEATS = 5
"""Runs per measurement in C; the shortest counts."""
_OTHER_ROUTE_EVERY = 10
"""Steps between measurements of the slow route."""


class Probe:
    """Times of one solver, step by step, s. Phases between two feedbacks belong to the first of them."""

    def __init__(self, name: str, solver: ControlSolver | EstimationSolver, *, with_other_route: bool) -> None:
        """Put itself between the solver and its caller.

        Args:
            name: of the problem, e.g. `paper-tractor`.
            solver: to be watched; its phases are replaced by watched ones.
            with_other_route: also solve every tenth problem by CasADi, condensing and DAQP.
        """
        transcription = transcribe(solver.problem)
        library: Path = build(transcription.name, solver.source + transcription.introspection())
        self.name, self.stages, self.solver = name, transcription.horizon, solver
        self.prepare: list[float] = []
        self.feedback: list[float] = []
        self.floor: list[float] = []
        self.iterations: list[int] = []
        self.other_prepare: list[float] = []
        self.other_feedback: list[float] = []
        self._watch = Stopwatch(library, solver.workspace.memory, repeats=_REPEATS)
        floor = build_floor(transcription)
        self._floor_data = Workspace(floor)
        self._floor_watch = Stopwatch(floor, self._floor_data.memory, repeats=_REPEATS)
        self._other = CondensingRoute(transcription, solver) if with_other_route else None
        self._prepare = solver.prepare
        self._feedback, solver.feedback = solver.feedback, self._watched_feedback
        for phase in ("prepare", "shift", "slide"):
            if hasattr(solver, phase):
                setattr(solver, phase, self._watched(phase, getattr(solver, phase)))

    def _watched(self, phase: str, call: Callable[[], int]) -> Callable[[], int]:
        def watched() -> int:
            if self.feedback:
                self.prepare[-1] += self._watch.time(phase)
            status = call()
            if phase == "prepare" and self.feedback:
                self._time_floor()
                self._time_other_prepare()
            return status

        return watched

    def _watched_feedback(self) -> int:
        self.feedback.append(self._watch.time("feedback"))
        self.prepare.append(0.0)
        if self._other and len(self.other_prepare) > len(self.other_feedback):
            start = time.perf_counter()
            self._other.feedback()
            self.other_feedback.append(time.perf_counter() - start)
        status = self._feedback()
        self.iterations.append(self.solver.iterations)
        return status

    def _time_floor(self) -> None:
        data = self._floor_data.array
        data("x")[:], data("u")[:] = self.solver.x[:-1], self.solver.u
        if isinstance(self.solver, ControlSolver):
            data("p")[:, :-1] = self.solver.p[:-1]
        self.floor.append(self._floor_watch.time("linearise"))

    def _time_other_prepare(self) -> None:
        if self._other and len(self.feedback) % _OTHER_ROUTE_EVERY == 0:
            start = time.perf_counter()
            self._other.prepare()
            self.other_prepare.append(time.perf_counter() - start)

    def call_overhead(self) -> float:
        """Return what calling a phase from Python costs beyond the phase itself, s."""
        batches, calls = [], 200
        for _ in range(20):
            start = time.perf_counter()
            for _ in range(calls):
                self._prepare()
            batches.append((time.perf_counter() - start) / calls)
        return min(batches) - self._watch.time("prepare")
