"""How many instructions a step takes, and how many it can take: counted by valgrind, not guessed.

The longest path is forced: in a copy of the library no solver ever finds that it has finished, so that each spends
every pass of the active set and every iteration of the interior point, with everything that an iteration may hold; and
guidance tries every way onto the path. The two are counted apart and added: guidance finds no way when it tries all.
"""

import math
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from drawbar.codegen.compiler import find_compiler
from drawbar.geometry import Floats

HERE = Path(__file__).parent
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno", "-w")
MOST = 15.0
"""instructions of the longest step, per those of the median one"""
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

    def __init__(self, library: Path, program: Path) -> None:
        sources = [*map(str, sorted((library / "src").glob("*.c"))), str(HERE / "replay.c"), str(HERE / "files.c")]
        headers = [f"-I{library / 'include'}", f"-I{HERE}"]
        subprocess.run([*find_compiler(), *FLAGS, *headers, *sources, "-lm", "-o", str(program)], check=True)
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


@pytest.fixture(scope="module", autouse=True)
def _valgrind() -> None:
    if shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed")


def test_the_longest_step(record: Callable, exported: Callable, tmp_path: Path) -> None:
    library, run = exported("articulated"), record("articulated", steps=200)
    (tmp_path / "typical").mkdir()
    typical = Counter(library, tmp_path / "typical" / "replay").counts("drawbar_step", run.nodes, run.measurements)
    longest = Counter(forced(library, tmp_path / "forced"), tmp_path / "forced" / "replay")
    solvers = max(longest.counts("drawbar_step", run.nodes, run.measurements[:20]))
    starts: Sequence[Floats] = [start(run.nodes, beside, yaw) for beside in (-3.0, 1.0) for yaw in (-2.5, 1.6, 3.1)]
    ways = max(longest.counts("drawbar_guidance_reference", run.nodes, each[None])[0] for each in starts)
    print(f"median {np.median(typical):.0f}, most {max(typical)}, solvers {solvers}, guidance {ways}")
    assert max(typical) < solvers
    assert solvers + ways <= MOST * np.median(typical)
