"""The library in single precision: what of its text changes, and how accurately it drives.

`pytest -s tests/export/test_precision.py` prints the figures of docs/export.md.
"""

import ctypes
import shutil
import subprocess
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from single_layout import SingleLayout

from drawbar.codegen import build as build_library
from drawbar.codegen.cache import runtime_sources
from drawbar.codegen.compiler import find_compiler
from drawbar.export import precision
from drawbar.export.precision import single, single_text
from drawbar.export.targets import Precision
from drawbar.geometry import Floats
from drawbar.guidance.importers.line import RecordedLine
from drawbar.guidance.path import Path as DrivenPath
from drawbar.guidance.settings import LineLimits
from drawbar.guidance.smoothing import make_drivable
from drawbar.report.path_errors import project_track
from drawbar.signals import Command, Measurement, Status, Truth
from drawbar.simulation import Simulation

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared")
FAR = 5000.0
"""m east and north of the origin, where a float's digits are half a millimetre apart"""
RUNS = {
    "nothing happens": (),
    "fixes lost": ("machine.events=[{kind='gps_loss', start=20, duration=6}]",),
    "3 m beside": ("start.left=3.0",),
}
TWINS = (0.0, 1e-6, -1e-6, 1e-5)
"""m further to the left, where the product's own runs begin. Sensors round, so two runs that begin a nanometre apart
are millimetres apart after ten seconds, and so are those of one text on two processors: the largest error of the
product itself spans 6 mm over these."""
NOT_INITIALISED, SETTINGS, ACTUATE_UNALIGNED = 65, 66, 67
"""enum drawbar_actuate_status"""
LINE_POINTS, LINE_UNALIGNED = 2, 6
"""enum drawbar_line_status"""
SETTLED = 100
"""steps until the vehicle is on the path"""
MEASUREMENT, COMMAND = SingleLayout(Measurement), SingleLayout(Command)


def test_numbers_types_and_functions_change() -> None:
    text = "double x = fabs(1.5 * y) + 1e-3, z[2] = {0.0, 1e300}; int n = 2; f(DBL_MAX, 1e-100, sizeof(double));"
    assert single_text(text) == (
        "float x = fabsf(1.5f * y) + 1e-3f, z[2] = {0.0f, 3e38f}; int n = 2; f(FLT_MAX, 1.2e-38f, sizeof(float));"
    )


@pytest.mark.parametrize(
    "text",
    [
        "/* a double of 1.5, fabs(x) */",
        'const char *text = "1.0 double";',
        "double time;",
        "int f(const double time);",
        "typedef double time_stamp;",
        "typedef double wide;",
        "double memory[12];",
        "int32_t x1 = 0x10, e5 = a.b1;",
    ],
)
def test_comments_texts_times_and_memory_stay(text: str) -> None:
    assert single_text(text) == text


def test_tolerances_are_those_of_single_precision() -> None:
    assert single_text("#define CHECK_TOLERANCE 1e-8\n") == "#define CHECK_TOLERANCE 1e-3f\n"
    with pytest.raises(LookupError, match=r"CHECK_TOLERANCE is 1e-9, no longer 1e-8"):
        single_text("#define CHECK_TOLERANCE 1e-9\n")


def test_every_tolerance_is_still_defined(exported: Callable[..., Path]) -> None:
    texts = "".join(file.read_text("utf-8") for file in (exported("articulated") / "src").iterdir())
    # the actuation's dead time is not part of this configuration
    missing = {name for name in precision.TOLERANCES if f"#define {name} " not in texts}
    assert missing <= {"WHOLE_SAMPLES"}


def test_sines_in_single_precision() -> None:
    text = """
#include "lanes.h"
void sines(const float *x, float *y, int n) { for (int i = 0; i < n; ++i) y[i] = lane_sin(x[i]); }
void cosines(const float *x, float *y, int n) { for (int i = 0; i < n; ++i) y[i] = lane_cos(x[i]); }
void angles(const float *x, float *y, int n) { for (int i = 0; i < n; ++i) y[i] = lane_atan(x[i]); }
"""
    files = single({"unit.c": text, "lanes.h": runtime_sources()["lanes.h"], "lane_trigonometry.h": ""})
    library = ctypes.CDLL(str(build_library("single_lanes", files, FLAGS)))
    x = np.random.default_rng(1).uniform(-1e3, 1e3, 100_000).astype(np.float32)
    for name, exact in (("sines", np.sin), ("cosines", np.cos)):
        y = np.empty_like(x)
        library[name](x.ctypes.data_as(ctypes.c_void_p), y.ctypes.data_as(ctypes.c_void_p), len(x))
        assert np.max(np.abs(y - exact(x.astype(np.float64)))) < 1e-7
    x = np.tan(np.linspace(-1.57, 1.57, 100_000)).astype(np.float32)
    library["angles"](x.ctypes.data_as(ctypes.c_void_p), y.ctypes.data_as(ctypes.c_void_p), len(x))
    exact_angles = np.arctan(x.astype(np.float64))
    assert np.max(np.abs(y / exact_angles - 1)) < 3e-7


