"""The low level in an exported library: the same drives as Python's own, few instructions, little stack."""

import ctypes
import json
import random
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from drawbar.codegen.library import Workspace
from drawbar.config import load_configuration
from drawbar.export.export import export_library
from drawbar.export.targets import FLAGS as EXPORT_FLAGS
from drawbar.export.targets import find_target
from drawbar.machine.low_level.low_level import (
    ActuateInput,
    ActuateStatus,
    LowLevel,
    SpeedAxis,
    SteeringAxis,
    TableSensor,
)
from drawbar.machine.low_level.settings import PositionLoopSettings, SpeedLoopSettings
from drawbar.protocols.sensors import InductiveSensor

HERE = Path(__file__).parent
ZIG = (sys.executable, "-m", "ziglang", "cc")
INSTRUCTIONS = 2000
"""of one call, at most, by any compiler"""
STACK = 512
"""bytes below one call, at most"""


def machine() -> LowLevel:
    """Return a low level with each kind of sensor and an integral part everywhere."""
    table = TableSensor(counts=(100.0, 300.0, 500.0, 900.0), values=(-0.7, -0.2, 0.1, 0.7), lowest=80.0, highest=920.0)
    cubic = InductiveSensor(coefficients=(-0.6, 0.2, 0.02, -0.001), lowest=0.0, highest=5.0)
    pedal = TableSensor(counts=(0.0, 1000.0), values=(0.0, 1.0), lowest=-20.0, highest=1020.0)
    loop = PositionLoopSettings(integral=0.3, full_rate_right=0.35, dead_band_left=0.1)
    return LowLevel(
        front=SteeringAxis(sensor=table, loop=loop, limit=0.6),
        joint=SteeringAxis(sensor=cubic, loop=loop, limit=0.6),
        pedal=SpeedAxis(sensor=pedal, loop=PositionLoopSettings(), speed=SpeedLoopSettings(), full_speed=3.0),
    )


def inputs(count: int, seed: int = 1) -> Iterator[ActuateInput]:
    """Yield moments of a machine that does anything, a few of them absurd."""
    source = random.Random(seed)
    time, on, counts, speed = 0.0, (True, True, True), [400.0, 2.0, 300.0], 1.0
    for _ in range(count):
        time += source.choice([0.01, 0.02, 0.02, 0.02]) if source.random() > 0.002 else source.choice([0.0, -1.0, 5.0])
        if source.random() < 0.05:
            on = tuple(source.random() < 0.8 for _ in range(3))  # type: ignore[assignment]
        if source.random() < 0.005:
            speed = source.choice([0.0, 0.0, 1.0, 1.0, float("nan")])
        if on == (True, True, True) and source.random() < 0.02:
            counts = [400.0, 2.0, 300.0]
        counts = [each + scale * source.uniform(-1.0, 1.0) for each, scale in zip(counts, (9, 0.1, 5), strict=True)]
        if source.random() < 0.005:
            counts[source.randrange(3)] = source.choice([float("nan"), float("inf"), 1e300])
        yield ActuateInput(
            time=time,
            measured_speed=speed,
            counts=(counts[0], counts[1], counts[2]),
            steering=(source.uniform(-0.6, 0.6), source.uniform(-0.6005, 0.6)),
            speed=source.uniform(-0.005, 3.0),
            steer=on[:2],
            drive=on[2],
        )


class Exported:
    """drawbar_actuate of an exported library, with the settings of a low level of Python's own."""

    def __init__(self, file: Path, own: LowLevel) -> None:
        library = ctypes.CDLL(str(file))
        self._actuate = library.drawbar_actuate
        unit: Workspace = own._unit
        array = unit.array
        start = unit.memory.ctypes.data
        self._place = {name: array(name).ctypes.data - start for name in ("input.time", "output.drives")}
        self._memory = unit.memory.copy()
        # the settings lead the hosted structure; the state comes from the exported library's own initialisation
        self._state = (ctypes.c_double * 256)()
        assert library.drawbar_actuate_init(self._state, self._memory.ctypes.data_as(ctypes.c_void_p)) == 0

    def step(self, own: LowLevel) -> tuple[bytes, int]:
        """Return the output as it lies in memory, for the input that the other one was given last."""
        first, behind = self._place["input.time"], self._place["output.drives"]
        given = own._unit.memory[first:behind].tobytes()
        output = ctypes.create_string_buffer(len(own._unit.memory) - behind)
        return output, self._actuate(self._state, given, output)  # type: ignore[return-value]


@pytest.fixture(scope="module")
def library(exported: Callable[..., Path], compiled: Callable) -> Path:
    return compiled(exported("articulated")).file


def test_drives_are_those_of_pythons_own_bit_for_bit(library: Path) -> None:
    own = machine()
    other = Exported(library, own)
    seen: set[ActuateStatus] = set()
    for given in inputs(20_000):
        made = own.step(given)
        output, status = other.step(own)
        place = own._unit.array("output.drives").ctypes.data - own._unit.memory.ctypes.data
        size = 8 * 7 + 4 * 3
        assert output.raw[:size] == own._unit.memory[place : place + size].tobytes()
        assert status == max(made.statuses)
        seen.update(made.statuses)
    assert seen >= {ActuateStatus(value) for value in (0, 1, 2, 16, 17, 18, 19, 20)}


