"""The same step twice, driven by Python and as an exported library, on the same simulated machine, with faults.

Solvers fail on command: the text of the headers that call them is changed before anything is compiled, so that the
product has no hook for it.
"""

import ctypes
import math
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import pytest

from drawbar.codegen import cache as compiled_cache
from drawbar.codegen.compiler import FLAGS, find_compiler
from drawbar.codegen.library import load
from drawbar.config import load_configuration
from drawbar.export import manifest, sources
from drawbar.export.export import export_library
from drawbar.geometry import Floats
from drawbar.guidance.path import Path as DrivenPath
from drawbar.signals import Command, Diagnostics, Flag, Measurement, Status, Truth
from drawbar.signals.layout import Layout
from drawbar.simulation import Simulation

SOLVE = "WATCHED(WATCHED_FEEDBACK, rti_feedback(&component->rti, resources));"
SPOILT = """if (UNIT(fails))
        component->rti.status = CHECK_FAILED;
    else
        rti_feedback(&component->rti, resources);"""
EIGHT = ("path.radii=[8.0]",)
_MEASUREMENT, _COMMAND, _DIAGNOSTICS = Layout(Measurement), Layout(Command), Layout(Diagnostics)


def spoilt_sources() -> dict[str, str]:
    """Return the headers with solvers that fail on command."""
    texts = dict(compiled_cache.runtime_sources())
    texts["subsystem_phases.h"] = texts["subsystem_phases.h"].replace(SOLVE.replace("&component->rti", "solver"), SOLVE)
    for name in ("subsystem_phases.h", "moving_horizon.h"):
        assert SOLVE in texts[name]
        text = texts[name].replace(SOLVE, SPOILT)
        first = text.index("/* The nominal state, moved" if name == "subsystem_phases.h" else "/* Start from the first")
        texts[name] = f"{text[:first]}int32_t UNIT(fails);\n\n{text[first:]}"
    return texts


@dataclass(kw_only=True)
class Driven:
    """What became of a run: one entry for each call."""

    times: list[float] = field(default_factory=list)
    statuses: list[int] = field(default_factory=list)
    commands: list[Command] = field(default_factory=list)
    truths: list[Truth] = field(default_factory=list)
    path: DrivenPath

    @property
    def ended(self) -> Status:
        return Status(self.statuses[-1]) if self.statuses[-1] >= Status.REFUSED else Status.OK

    @property
    def flags(self) -> Flag:
        found = Flag(0)
        for status in self.statuses:
            found |= Flag(status) if status < Status.REFUSED else Flag(0)
        return found

    def first(self, status: Status) -> float:
        """Return when a status was given first, s."""
        return self.times[self.statuses.index(status)]

    def distance(self) -> float:
        """Return the largest distance of either body's true antenna from the path, m."""
        worst, places = 0.0, {"tractor": None, "trailer": None}
        for truth in self.truths:
            for body, last in places.items():
                pose = getattr(truth, body)
                near = 0.0 if last is None else last
                progress, error = self.path.project(pose.x, pose.y, near - 4.0, near + 4.0)
                places[body] = progress
                worst = max(worst, abs(error))
        return worst


