"""Recorded runs of the Python product, and the machines on which the exported library repeats them."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, replace
from functools import cache
from itertools import islice
from pathlib import Path as FilePath

import numpy as np
import pytest
from single_layout import SingleLayout

from drawbar.codegen.compiler import FLAGS, find_compiler
from drawbar.experiment.alteration import InterceptedMachine
from drawbar.export.targets import Precision
from drawbar.geometry import Floats
from drawbar.signals import Measurement, StepRecord
from drawbar.signals.layout import Layout
from drawbar.simulation import Simulation

HERE = FilePath(__file__).parent
LAYOUTS = {Precision.DOUBLE: Layout(Measurement), Precision.SINGLE: SingleLayout(Measurement)}
NUMBERS = {Precision.DOUBLE: "<f8", Precision.SINGLE: "<f4"}
REPLAY = str(HERE / "replay.c")
FILES = str(HERE / "files.c")


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """A run of the Python product."""

    nodes: Floats
    """(n, 4) of the path"""
    records: list[StepRecord]

    def write(
        self, folder: FilePath, measurements: Sequence[Measurement], precision: Precision = Precision.DOUBLE
    ) -> None:
        """Write what replay.c reads: the path, and measurements."""
        layout = LAYOUTS[precision]
        packed = bytearray(layout.size * len(measurements))
        for i, measurement in enumerate(measurements):
            layout.pack(packed, measurement, i * layout.size)
        nodes = self.nodes.astype(NUMBERS[precision])
        (folder / "input").write_bytes(np.float64(len(nodes)).tobytes() + nodes.tobytes() + packed)

    @property
    def measurements(self) -> list[Measurement]:
        """Return what the sensors reported."""
        return [record.measurement for record in self.records]

    @property
    def commands(self) -> Floats:
        """(m, 4): time (s), both steerings (rad) and speed (m/s) that the product commanded."""
        return np.array([astuple(record.command) for record in self.records])

    @property
    def statuses(self) -> list[int]:
        """Return what each step said: a status, or the flags of a new command."""
        return [each.flags if each.status.is_new_command else each.status for each in self.records]


@dataclass(frozen=True, slots=True, kw_only=True)
class Replay:
    """What the library made of a recording."""

    statuses: list[int]
    commands: Floats
    stack: int | None
    """bytes, where it was measured"""
    instructions: Floats
    """millions of each step, where QEMU counts them"""


def glitching_joint(measured: Measurement) -> Measurement:
    """Let the joint's sensor report 46° for two samples in forty: the second of them is believed."""
    glitches = 170.0 <= measured.time < 330.0 and measured.time % 8.0 < 0.39
    return replace(measured, trailer_steering=0.8) if glitches else measured


@pytest.fixture(scope="session")
def record(build: Callable[..., Simulation]) -> Callable[..., Recording]:
    """Return a function that drives a shipped configuration with changes and keeps the run."""

    @cache
    def record(name: str, *changes: str, steps: int = 10000, glitches: bool = False) -> Recording:
        simulation = build(name, *changes)
        if glitches:
            simulation.machine = InterceptedMachine(simulation.machine, glitching_joint)
        return Recording(nodes=simulation.path.nodes, records=list(islice(simulation.steps(), steps)))

    return record


@dataclass(frozen=True, slots=True, kw_only=True)
class Host:
    """How a program for one target of the export is linked and run on this machine."""

    triple: str
    """that zig links the host program for, with a C library"""
    flags: tuple[str, ...] = ()
    link: tuple[str, ...] = ()
    """flags of the linker alone: told that there is no C library, the compiler finds no header of one either"""
    sources: tuple[str, ...] = ("files.c",)
    library: str = "libdrawbar.a"
    system: str = "-lm"
    """the machine's own library"""
    runner: tuple[str, ...] = ()


INSTRUCTIONS_OF_TICK = 40
"""QEMU with -icount shift=0 takes an instruction for a nanosecond, and the board's clock has 25 MHz"""
_MUSL, _M7 = "thumb-linux-musleabihf", "-mcpu=cortex_m7+fp_armv8d16"
"""one C library for both 32-bit targets, as zig builds one for half a minute: qemu-arm knows these instructions too"""
_BARE = (_M7, "-Wl,--gc-sections", "-T", str(HERE / "cortex_m.ld"))
_BOARD = ("-nographic", "-semihosting-config", "enable=on,target=native", "-kernel")
HOSTS = {
    "linux-x86_64": Host(triple="x86_64-linux-gnu", library="libdrawbar.so"),
    "linux-aarch64": Host(triple="aarch64-linux-musl", flags=("-static",), runner=("qemu-aarch64",)),
    "linux-armv7": Host(triple=_MUSL, flags=("-static", _M7), runner=("qemu-arm",)),
    "windows-x86_64": Host(
        triple="x86_64-windows-gnu",
        link=("-nostdlib", "-rtlib=compiler-rt", "-Wl,-e,mainCRTStartup", "-Wl,--subsystem,console"),
        sources=("windows.c",),
        system="-lkernel32",
        library="drawbar.lib",
        runner=("wine",),
    ),
    "cortex-m7": Host(
        triple=_MUSL,
        flags=("-static", *_BARE),
        sources=("semihosting.c",),
        runner=("qemu-system-arm", "-M", "mps2-an500", *_BOARD),
    ),
}
"""by target; on the Cortex-M7 there is no Linux, but its C library's mathematics serve as well"""


