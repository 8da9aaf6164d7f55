"""How many instructions a step takes, and how many it can take: counted by valgrind, for each compiler.

docs/export.md states the figures, and in its last two rows what no step exceeds; the test reads these there. The
compilers differ, because a step is mostly short loops and rows of eight numbers, which LLVM (clang, zig) makes into
SIMD instructions at -O2 and gcc into scalar ones. A build for wider registers gains most where all eight are used,
in the typical step, and least in a search for turns: it is faster in every row, and its longest step is more medians.

The longest path is forced: in a copy of the library no solver ever finds that it has finished, so that each spends
every pass of the active set and every iteration of the interior point, with everything that an iteration may hold; and
guidance tries every way onto the path. The two are counted apart and added: guidance finds no way when it tries all.
"""

import math
import platform
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from drawbar.export.targets import FLAGS, find_target
from drawbar.geometry import Floats

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
FORCED = (
    ("kkt.h", "#define CHECK_TOLERANCE 1e-8", "#define CHECK_TOLERANCE (-1.0)"),
    ("interior_point.h", "violated = 0;", "violated = 1;"),
    ("interior_point.h", "if (s->kkt <= IP_TOLERANCE)", "if (0)"),
    ("interior_point.h", "if (!(ip_measure(ip, step) < mu))", "if (1)"),
    ("interior_point.h", "ip_infeasible(s, ip))\n", "ip_infeasible(s, ip) > 1)\n"),
    ("active_set.h", "if (changes == 0)", "if (changes > NB)"),
    ("active_set.h", "value < s->lower[i] ? -1 : value > s->upper[i] ? 1 : 0;", "i < ACTIVE_MOST;"),
    ("active_set.h", "if (!(side * a->nu[a->slot[i]] <= 0.0) && s->lower[i] < s->upper[i])", "if (0)"),
    ("active_set.h", "if (!(pivot > 1e-10 * own))", "if (0)"),
    ("approach.h", "{fmax(room, fabs(from->offset)), APPROACH_TIGHTER * limits->curvature}", "{1e9, 1e9}"),
    ("approach.h", "pose[2], most.widest)", "pose[2], fmax(room, fabs(from->offset)))"),
    ("approach.h", "angles, pose, &most))\n", "angles, pose, &most) || line->count >= APPROACH_LAID)\n"),
    ("approach.h", "approach_lay(approach, path, most.tightest))", "approach_lay(approach, path, most.tightest) > 1)"),
)
"""header, what it says, what it says instead"""


def start(nodes: Floats, beside: float, yaw: float) -> Floats:
    """Return the measurement (9,) of a straight vehicle that stands beside the path's start, turned from it."""
    _, x, y, along = nodes[0]
    yaw += along
    tractor = (x - beside * math.sin(along), y + beside * math.cos(along))
    trailer = (tractor[0] - 2.15 * math.cos(yaw), tractor[1] - 2.15 * math.sin(yaw))
    return np.array([0.0, *tractor, *trailer, 0.0, 0.0, 0.0, 0.0])


class Counter:
    """Counts the instructions of each call of a function while the library replays measurements."""

    def __init__(self, compiler: Sequence[str], library: Path, program: Path) -> None:
        sources = [*map(str, sorted((library / "src").glob("*.c"))), str(HERE / "replay.c"), str(HERE / "files.c")]
        headers = [f"-I{library / 'include'}", f"-I{HERE}"]
        subprocess.run([*compiler, *FLAGS, "-w", *headers, *sources, "-lm", "-o", str(program)], check=True)
        self._program = program

    def counts(self, function: str, nodes: Floats, measurements: Floats) -> list[int]:
        """Return the instructions of each call."""
        folder = self._program.parent
        (folder / "input").write_bytes(np.float64(len(nodes)).tobytes() + nodes.tobytes() + measurements.tobytes())
        options = [f"--toggle-collect={function}", f"--dump-after={function}", "--combine-dumps=yes"]
        command = ["valgrind", "--tool=callgrind", *options, "--callgrind-out-file=counts", str(self._program)]
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
        lines = (folder / "counts").read_text().splitlines()
        return [int(line.split()[1]) for line in lines if line.startswith("summary:")][: len(measurements)]


def forced(library: Path, folder: Path) -> Path:
    """Return a copy of the library that takes the longest path at every step."""
    shutil.copytree(library, folder)
    for name, found, instead in FORCED:
        text = (folder / "src" / name).read_text()
        assert text.count(found) == 1, f"{name} no longer says {found}"
        (folder / "src" / name).write_text(text.replace(found, instead))
    return folder


@pytest.fixture(params=BUILDS)
def build(request: pytest.FixtureRequest) -> str:
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


def promised(build: str) -> tuple[float, float]:
    """Return the most instructions of a step that docs/export.md promises: in millions, and per median step."""
    text = GUIDE.read_text("utf-8")
    (names,) = re.findall(r"^\| million instructions \| (.*) \|$", text, re.MULTILINE)
    column = names.split(" | ").index(build)
    limits = [
        re.findall(rf"^\| \*\*at most, {unit}\*\* \| (.*) \|$", text, re.MULTILINE) for unit in ("millions", "medians")
    ]
    (millions,), (medians,) = limits
    return float(millions.split(" | ")[column]), float(medians.split(" | ")[column])


def test_the_longest_step(build: str, record: Callable, exported: Callable, tmp_path: Path) -> None:
    library, run, compiler = exported("articulated"), record("articulated", steps=200), BUILDS[build]
    (tmp_path / "typical").mkdir()
    replay = Counter(compiler, library, tmp_path / "typical" / "replay")
    typical = replay.counts("drawbar_step", run.nodes, run.measurements)
    longest = Counter(compiler, forced(library, tmp_path / "forced"), tmp_path / "forced" / "replay")
    solvers = max(longest.counts("drawbar_step", run.nodes, run.measurements[:20]))
    starts: Sequence[Floats] = [start(run.nodes, beside, yaw) for beside in (-3.0, 1.0) for yaw in (-2.5, 1.6, 3.1)]
    ways = max(longest.counts("drawbar_guidance_reference", run.nodes, each[None])[0] for each in starts)
    median, most = 1e-6 * float(np.median(typical)), 1e-6 * (solvers + ways)
    found = [f"{1e-6 * each:.3f}" for each in (max(typical), solvers, ways)]
    print(f"{build}: {median:.3f} | {' | '.join(found)} | {most:.3f} million instructions, {most / median:.1f} medians")
    assert 0 < max(typical) < solvers
    millions, medians = promised(build)
    assert most <= millions
    assert most <= medians * median
