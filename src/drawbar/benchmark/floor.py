"""The floor: evaluating the linearisations alone, by the scalar C that CasADi generates for RK4 with sensitivities."""

from pathlib import Path

import casadi as ca

from drawbar.codegen import build
from drawbar.optimal.transcription import Transcription

_UNIT = """
{casadi}
#include "fields.h"
#define N {stages}
struct floor {{
    double x[N][{nx}], u[N][{nu}], p[N][{np} + 1];   /* + 1: C has no empty arrays */
    double step[{rows}], slope[{rows} * ({nx} + {nu})], w[{sz_w} + 1];
}};
int64_t drawbar_size = sizeof(struct floor);
const struct drawbar_field drawbar_fields[] = {{
    FIELD(floor, x, 0, N, {nx}, 0) FIELD(floor, u, 0, N, {nu}, 0) FIELD(floor, p, 0, N, {np} + 1, 0)
    FIELD(floor, step, 0, {rows}, 0, 0) FIELD(floor, slope, 0, {nx} + {nu}, {rows}, 0)
    END_OF_FIELDS
}};
int linearise(struct floor *f)
{{
    for (int k = 0; k < N; ++k) {{
        const double *arguments[] = {{f->x[k], f->u[k], f->p[k]}};
        double *results[] = {{f->step, f->slope}};
        {name}(arguments, results, 0, f->w, 0);
    }}
    return 0;
}}
"""


def build_floor(transcription: Transcription) -> Path:
    """Compile a unit whose `linearise` evaluates F(x, u, p) and its Jacobian at x, u, p (stages, ...), one by one.

    Constant states are left out of the results, as in the solver. Fields `step` (rows,) and `slope` (nx + nu, rows),
    transposed as CasADi stores it, hold those of the last stage.

    Raises:
        CompilerError: no compiler, or it refused the code.
    """
    t = transcription.numeric()
    rows = t.x.numel() - t.constant_states
    step = t.next_state[:rows]
    results = ca.cse([step, ca.jacobian(step, ca.vertcat(t.x, t.u))])
    name = f"{t.name}_floor"
    function = ca.Function(name, [t.x, t.u, t.p], [ca.densify(result) for result in results])
    generator = ca.CodeGenerator(f"{name}.c", {"with_header": False})
    generator.add(function)
    source = _UNIT.format(
        casadi=generator.dump(),
        name=name,
        stages=t.intervals,
        nx=t.x.numel(),
        nu=t.u.numel(),
        np=t.p.numel(),
        rows=rows,
        sz_w=function.sz_w(),
    )
    return build(name, source)