ARM_GCC = (
    *("arm-none-eabi-gcc", "-mfloat-abi=hard", "-std=gnu99", "-O2"),
    *("-nostartfiles", "--specs=nano.specs", "--specs=nosys.specs", "-Wl,--gc-sections", "-Wl,--no-warn-rwx-segments"),
    *("-T", str(HERE / "cortex_m.ld")),
)
ARM = {
    "cortex-m7": (("-mcpu=cortex-m7", "-mfpu=fpv5-d16"), "mps2-an500"),
    "cortex-m4": (("-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16"), "mps2-an386"),
}
"""by target: how Arm's compiler is told the processor, and QEMU's board with it"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Player:
    """A program that replays recordings, and how to start it."""

    command: tuple[str, ...]
    environment: dict[str, str]
    precision: Precision = Precision.DOUBLE

    def play(self, recording: Recording, folder: FilePath) -> Replay:
        """Replay the recording in an empty folder."""
        recording.write(folder, recording.measurements, self.precision)
        done = subprocess.run(
            self.command,
            cwd=folder,
            env=os.environ | self.environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=False,
            timeout=300,
        )
        assert done.returncode == 0, (done.stdout + done.stderr).decode(errors="replace")[-2000:]
        output = (folder / "output").read_bytes()
        assert np.frombuffer(output, "<f8", 1)[0] == 0.0, "the path was refused"
        step = np.dtype([("status", "<f8"), ("time", "<f8"), ("rest", NUMBERS[self.precision], 3)], align=True)
        steps = np.frombuffer(output, step, offset=8)
        stack, ticks = folder / "stack", folder / "ticks"
        return Replay(
            statuses=steps["status"].astype(int).tolist(),
            commands=np.column_stack([steps["time"], steps["rest"]]),
            stack=int.from_bytes(stack.read_bytes(), "little") if stack.exists() else None,
            instructions=1e-6 * INSTRUCTIONS_OF_TICK * np.fromfile(ticks, "<u4") if ticks.exists() else np.empty(0),
        )


def linked(command: Sequence[str], program: FilePath) -> FilePath:
    done = subprocess.run([*command, "-o", str(program)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:3000]
    return program


@pytest.fixture(scope="session")
def native(exported: Callable[..., FilePath]) -> Callable[..., Player]:
    """Return a function that builds a configuration's player with the compiler and flags of Python's own solvers."""
    flags = [flag for flag in FLAGS if flag != "-shared"]

    @cache
    def native(name: str, precision: Precision = Precision.DOUBLE) -> Player:
        folder = exported(name, precision=precision)
        sources = map(str, sorted((folder / "src").glob("*.c")))
        command = [*find_compiler(), *flags, f"-I{folder / 'include'}", *sources, REPLAY, FILES, "-lm"]
        program = linked(command, folder / "replay")
        return Player(command=(str(program),), environment={}, precision=precision)

    return native


@pytest.fixture(scope="session")
def player(for_targets: FilePath, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Player]:
    """Return a function that builds a program that plays a library for a target: the product's, or one in a folder."""

    @cache
    def player(target: str, folder: FilePath = for_targets) -> Player:
        host = HOSTS[target]
        if host.runner and shutil.which(host.runner[0]) is None:
            pytest.skip(f"{host.runner[0]} is not installed")
        library = folder / "lib" / target
        zig = [sys.executable, "-m", "ziglang", "cc", "-target", host.triple, "-std=gnu99", "-O2", *host.flags]
        zig.append(f"-I{folder / 'include'}")
        sources = [REPLAY, *(str(HERE / name) for name in host.sources)]
        if host.link:
            objects = tmp_path_factory.mktemp("objects")
            sources = [str(linked([*zig, "-c", each], objects / f"{FilePath(each).stem}.o")) for each in sources]
        # beside the library: where Windows looks for it, and Linux is told to
        program = linked(
            [*zig, *host.link, *sources, str(library / host.library), host.system],
            library / f"replay-{os.getpid()}.exe",
        )
        environment = {
            "LD_LIBRARY_PATH": str(library),
            "WINEDEBUG": "-all",
            "WINEPREFIX": str(tmp_path_factory.getbasetemp() / "wine"),
        }
        return Player(command=(*host.runner, str(program)), environment=environment)

    return player


@pytest.fixture(scope="session")
def arm_player(exported: Callable[..., FilePath], for_targets: FilePath) -> Callable[..., Player]:
    """Return a function that links a target's library by GCC with newlib; the library is as it was exported."""

    @cache
    def arm_player(target: str, precision: Precision = Precision.DOUBLE) -> Player:
        for program in (ARM_GCC[0], "qemu-system-arm"):
            if shutil.which(program) is None:
                pytest.skip(f"{program} is not installed")
        processor, board = ARM[target]
        folder = for_targets
        if precision is Precision.SINGLE:
            folder = exported("articulated", precision=precision, targets=(target,))
        library = folder / "lib" / target / "libdrawbar.a"
        sources = [REPLAY, str(HERE / "semihosting.c"), str(library), "-lm"]
        program = library.with_name(f"replay-gcc-{os.getpid()}.elf")
        linked([*ARM_GCC, *processor, f"-I{folder / 'include'}", *sources], program)
        return Player(
            command=("qemu-system-arm", "-M", board, "-icount", "shift=0", *_BOARD, str(program)),
            environment={},
            precision=precision,
        )

    return arm_player
