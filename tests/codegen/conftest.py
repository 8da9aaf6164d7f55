"""A unit that evaluates emitted expressions, and a cache folder of one's own."""

from collections.abc import Callable, Iterator
from pathlib import Path

import casadi as ca
import pytest

from drawbar.codegen import Workspace, build
from drawbar.codegen import compiler as discovery
from drawbar.codegen.emit import Output, emit, emit_constants
from drawbar.codegen.statements import Input

ROWS, LATER = 17, 5
"""rows of x and of the first result; rows of u and of the second result"""
CONSTANTS = ca.SX.sym("c", 3)

_UNIT = """
#include "lanes.h"
#include "fields.h"
struct work {{ double x[{rows}][{nx}], u[{later}][{nu}], f[{rows}][{nf}], g[{later}][{ng}];
               double c[3]; int32_t first, count; }};
{functions}
int64_t drawbar_size = sizeof(struct work);
const struct drawbar_field drawbar_fields[] = {{
    FIELD(work, x, 0, {rows}, {nx}, 0) FIELD(work, u, 0, {later}, {nu}, 0) FIELD(work, f, 0, {rows}, {nf}, 0)
    FIELD(work, g, 0, {later}, {ng}, 0) FIELD(work, c, 0, 3, 0, 0) FIELD(work, first, 1, 1, 0, 0)
    FIELD(work, count, 1, 1, 0, 0) END_OF_FIELDS
}};
int constants(struct work *work) {{ lay_down(work); return 0; }}
int run(struct work *work) {{ evaluate(work, work->first, work->count); return 0; }}
"""


@pytest.fixture(scope="session")
def compiled() -> Callable[..., Workspace]:
    """Return a workspace with rows x, u, constants c and results f, g of these; `run` does rows first .. count - 1."""

    def compiled(x: ca.SX, u: ca.SX, f: ca.SX, g: ca.SX, c: ca.SX = CONSTANTS) -> Workspace:
        inputs = [
            Input(place="work->x[{k}][{i}]", rows=str(ROWS), symbol=x),
            Input(place="work->u[{k}][{i}]", rows=str(LATER), symbol=u),
            Input(place="work->c[{i}]", rows="", symbol=c),
        ]
        outputs = [
            Output(place="work->f[k]", rows=str(ROWS), value=f),
            Output(place="work->g[k]", rows=str(LATER), value=g),
        ]
        arguments = "struct work *work"
        functions = emit_constants("lay_down", inputs, outputs, arguments)
        functions += emit("evaluate", inputs, outputs, arguments)
        sizes = {"nx": x.numel(), "nu": u.numel(), "nf": f.numel(), "ng": g.numel()}
        return Workspace(build("emitted", _UNIT.format(rows=ROWS, later=LATER, functions=functions, **sizes)))

    return compiled


@pytest.fixture
def no_compiler_yet(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Forget the compiler that was found, before and after; $CC is unset."""

    def forget() -> None:
        discovery.find_compiler.cache_clear()
        discovery.compiler_identity.cache_clear()

    monkeypatch.delenv("CC", raising=False)
    forget()
    yield
    forget()


@pytest.fixture
def own_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """An empty cache folder."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("DRAWBAR_CACHE", str(folder))
    return folder
