"""Forced solvers: an exported library whose solvers go to their last iteration at each step, by changes of its text."""

import shutil
from pathlib import Path

FORCED = (
    ("kkt.h", "#define CHECK_TOLERANCE 1e-8", "#define CHECK_TOLERANCE (-1.0)"),
    ("kkt.h", "if (worst <= CHECK_TOLERANCE && !(gap <= ", "if (1 || !(gap <= "),
    ("ip_start.h", "if (!(farthest > FARTHEST_START))", "if (farthest < 0.0)"),
    ("interior_point.h", "if (s->kkt <= IP_TOLERANCE)", "if (0)"),
    (
        "ip_step.h",
        "if (ip_duality_measure(ip, step) < mu)",
        "if (ip->rejected_correctors == CORRECTOR_REJECTIONS - 1 && s->iterations < IP_ITERATIONS)",
    ),
    ("interior_point.h", "if (ip->stalled_steps < STALLED)", "if (0)"),
    ("interior_point.h", "ip_bound_violation(s) < REGULARISED_VIOLATION", "ip_bound_violation(s) >= 0.0"),
    ("ip_regularisation.h", "if (!(regularised > 0.5 * left))", "if (0)"),
    ("interior_point.h", "if (ip->farkas_margin > FARKAS_FORGIVEN)", "if (0)"),
    (
        "interior_point.h",
        "ip_raise_dual_regularisation(ip))\n            continue;",
        "ip_raise_dual_regularisation(ip))\n            __builtin_trap();",
    ),
    ("interior_point.h", "return ip_end(s, ip, NOT_FINITE);", "__builtin_trap();"),
    ("approach.h", "{fmax(room, fabs(from->offset)), APPROACH_TIGHTER * limits->curvature, ", "{1e9, 1e9, "),
    ("approach.h", "pose[2], most.widest)", "pose[2], fmax(room, fabs(from->offset)))"),
    ("approach.h", "if (!approach_promises(", "if (line->found < APPROACH_FOUND - 12 || !approach_promises("),
    ("approach.h", "nothing is left to spend */\n            return 0;", "*/\n            continue;"),
    ("approach.h", "approach_lay(approach, path, most.tightest))", "approach_lay(approach, path, most.tightest) > 1)"),
)
"""header, what it says, what it says instead: a trap where the path would be cut short"""
ROUTES = {
    "projected Newton": (
        ("optimise.h", "violated = 0;", "violated = 1;"),
        ("pn_backward.h", "a <= NU && again", "a <= NU"),
        (
            "projected_newton.h",
            "pn_respects(s, pn, k, a, x, u[a]) ? 0 :",
            "pn_respects(s, pn, k, a, x, u[a]) > 1 ? 0 :",
        ),
        (
            "pn_backward.h",
            "if (!pn_gains(s, k, at, limit, &H, offset))\n            return 0;",
            "pn_gains(s, k, at, limit, &H, offset);",
        ),
        ("projected_newton.h", "if (changes == 0 && pn_accept(s, pn))", "if (pn_accept(s, pn) > 1)"),
        (
            "projected_newton.h",
            ": -1;\n        if",
            ": -1;\n        if (changes < 0)\n            __builtin_trap();\n        if",
        ),
        ("pn_warm_start.h", "pn->last = -1;", "pn->last = N - 1;"),
        ("pn_warm_start.h", "if (kept && changes == 0 && pn_accept(s, pn))", "if (0)"),
        ("optimise.h", "if (outcome != PN_CONVERGED)", "if (0)"),
    ),
    "columns": (
        ("optimise.h", "violated = 0;", "violated = 1;"),
        (
            "optimise.h",
            "outcome = qp_checked(s, &work->newton);",
            "outcome = (qp_checked(s, &work->newton), PN_COUPLED);",
        ),
        ("active_set.h", "if (changes == 0)", "if (s->iterations == ACTIVE_PASSES - 1)"),
        ("active_set.h", "value < s->lower[i] ? -1 : value > s->upper[i] ? 1 : 0;", "i < ACTIVE_MOST;"),
        ("active_set.h", "if (!(side * a->nu[a->slot[i]] <= 0.0) && s->lower[i] < s->upper[i])", "if (0)"),
        ("active_set.h", "if (!(pivot > ACTIVE_ROUNDING * own))", "if (0)"),
        ("active_set.h", "if (!(fabs(a->nu[r]) <= s->soft_linear[a->member[r]]))", "if (0)"),
    ),
    "regularised": (("optimise.h", "violated |= (value < s->lower[i]) | (value > s->upper[i]);", "(void)value;"),),
}
"""the three ways into the interior point, likewise"""


def forced(library: Path, folder: Path, route: str) -> Path:
    """Return a copy of the library that takes the longest path at every step."""
    shutil.copytree(library, folder)
    for name, found, instead in (*FORCED, *ROUTES[route]):
        text = (folder / "src" / name).read_text()
        assert text.count(found) == 1, f"{name} no longer says {found}"
        (folder / "src" / name).write_text(text.replace(found, instead))
    return folder
