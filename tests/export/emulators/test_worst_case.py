"""How many instructions a step takes, and how many it can take: counted by valgrind, for each compiler.

docs/export.md states the figures, and in its last two rows what no step exceeds; the test reads these there. The
compilers differ, because a step is mostly short loops and rows of eight numbers, which LLVM (clang, zig) makes into
SIMD instructions at -O2 and gcc into scalar ones. A build for wider registers gains most where all eight are used,
in the typical step, and least in a search for turns: it is faster in every row, and its longest step is more medians.

The longest path is forced: in copies of the library no solver ever finds that it has finished, so that each spends
every iteration of the interior point, with everything that an iteration may hold, after either every pass of one of
the active sets or the regularisation of a cost that leaves something undetermined; and guidance tries every way onto
the path. That is counted apart, and added. Samples that a step has to catch up with take iterations away from its
solvers: a step with as many as there can be is counted beside one without.
"""

import math
import platform
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from forced_solvers import ROUTES, forced
from ordinary import measured

from drawbar.export.targets import FLAGS, find_target
from drawbar.geometry import Floats
from drawbar.signals import Measurement

HERE = Path(__file__).parent
GUIDE = Path(__file__).parents[3] / "docs" / "export.md"
ZIG = (sys.executable, "-m", "ziglang", "cc", "-fno-lto")
BUILDS = {
    "zig": (*ZIG, "-target", find_target("linux-x86_64").triple),
    "zig, AVX2": (*ZIG, "-march=x86_64_v3"),
    "clang": (next(filter(shutil.which, ("clang-14", "clang")), "clang"),),
    "gcc": ("gcc",),
}
"""compilers as docs/export.md names them; the first is what `drawbar export` builds with"""
SOLVERS = ("estimator_update", "tractor_feedback", "trailer_feedback")
LEFT_OUT = 5
"""samples at most, that a step catches up with: those that fit between two that are a second and a half sample apart"""


def start(nodes: Floats, beside: float, yaw: float) -> Measurement:
    """Return the measurement of a straight vehicle that stands beside the path's start, turned from it."""
    _, x, y, along = nodes[0].tolist()
    yaw += along
    tractor = (x - beside * math.sin(along), y + beside * math.cos(along))
    trailer = (tractor[0] - 2.15 * math.cos(yaw), tractor[1] - 2.15 * math.sin(yaw))
    return measured(*tractor, *trailer)


def late(measurements: Sequence[Measurement]) -> list[Measurement]:
    """Return measurements with the longest pause between two of them after which a run goes on."""
    half, interval = len(measurements) // 2, measurements[1].time - measurements[0].time
    before = [replace(each, time=interval * (i - half)) for i, each in enumerate(measurements[: half + 1])]
    after = [replace(each, time=1.0 + interval * (i + 0.5)) for i, each in enumerate(measurements[half + 1 :])]
    return before + after


class Counter:
    """Counts the instructions of each call of a function while the library replays measurements."""

    def __init__(self, compiler: Sequence[str], library: Path, program: Path) -> None:
        sources = [*map(str, sorted((library / "src").glob("*.c"))), str(HERE / "replay.c"), str(HERE / "files.c")]
        headers = [f"-I{library / 'include'}", f"-I{HERE}"]
        subprocess.run([*compiler, *FLAGS, "-w", *headers, *sources, "-lm", "-o", str(program)], check=True)
        self._program = program

    def counts(self, function: str, run: Any, measurements: Sequence[Measurement]) -> list[int]:
        """Return the instructions of each call, along the path of a recording."""
        folder = self._program.parent
        run.write(folder, measurements)
        name = f"drawbar_{function}"
        options = [f"--toggle-collect={name}", f"--dump-after={name}", "--combine-dumps=yes"]
        command = ["valgrind", "--tool=callgrind", *options, "--callgrind-out-file=counts", str(self._program)]
        done = subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True)
        lines = (folder / "counts").read_text().splitlines()
        counts = [int(line.split()[1]) for line in lines if line.startswith("summary:")]
        called = [count for count in counts if count]
        assert called, f"{folder.name}: {name} was never called: {_evidence(folder, counts)}; {done.stderr[-500:]}"
        return called


def _evidence(folder: Path, counts: Sequence[int]) -> str:
    """Return what tells whether the library did not come to a function, or valgrind did not see that it did."""
    output = np.frombuffer((folder / "output").read_bytes())
    sizes = {name: (folder / name).stat().st_size for name in ("input", "output", "counts", "replay")}
    symbols = (folder / "replay").read_bytes().count(b"\0drawbar_")
    statuses = output[1::5].astype(int).tolist()
    return f"path {output[0]}, statuses {statuses}, counts {counts}, bytes {sizes}, {symbols} names of functions"


@pytest.fixture(params=BUILDS)
def name(request: pytest.FixtureRequest) -> str:
    """Return the name of each build that can be made and counted here."""
    if platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("the figures are those of x86-64")
    if shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed")
    if shutil.which(BUILDS[request.param][0]) is None:
        pytest.skip(f"{request.param} is not installed")
    if "ziglang" in BUILDS[request.param]:
        pytest.importorskip("ziglang")
    if "AVX2" in request.param and "avx2" not in Path("/proc/cpuinfo").read_text("utf-8").split():
        pytest.skip("this processor has no AVX2")
    return str(request.param)


def promised(name: str) -> tuple[float, float]:
    """Return the most instructions of a step that docs/export.md promises: in millions, and per median step."""
    text = GUIDE.read_text("utf-8")
    (names,) = re.findall(r"^\| million instructions \| (.*) \|$", text, re.MULTILINE)
    column = names.split(" | ").index(name)
    limits = [
        re.findall(rf"^\| \*\*at most, {unit}\*\* \| (.*) \|$", text, re.MULTILINE) for unit in ("millions", "medians")
    ]
    (millions,), (medians,) = limits
    return float(millions.split(" | ")[column]), float(medians.split(" | ")[column])


def test_the_longest_step_is_below_what_the_documentation_states(
    name: str, record: Callable, exported: Callable, tmp_path: Path
) -> None:
    library, run = exported("articulated"), record("articulated", steps=200)

    def counter(kind: str, folder: Path) -> Counter:
        (tmp_path / kind).mkdir(exist_ok=True)
        return Counter(BUILDS[name], folder, tmp_path / kind / "replay")

    replay = counter("typical", library)
    typical = replay.counts("step", run, run.measurements)
    some, delayed = run.measurements[:20], late(run.measurements[:20])
    assert len(replay.counts("estimator_skip", run, delayed)) == LEFT_OUT
    routes = [counter(route, forced(library, tmp_path / route, route)) for route in ROUTES]
    alone = [[max(route.counts(each, run, some)) for each in SOLVERS] for route in routes]
    further = sum(max(each) - each[0] for each in zip(*alone, strict=True))
    solvers, catching_up = (max(routes[0].counts("step", run, each)) + further for each in (some, delayed))
    starts = [start(run.nodes, beside, yaw) for beside in (-3.0, 1.0) for yaw in (-2.5, 1.6, 3.1)]
    ways = max(routes[0].counts("guidance_reference", run, [each])[0] for each in starts)
    median, most = 1e-6 * float(np.median(typical)), 1e-6 * (max(solvers, catching_up) + ways)
    found = [f"{1e-6 * each:.3f}" for each in (max(typical), solvers, catching_up, ways)]
    print(f"{name}: {median:.3f} | {' | '.join(found)} | {most:.3f} million instructions, {most / median:.1f} medians")
    assert 0 < max(typical) < solvers
    millions, medians = promised(name)
    assert most <= millions
    assert most <= medians * median