def test_what_is_not_aligned_is_refused_and_not_touched(library: Path) -> None:
    own = machine()
    good, room = Exported(library, own)._state, (ctypes.c_double * 1024)()
    low, odd = ctypes.CDLL(str(library)), ctypes.c_void_p(ctypes.addressof(room) + 4)
    settings, output = own._unit.memory.ctypes.data_as(ctypes.c_void_p), (ctypes.c_double * 16)(*[1.0] * 16)
    before = bytes(good), bytes(room)
    assert low.drawbar_actuate_init(odd, settings) == ActuateStatus.UNALIGNED
    assert low.drawbar_actuate(good, room, odd) == ActuateStatus.UNALIGNED
    assert output[:3] == [1.0] * 3
    for state, given in ((odd, room), (good, odd)):
        assert low.drawbar_actuate(state, given, output) == ActuateStatus.UNALIGNED
        assert output[:3] == [0.0] * 3
    assert (bytes(good), bytes(room)) == before
    assert low.drawbar_actuate_init(good, odd) == ActuateStatus.UNALIGNED
    assert low.drawbar_actuate(good, room, output) == ActuateStatus.NOT_INITIALISED


def test_what_drawbar_export_builds_drives_alike(exported: Callable[..., Path], tmp_path: Path) -> None:
    """zig builds without fused multiply-add and for any processor: the drives agree but for rounding."""
    pytest.importorskip("ziglang")
    folder, file = exported("articulated"), tmp_path / "actuate.so"
    flags = ("-target", find_target("linux-x86_64").triple, *EXPORT_FLAGS, "-fPIC", "-shared")
    source = str(folder / "src" / "actuate.c")
    subprocess.run([*ZIG, *flags, f"-I{folder / 'include'}", source, "-lm", "-o", str(file)], check=True)
    own = machine()
    other = Exported(file, own)
    for given in inputs(5_000):
        made = own.step(given)
        output, _ = other.step(own)
        assert np.frombuffer(output.raw[:56]) == pytest.approx(
            [*made.drives, *made.positions, made.pedal], abs=1e-9, nan_ok=True
        )


def test_says_what_each_status_means(library: Path) -> None:
    said = ctypes.CDLL(str(library)).drawbar_actuate_status_text
    said.restype = ctypes.c_char_p
    texts = [said(status) for status in ActuateStatus]
    assert len(set(texts)) == len(ActuateStatus)
    assert said(-1) == b"no status of the low level"
    assert b"no status of the low level" not in texts


def test_statuses_of_python_are_those_of_the_header(exported: Callable[..., Path]) -> None:
    header = (exported("articulated") / "include" / "drawbar_actuate.h").read_text("utf-8")
    found = dict(re.findall(r"^    DRAWBAR_ACTUATE_(\w+) = (\d+)", header, re.MULTILINE))
    assert {found.pop("FAULT"), found.pop("WRONG_CALL")} == {"16", "64"}
    assert {name: int(value) for name, value in found.items()} == {each.name: each.value for each in ActuateStatus}


def test_the_low_level_stands_by_itself(exported: Callable[..., Path], tmp_path: Path) -> None:
    """A board takes one source and its headers, without any of the autopilot."""
    folder = exported("articulated")
    (tmp_path / "main.c").write_text(
        '#include "drawbar_actuate.h"\nint main(void) { return drawbar_actuate(0, 0, 0) != DRAWBAR_ACTUATE_NULL; }\n'
    )
    sources = [str(tmp_path / "main.c"), str(folder / "src" / "actuate.c")]
    program = tmp_path / "main"
    subprocess.run(
        ["cc", "-std=c99", f"-I{folder / 'include'}", *sources, "-lm", "-o", str(program)], check=True
    ) if shutil.which("cc") else pytest.skip("cc is not installed")
    assert subprocess.run([str(program)], check=False).returncode == 0


def test_stack_and_sizes_are_stated(tmp_path: Path) -> None:
    pytest.importorskip("ziglang")
    export_library(load_configuration("articulated"), tmp_path, [find_target("cortex-m7")])
    manifest = json.loads((tmp_path / "manifest.json").read_text("utf-8"))
    assert manifest["actuate_state_bytes"] == 2048
    stack = manifest["targets"]["cortex-m7"]["stack_bytes"]
    assert 0 < stack["drawbar_actuate_init"] < STACK
    assert 0 < stack["drawbar_actuate"] < STACK


COMPILERS = {
    "gcc": ("gcc",),
    "clang": (next(filter(shutil.which, ("clang-14", "clang")), "clang"),),
    "zig": (*ZIG, "-fno-lto", "-target", find_target("linux-x86_64").triple),
}


@pytest.mark.parametrize("compiler", COMPILERS)
def test_a_call_takes_few_instructions_whatever_is_asked(
    exported: Callable[..., Path], compiler: str, tmp_path: Path
) -> None:
    command = COMPILERS[compiler]
    for tool in (command[0], "valgrind"):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed")
    if compiler == "zig":
        pytest.importorskip("ziglang")
    folder = exported("articulated")
    sources = [str(folder / "src" / "actuate.c"), str(HERE / "fuzz" / "actuate.c")]
    headers = [f"-I{folder / 'include'}", f"-I{HERE / 'fuzz'}"]
    program = tmp_path / "program"
    subprocess.run(
        [*command, *EXPORT_FLAGS, "-w", "-DRANDOM", *headers, *sources, "-lm", "-o", str(program)], check=True
    )
    options = ["--toggle-collect=drawbar_actuate", "--dump-after=drawbar_actuate", "--combine-dumps=yes"]
    done = subprocess.run(
        ["valgrind", "--tool=callgrind", *options, "--callgrind-out-file=counts", str(program), "20"],
        cwd=tmp_path,
        capture_output=True,
        check=False,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    counts = [
        int(line.split()[1]) for line in (tmp_path / "counts").read_text().splitlines() if line.startswith("totals:")
    ]
    print(f"{compiler}: at most {max(counts)} instructions in {len(counts)} calls")
    assert 100 < max(counts) < INSTRUCTIONS
    assert len(counts) > 500
