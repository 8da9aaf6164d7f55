"""One exported library, built once per session by this machine's own compiler, and what it commands."""

import ctypes
import os
import subprocess
import time
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from drawbar.codegen.compiler import FLAGS, find_compiler
from drawbar.config import load_configuration
from drawbar.export.export import export_library
from drawbar.export.targets import TARGETS, Precision, find_target
from drawbar.guidance.path import Path as DrivenPath
from drawbar.signals import Command, Diagnostics, Estimate, Measurement
from drawbar.signals.layout import Layout

MEASUREMENT, COMMAND, ESTIMATE, DIAGNOSTICS = map(Layout, (Measurement, Command, Estimate, Diagnostics))


class Library:
    """An exported library, loaded into this process, with one state."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.functions = ctypes.CDLL(str(file))
        self.functions.drawbar_version.restype = self.functions.drawbar_status_text.restype = ctypes.c_char_p
        self.state = (ctypes.c_double * (self.functions.drawbar_state_size() // 8))()
        self._given, self._taken = MEASUREMENT.buffer(), COMMAND.buffer()

    def call(self, name: str, *arguments: Any) -> int:
        """Call a function of drawbar.h on the state."""
        return int(getattr(self.functions, f"drawbar_{name}")(self.state, *arguments))

    def begin(self, path: DrivenPath) -> int:
        """Start a run along a path; returns the status."""
        self._nodes = path.nodes  # the library keeps no copy
        self.call("init")
        return self.call("set_path", self._nodes.ctypes.data_as(ctypes.c_void_p), len(self._nodes))

    def step(self, measurement: Measurement) -> tuple[Command, int]:
        """Return the command for a measurement, and the status."""
        MEASUREMENT.pack(self._given, measurement)
        status = self.call("step", self._given, self._taken)
        return COMMAND.unpack(self._taken), status

    def drive(self, path: DrivenPath, measurements: Iterable[Measurement]) -> tuple[list[Command], list[int]]:
        """Return commands and statuses of a whole run."""
        assert self.begin(path) == 0
        commands, statuses = zip(*map(self.step, measurements), strict=True)
        return list(commands), list(statuses)


@pytest.fixture(scope="session")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Return a function that exports a shipped configuration with changes, each once."""

    @cache
    def exported(
        name: str, *changes: str, precision: Precision = Precision.DOUBLE, targets: tuple[str, ...] = ()
    ) -> Path:
        folder = tmp_path_factory.mktemp(name)
        export_library(load_configuration(name, changes), folder, [find_target(each) for each in targets], precision)
        return folder

    return exported


@pytest.fixture(scope="session")
def for_targets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the product's library for every target, built once by the first of the processes that share the tests."""
    pytest.importorskip("ziglang")
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "targets"
    ended = folder.with_suffix(".ended")
    try:
        folder.mkdir()
    except FileExistsError:
        while not ended.exists():
            time.sleep(0.1)
    else:
        try:
            export_library(load_configuration("articulated"), folder, TARGETS)
        finally:
            ended.touch()
    return folder


@pytest.fixture(scope="session")
def compiled() -> Callable[..., Library]:
    """Return a function that compiles an exported folder for this machine, by default as Python's own library is."""

    @cache
    def compiled(folder: Path, flags: tuple[str, ...] = FLAGS) -> Path:
        file = folder / f"library-{abs(hash(flags))}.so"
        sources = map(str, sorted((folder / "src").glob("*.c")))
        subprocess.run(
            [*find_compiler(), *flags, f"-I{folder / 'include'}", *sources, "-lm", "-o", str(file)], check=True
        )
        return file

    return lambda *arguments: Library(compiled(*arguments))


@pytest.fixture(scope="session")
def answers() -> Callable[[Callable[..., int]], tuple[bytes, bytes]]:
    """Return a function that asks a library, by its call(), for estimate and diagnostics: as they lie in memory."""

    def answers(call: Callable[..., int]) -> tuple[bytes, bytes]:
        estimate, diagnostics = ESTIMATE.buffer(), DIAGNOSTICS.buffer()
        assert call("get_estimate", estimate) == call("get_diagnostics", diagnostics) == 0
        return bytes(estimate), bytes(diagnostics)

    return answers