class Rig:
    """A control step behind drawbar.h, and a machine for it."""

    def __init__(self, library: Path, state: "ctypes.Array[ctypes.c_double]", simulation: Simulation) -> None:
        self.functions, self.state = load(library), state
        self.simulation, self.machine = simulation, simulation.machine
        self._given, self._taken, self._told = _MEASUREMENT.buffer(), _COMMAND.buffer(), _DIAGNOSTICS.buffer()
        self._nodes = simulation.path.nodes
        self.functions.drawbar_init(state)
        self.run = Driven(path=simulation.path)
        assert self.set_path(self._nodes) == 0

    def fail(self, name: str, fails: bool) -> None:
        """Let a component's solver fail, or not."""
        ctypes.c_int32.in_dll(self.functions, f"drawbar_{name}_fails").value = fails

    def repair(self) -> None:
        """Let no solver fail."""
        for component in ("estimator", "tractor", "trailer"):
            self.fail(component, False)

    def set_path(self, nodes: Floats) -> int:
        """Begin a run along a path."""
        status = int(self.functions.drawbar_set_path(self.state, ctypes.c_void_p(nodes.ctypes.data), len(nodes)))
        if status == Status.OK:
            self._nodes, self._begins, self._last_new = nodes, len(self.run.statuses), (-math.inf, 0)
        return status

    def change_path(self, nodes: Floats, at: float) -> int:
        """Go on along another path from an arc length."""
        address = ctypes.c_void_p(nodes.ctypes.data)
        status = int(self.functions.drawbar_change_path(self.state, address, len(nodes), ctypes.c_double(at)))
        self._nodes = nodes if status == Status.OK else self._nodes
        return status

    def set_speed(self, speed: float) -> int:
        return int(self.functions.drawbar_set_speed(self.state, ctypes.c_double(speed)))

    def let_pass(self) -> Measurement:
        """Wait for a sample, and look how it really is."""
        measurement = self.machine.read()
        self.run.truths.append(self.machine.truth())
        return measurement

    def step(self, measurement: Measurement) -> int:
        """Take one step with a measurement and command the machine."""
        _MEASUREMENT.pack(self._given, measurement)
        status = int(self.functions.drawbar_feedback(self.state, self._given, self._taken))
        command = _COMMAND.unpack(self._taken)
        self.machine.write(command)
        self.functions.drawbar_prepare(self.state)
        self.run.times.append(self.machine.truth().time)
        self.run.statuses.append(status)
        self.run.commands.append(command)
        self._promises(status, command)
        return status

    def diagnostics(self) -> Diagnostics:
        self.functions.drawbar_get_diagnostics(self.state, self._told)
        return _DIAGNOSTICS.unpack(self._told)

    def _promises(self, status: int, command: Command) -> None:
        """Hold against what is promised of every command."""
        vehicle, limit = self.simulation.configuration.vehicle, self.simulation.configuration.speed
        assert abs(command.tractor_steering) <= vehicle.tractor_steering_limit
        assert abs(command.trailer_steering) <= vehicle.trailer_steering_limit
        assert 0.0 <= command.speed <= limit
        assert math.isfinite(command.time)
        if status >= Status.FINISHED:
            assert command.speed == 0.0
        if any(each >= Status.FINISHED for each in self.run.statuses[self._begins : -1]):
            assert status == self.run.statuses[-2], "an ended run stays ended"
        if status < Status.REFUSED:
            self._last_new = self.run.times[-1], len(self.run.times)
        elif status in (Status.POSITION, Status.START):
            assert command.speed == 0.0, "a run that cannot begin stands"
        elif self.run.times[-1] > self._last_new[0] + 1.0 or len(self.run.times) > self._last_new[1] + 4:
            assert command.speed == 0.0, "a command acts for one second at most"


@pytest.fixture(scope="session", params=["python", "exported"])
def rig(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[..., Rig]]:
    """Yield a function that makes a rig of a shipped configuration with changes."""
    texts, made = spoilt_sources(), list[Rig]()

    @cache
    def exported(name: str, changes: tuple[str, ...]) -> Path:
        folder = tmp_path_factory.mktemp("library")
        export_library(load_configuration(name, changes), folder)
        file = folder / "library.so"
        units = map(str, sorted((folder / "src").glob("*.c")))
        command = [*find_compiler(), *FLAGS, f"-I{folder / 'include'}", *units, "-lm", "-o", str(file)]
        subprocess.run(command, check=True)
        return file

    def make(name: str, *changes: str, seed: int = 0) -> Rig:
        simulation = Simulation(load_configuration(name, changes), seed)
        if request.param == "python":
            hosted = simulation.autopilot.library
            rig = Rig(hosted.file, hosted.state, simulation)
        else:
            file = exported(name, changes)
            size = load(file).drawbar_state_size() // 8
            rig = Rig(file, (ctypes.c_double * size)(), simulation)
        rig.repair()
        made.append(rig)
        return rig

    def make_of_spoilt_sources(name: str, *changes: str, seed: int = 0) -> Rig:
        # not for longer than that: tests of other folders run in this process while the fixture lives
        with pytest.MonkeyPatch.context() as patch:
            for module in (compiled_cache, sources, manifest):
                patch.setattr(module, "runtime_sources", lambda: texts)
            return make(name, *changes, seed=seed)

    yield make_of_spoilt_sources
    for each in made:  # the process keeps their libraries, and an export drives one of them
        each.repair()
