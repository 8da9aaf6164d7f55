"""Iteration of acados, one in real time, from the trajectory and the data of one of drawbar's solvers."""

import ctypes
from pathlib import Path
from typing import Any

import numpy as np

from drawbar.benchmark.acados.declaration import QpSolver, declared, places, varying
from drawbar.benchmark.acados.installation import quiet
from drawbar.codegen import Workspace, build
from drawbar.codegen.library import load
from drawbar.errors import DrawbarError
from drawbar.geometry import Floats
from drawbar.optimal.transcription import Transcription

_UNIT = """
#define _POSIX_C_SOURCE 199309L
#include "clock.h"

struct iteration {
    int (*solve)(void *);
    void *capsule;
    void (*set_trajectory)(void *, void *, void *, int, const char *, void *);
    void (*set_option)(void *, void *, const char *, void *);
    void *config, *dims, *out, *opts;
    double *x, *u;
    int stages, states, inputs, repeats, status;
    double prepare, feedback;
};

static double timed(struct iteration *s, int phase)
{
    s->set_option(s->config, s->opts, "rti_phase", &phase);
    const int64_t start = clock_now();
    s->status = s->solve(s->capsule);
    return 1e-9 * (double)(clock_now() - start);
}

/* Shortest of several preparations and feedbacks, each from the same trajectory, s. */
int iterate(struct iteration *s)
{
    s->prepare = s->feedback = 1e9;
    for (int i = 0; i < s->repeats; ++i) {
        double prepare, feedback;
        for (int k = 0; k <= s->stages; ++k) {
            s->set_trajectory(s->config, s->dims, s->out, k, "x", s->x + k * s->states);
            if (k < s->stages)
                s->set_trajectory(s->config, s->dims, s->out, k, "u", s->u + k * s->inputs);
        }
        prepare = timed(s, 1);
        feedback = timed(s, 2);
        s->prepare = prepare < s->prepare ? prepare : s->prepare;
        s->feedback = feedback < s->feedback ? feedback : s->feedback;
    }
    return 0;
}
"""


class _Iteration(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_void_p) for name in ("solve", "capsule", "set_trajectory", "set_option")),
        *((name, ctypes.c_void_p) for name in ("config", "dims", "out", "opts", "x", "u")),
        *((name, ctypes.c_int) for name in ("stages", "states", "inputs", "repeats", "status")),
        *((name, ctypes.c_double) for name in ("prepare", "feedback")),
    )


class AcadosIteration:
    """acados' solver of one problem, with one solver of its quadratic program."""

    def __init__(
        self,
        template: Any,
        transcription: Transcription,
        workspace: Workspace,
        name: str,
        qp_solver: QpSolver,
        folder: Path,
        *,
        repeats: int,
    ) -> None:
        """Generate and compile the solver.

        Args:
            template: the module `acados_template`.
            transcription: of the problem.
            workspace: of drawbar's solver, after the run has begun.
            name: of the generated library; each needs its own.
            qp_solver: that solves the quadratic program.
            folder: for what is generated.
            repeats: runs of each phase, of which the shortest counts.

        Raises:
            DrawbarError: the problem is none that acados is compared on, or its solver cannot be built.
        """
        self._t, self._places = transcription, places(transcription)
        self._changed = varying(transcription, workspace.array("constants"))
        ocp = declared(template, transcription, self._changed, name, qp_solver)
        ocp.code_export_directory = str(folder / name)
        try:
            with quiet(folder):
                self._solver = template.AcadosOcpSolver(ocp, json_file=str(folder / f"{name}.json"), verbose=False)
        except OSError as error:
            raise DrawbarError(f"acados cannot build its solver, which needs `make` and `cc`: {error}") from error
        self._work = self._call(repeats)
        self._iterate = load(build("acados_iteration", _UNIT)).iterate

    def _call(self, repeats: int) -> _Iteration:
        solver, t = self._solver, self._t
        library = solver.shared_lib
        functions = {
            "solve": getattr(library, f"{solver.model_name}_acados_solve"),
            "set_trajectory": library.ocp_nlp_out_set,
            "set_option": library.ocp_nlp_solver_opts_set,
        }
        return _Iteration(
            **{name: ctypes.cast(each, ctypes.c_void_p) for name, each in functions.items()},
            capsule=solver.capsule,
            config=solver.nlp_config,
            dims=solver.nlp_dims,
            out=solver.nlp_out,
            opts=solver.nlp_opts,
            stages=t.intervals,
            states=t.x.numel(),
            inputs=t.u.numel(),
            repeats=repeats,
        )

    def run(self, workspace: Workspace) -> tuple[float, Floats | None]:
        """Return how long preparation and feedback take from the state that drawbar's solver is in, s, and the plan.

        The plan is None where acados' solver of the quadratic program gives up.
        """
        self._take(workspace)
        x, u = workspace.array("x").copy(), workspace.array("u").copy()
        self._work.x, self._work.u = x.ctypes.data, u.ctypes.data
        self._iterate(ctypes.byref(self._work))
        stages, get = self._t.intervals, self._solver.get
        found = [get(k, "x") for k in range(stages + 1)] + [get(k, "u") for k in range(stages)]
        plan = np.concatenate(found) if self._work.status == 0 else None
        return self._work.prepare + self._work.feedback, plan

    def _take(self, workspace: Workspace) -> None:
        """Take over references or measurements, weights, parameters, bounds, and what is known of the first state."""
        solver, array, t = self._solver, workspace.array, self._t
        y, w, p = array("y"), array("w"), array("p")
        missing = np.isnan(y)
        y, w = np.where(missing, 0.0, y), np.where(missing, 0.0, w)
        last = [not on_input for on_input in t.input_outputs]
        for k in range(t.intervals + 1):
            counts = last if k == t.intervals else [True] * len(last)
            reference, weight = y[k, counts], np.diag(w[k, counts])
            if k == 0 and t.free_initial:
                root = array("root")
                zeros = np.zeros((len(reference), len(root)))
                reference = np.concatenate([reference, array("prior")])
                weight = np.block([[weight, zeros], [zeros.T, root.T @ root]])
            solver.cost_set(k, "yref", reference)
            solver.cost_set(k, "W", weight)
            known = np.concatenate([p[k, : t.p.numel()], array("constants")[self._changed]])
            if known.size:
                solver.set(k, "p", known)
        self._bound(array)

    def _bound(self, array: Any) -> None:
        lower, upper = array("lower"), array("upper")
        for letter, by_stage in (("x", self._places.states), ("u", self._places.inputs)):
            for stage, rows in by_stage.items():
                self._solver.constraints_set(stage, f"lb{letter}", lower[rows])
                self._solver.constraints_set(stage, f"ub{letter}", upper[rows])
        if not self._t.free_initial:
            for side in ("lbx", "ubx"):
                self._solver.constraints_set(0, side, array("initial"))