class SingleAutopilot:
    """The exported library in the place of a simulation's autopilot, as far as the loop here needs it."""

    def __init__(self, file: Path) -> None:
        self._library = ctypes.CDLL(str(file))
        self._state = (ctypes.c_double * (self._library.drawbar_state_size() // 8))()
        self._given, self._taken = MEASUREMENT.buffer(), COMMAND.buffer()

    def begin(self, path: DrivenPath) -> int:
        self._nodes = path.nodes.astype(np.float32)  # the library keeps no copy
        assert self._library.drawbar_init(self._state) == 0
        nodes = self._nodes.ctypes.data_as(ctypes.c_void_p)
        return int(self._library.drawbar_set_path(self._state, nodes, len(self._nodes)))

    def step(self, measurement: Measurement) -> tuple[int, Command]:
        MEASUREMENT.pack(self._given, measurement)
        status = self._library.drawbar_step(self._state, self._given, self._taken)
        return status, COMMAND.unpack(self._taken)

    def call(self, name: str, *arguments: object) -> int:
        return int(getattr(self._library, f"drawbar_{name}")(*arguments))

    def call_on_state(self, name: str, *arguments: object) -> int:
        return self.call(name, self._state, *arguments)

    def line(self, points: Floats, limits: tuple[float, ...]) -> tuple[int, int, Floats]:
        """Return what drawbar_line_path returns, what drawbar_set_path then does, and the nodes."""
        given, room = points.astype(np.float32), 20_000
        self._nodes, work, made = np.empty((room, 4), np.float32), np.empty((room, 6)), ctypes.c_int32()
        arrays = (each.ctypes.data_as(ctypes.c_void_p) for each in (np.float32(limits), self._nodes, work))
        status = self._library.drawbar_line_path(
            given.ctypes.data_as(ctypes.c_void_p), len(given), *arrays, room, ctypes.byref(made)
        )
        assert self._library.drawbar_init(self._state) == 0
        nodes = self._nodes.ctypes.data_as(ctypes.c_void_p)
        taken = int(self._library.drawbar_set_path(self._state, nodes, made.value))
        return status, taken, self._nodes[: made.value].astype(np.float64)


def driven(simulation: Simulation, library: SingleAutopilot) -> tuple[Counter[int], Floats]:
    """Drive to the end; returns what the steps said, and (m, 4) the true places of both bodies, m."""
    statuses, places = Counter[int](), []
    assert library.begin(simulation.path) == Status.OK
    with simulation.machine as machine:
        for _ in range(4000):
            status, command = library.step(machine.read())
            machine.write(command)
            if status >= Status.FINISHED:
                break
            statuses[status] += 1
            places.append(place(machine.truth()))
    return statuses, np.array(places)


def driven_by_product(simulation: Simulation) -> tuple[Counter[int], Floats]:
    """Return the same of the product."""
    records = list(simulation.steps())
    said_so = (each.flags if each.status.is_new_command else each.status for each in records)
    return Counter(map(int, said_so)), np.array([place(each.truth) for each in records])


def place(truth: Truth) -> tuple[float, ...]:
    return truth.tractor.x, truth.tractor.y, truth.trailer.x, truth.trailer.y


def errors(path: DrivenPath, places: Floats) -> Floats:
    """Return root mean square and largest distance from the path, of tractor and trailer, once settled, mm."""
    found = []
    for x, y in ((0, 1), (2, 3)):
        lateral = 1e3 * project_track(path, places[:, x], places[:, y], 0.0).error[SETTLED:]
        found += [np.sqrt(np.mean(lateral**2)), np.max(np.abs(lateral))]
    return np.array(found)


@pytest.fixture(scope="module")
def library(exported: Callable[..., Path]) -> SingleAutopilot:
    folder = exported("articulated", precision=Precision.SINGLE)
    sources = map(str, sorted((folder / "src").glob("*.c")))
    file = folder / "single.so"
    subprocess.run(
        [*find_compiler(), *FLAGS, "-w", f"-I{folder / 'include'}", *sources, "-lm", "-o", str(file)], check=True
    )
    return SingleAutopilot(file)


@pytest.mark.parametrize("run", RUNS)
def test_drives_as_the_product_does(run: str, library: SingleAutopilot, build: Callable[..., Simulation]) -> None:
    changed = build("articulated", *RUNS[run])
    path, left = changed.path, changed.configuration.start.left
    of_single, also = driven(changed, library)
    single, product = errors(path, also), []
    for beside in TWINS:
        of_product, places = driven_by_product(build("articulated", *RUNS[run], f"start.left={left + beside}"))
        assert of_single == of_product
        product.append(errors(path, places))
    for name, figures in (("double", product[0]), ("single", single)):
        print(f"\n| {run} | {name} | {' | '.join(f'{each:.1f}' for each in figures)} |", end="")
    assert np.max(np.abs(single - np.mean(product, axis=0))[::2]) < 1.0
    assert np.max((single - np.max(product, axis=0))[1::2]) < 5.0  # smaller is no fault


def test_far_from_the_origin(library: SingleAutopilot, build: Callable[..., Simulation]) -> None:
    near = build("articulated")
    nodes = near.path.nodes + np.array([0.0, FAR, FAR, 0.0])
    far = Simulation(near.configuration, path=replace(near.path, nodes=nodes))
    statuses, places = driven(far, library)
    figures = errors(far.path, places)
    print(f"\n| {FAR:g} m east and north | single | {' | '.join(f'{each:.1f}' for each in figures)} |")
    assert set(statuses) == {0}
    assert np.max(figures[::2]) < 25.0


def test_a_path_too_far_from_the_origin_is_refused(library: SingleAutopilot, build: Callable[..., Simulation]) -> None:
    path = build("articulated").path
    assert library.begin(replace(path, nodes=path.nodes + np.array([0.0, 2e4, 0.0, 0.0]))) == Status.PATH


def test_what_holds_a_time_stamp_is_aligned_as_a_double_the_rest_as_floats(
    library: SingleAutopilot, build: Callable[..., Simulation]
) -> None:
    nodes = build("articulated").path.nodes
    moved, room = np.zeros(nodes.size + 1, np.float32), (ctypes.c_double * 600)()
    moved[1:] = nodes.ravel()
    path = ctypes.c_void_p(moved.ctypes.data + 4)
    odd, numbers = ctypes.c_void_p(ctypes.addressof(room) + 4), (ctypes.c_double * 400)()
    library.call_on_state("init")
    assert library.call_on_state("set_path", path, len(nodes)) == Status.OK
    assert [library.call_on_state(f"get_{name}", odd) for name in ("diagnostics", "actuation")] == [Status.OK] * 2
    assert library.call("actuate_init", numbers, odd) == SETTINGS
    assert library.call("actuate", numbers, numbers, odd) == NOT_INITIALISED
    assert library.call_on_state("step", odd, numbers) == Status.UNALIGNED
    assert library.call_on_state("step", numbers, odd) == Status.UNALIGNED
    assert library.call_on_state("get_estimate", odd) == Status.UNALIGNED
    assert library.call("actuate", numbers, odd, room) == ACTUATE_UNALIGNED
    assert library.call("line_path", odd, 2, odd, odd, numbers, 9, odd) == LINE_POINTS
    assert library.call("line_path", odd, 2, odd, odd, odd, 9, odd) == LINE_UNALIGNED


@pytest.mark.parametrize("numbers", Precision)
def test_what_every_measurement_begins_as_promotes_no_float(
    exported: Callable[..., Path], numbers: Precision, tmp_path: Path
) -> None:
    """A caller looks for doubles by mistake where they cost a function's call."""
    compiler = next(filter(shutil.which, ("clang-14", "clang")), None)
    if compiler is None:
        pytest.skip("clang is not installed")
    include = exported("articulated", precision=numbers) / "include"
    (tmp_path / "caller.c").write_text(
        '#include "drawbar.h"\nextern const struct drawbar_measurement first;\n'
        "const struct drawbar_measurement first = DRAWBAR_NOTHING_MEASURED;\n",
        "utf-8",
    )
    strict = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror", "-fsyntax-only")
    done = subprocess.run([compiler, *strict, f"-I{include}", str(tmp_path / "caller.c")], check=False)
    assert done.returncode == 0


@pytest.mark.parametrize("away", [0.0, FAR])
def test_a_recorded_line_of_two_kilometres_becomes_its_path(library: SingleAutopilot, away: float) -> None:
    """Whole numbers of centimetres, as the recorded points are the same in both precisions then."""
    x = np.arange(0.0, 2000.0, 0.7)
    points = np.round(np.column_stack([x, 8.0 * np.sin(x / 30.0)]), 2)
    limits = (0.3, 0.3, 0.05)
    line = RecordedLine(name="line", x=points[:, 0], y=points[:, 1], frame=None)
    expected = make_drivable(line, LineLimits(curvature=limits[0], curvature_rate=limits[1], tolerance=limits[2]))
    status, taken, nodes = library.line(points + away, limits)
    assert (status, taken) == (0, Status.OK)
    difference = np.max(np.abs(nodes - expected.path.nodes - [0.0, away, away, 0.0]), axis=0)
    assert (difference < [5e-3, 1e-3, 1e-3, 1e-3]).all(), "m along, m east, m north, rad"


def test_a_recorded_line_too_far_from_the_origin_is_refused(library: SingleAutopilot) -> None:
    points = np.column_stack([np.arange(0.0, 50.0), np.zeros(50)])
    assert library.line(points + 9_000.0, (0.3, 0.3, 0.05))[0] == 0
    assert library.line(points + 10_000.0, (0.3, 0.3, 0.05))[0] == 2
