"""The step of an exported library, between real gate and supervisor and components that do what a measurement says."""

import ctypes
import math
import subprocess
from pathlib import Path

import numpy as np
import pytest

from drawbar.codegen.cache import runtime_sources
from drawbar.codegen.compiler import find_compiler
from drawbar.exchange import Layout
from drawbar.signals import Diagnostics, Estimate, Flag, Measurement, Status

HERE = Path(__file__).parent
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")
SAMPLE, PATIENCE, ENDURANCE, LENGTH = 0.2, 1.0, 3.0, 10.0
NAMES = (
    *("ALIGNMENT", "ESTIMATOR", "GUIDANCE", "PREDICTOR", "TRACTOR", "TRAILER"),
    *("TRACTOR_LAW", "TRAILER_LAW", "GATE", "SUPERVISOR"),
)
PARTS = "\n".join(f"#define DRAWBAR_{name}_SIZE 256" for name in (*NAMES, "WORK"))
UNITS = {
    "drawbar_size.h": f"#define DRAWBAR_STATE_DOUBLES 512\n#define DRAWBAR_SAMPLE_TIME {SAMPLE}\n",
    "drawbar_components.h": f"{PARTS}\n#define DRAWBAR_DEAD_TIME\n"
    f"#define DRAWBAR_STEP_SETTINGS {{{SAMPLE}, 1.0, 1.0, 0.5, {PATIENCE}, {ENDURANCE}}}\n"
    '#define DRAWBAR_VERSION "of this test"\n',
    "step.c": '#include "step.h"\n',
    "gate.c": """
#define UNIT(name) drawbar_gate_##name
#include <string.h>
#include "gate.h"
int UNIT(initialise)(struct component *component)
{
    const struct component gate = {
        .limits = {0.5, 0.4}, .signs = {1.0, 1.0}, .rates = {1.0, 1.0}, .lag = 0.1, .sample_time = 0.2,
        .speed_limit = 1.0, .patience = 1.0, .repeats = 4
    };
    memcpy(component, &gate, sizeof gate);
    return 0;
}
""",
    "supervisor.c": """
#define UNIT(name) drawbar_supervisor_##name
#include <string.h>
#include "supervisor.h"
int UNIT(initialise)(struct component *component)
{
    const struct component supervisor = {.lost = 5.0, .blind = 2.0};
    memcpy(component, &supervisor, sizeof supervisor);
    return 0;
}
""",
    "components.c": (HERE / "components.c").read_text(),
}
STATUS = {member.name: member.value for kind in (Status, Flag) for member in kind}
NAMES_OF = {
    "time": "time",
    "tractor_x": "progress",
    "tractor_y": "lateral_error",
    "trailer_x": "controllers",
    "trailer_y": "estimator",
    "hitch_angle": "fixes",
    "speed": "guidance",
    "tractor_steering": "tractor_steering",
    "trailer_steering": "trailer_steering",
}
"""how the components here read a measurement"""
MEASURED = tuple(NAMES_OF.values())
MEASUREMENT, ESTIMATE, DIAGNOSTICS = Layout(Measurement), Layout(Estimate), Layout(Diagnostics)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    folder = tmp_path_factory.mktemp("step")
    for name, text in {**runtime_sources(), **UNITS}.items():
        (folder / name).write_text(text)
    built = folder / "step.so"
    sources = [str(folder / name) for name in UNITS if name.endswith(".c")]
    flags = ("-std=c99", "-O1", "-fPIC", "-shared", *WARNINGS)
    subprocess.run([*find_compiler(), *flags, "-o", str(built), *sources, "-lm"], check=True)
    loaded = ctypes.CDLL(str(built))
    loaded.drawbar_status_text.restype = loaded.drawbar_version.restype = ctypes.c_char_p
    return loaded


class Driver:
    """A state with a straight path, and everything a caller does with it."""

    def __init__(self, library):
        self.library = library
        self.state = (ctypes.c_double * 512)()
        arc = np.linspace(0.0, LENGTH, 41)
        self.nodes = np.column_stack([arc, arc, 0.0 * arc, 0.0 * arc])
        self.command = (ctypes.c_double * 4)()
        self.time = 100.0
        assert library.drawbar_init(self.state) == 0
        assert self.set_path() == 0

    def set_path(self):
        return self.library.drawbar_set_path(self.state, ctypes.c_void_p(self.nodes.ctypes.data), len(self.nodes))

    def measurement(self, *, elapsed=SAMPLE, **values):
        self.time += elapsed
        known = {**dict.fromkeys(MEASURED, 0.0), "time": self.time, **values}
        given = MEASUREMENT.buffer()
        MEASUREMENT.pack(given, Measurement(**{name: known[alias] for name, alias in NAMES_OF.items()}))
        return given

    def feedback(self, **values):
        return self.library.drawbar_feedback(self.state, self.measurement(**values), self.command)

    def prepare(self):
        return self.library.drawbar_prepare(self.state)

    def step(self, **values):
        """Return status and command (time, both steering angles, speed) of one step."""
        status = self.library.drawbar_step(self.state, self.measurement(**values), self.command)
        return status, list(self.command)

    def calls(self):
        made = ctypes.c_char * 64
        return made.in_dll(self.library, "calls")


@pytest.fixture
def driver(library):
    return Driver(library)


def statuses(driver, count, **values):
    return [driver.step(**values)[0] for _ in range(count)]


def test_one_step_is_the_block_diagram(driver):
    ctypes.memset(driver.calls(), 0, 64)
    assert driver.feedback() == 0
    assert driver.calls().value == b"mbBMeagtrs"
    assert driver.prepare() == 0
    assert driver.calls().value == b"mbBMeagtrsETR"
    assert driver.step()[0] == 0
    assert driver.calls().value == b"mbBMeagtrsETRMeagtrsETR"  # a run begins once


def test_a_command_is_what_the_laws_and_the_gate_made(driver):
    assert driver.step(tractor_steering=0.2, trailer_steering=-0.1) == (0, [driver.time, 0.2, -0.1, 1.0])
    status, command = driver.step(tractor_steering=0.45, trailer_steering=-0.1)
    assert (status, command) == (0, [driver.time, 0.45, -0.1, 1.0])
    status, command = driver.step(tractor_steering=-0.45, trailer_steering=-0.1)
    assert status == STATUS["LIMITED"]
    wheels = 0.45 - 0.1 * math.exp(-0.5)  # open for 0.15 s, then within the lag
    assert command == pytest.approx([driver.time, wheels - 0.3, -0.1, 1.0])


@pytest.mark.parametrize("part", ["controllers", "estimator"])
def test_a_solvers_failure_shows_and_its_command_counts(driver, part):
    status, command = driver.step(**{part: 4.0}, tractor_steering=0.1)
    assert (status, command) == (STATUS["SOLVER"], [driver.time, 0.1, 0.0, 1.0])
    assert driver.step()[0] == 0


def told_by(driver):
    told = DIAGNOSTICS.buffer()
    assert driver.library.drawbar_get_diagnostics(driver.state, told) == 0
    return DIAGNOSTICS.unpack(told)


def test_estimate_and_diagnostics_tell_of_the_last_step(driver):
    driver.step(progress=3.0, lateral_error=-0.5, controllers=2.0, estimator=4.0, fixes=1.0, tractor_steering=0.2)
    estimate = ESTIMATE.buffer()
    assert driver.library.drawbar_get_estimate(driver.state, estimate) == 0
    assert estimate[0] == driver.time
    told = told_by(driver)
    body = told.tractor
    assert (body.progress, body.lateral_error, body.nominal, body.ancillary, body.margin) == (3.0, -0.5, 0.2, 0.0, 0.25)
    assert (body.saturated, body.solver, body.fix) == (False, 2, 1)
    assert (told.estimator, told.gate, told.flags, told.missing) == (4, 0, Flag.SOLVER, 0)
    assert (told.speed, told.unsolved) == (1.0, SAMPLE)


@pytest.mark.parametrize("wrong", [math.inf, -math.inf, 1e8])
@pytest.mark.parametrize("name", MEASURED[1:])
def test_an_absurd_value_is_missing(driver, name, wrong):
    driver.step()
    status, command = driver.step(**{name: wrong})
    assert told_by(driver).missing == 1
    assert np.isfinite(command).all()
    expected = {
        "lateral_error": "OFF_COURSE",  # of a position that nobody knows
        "tractor_steering": "REFUSED",  # the components here command what they measure
        "trailer_steering": "REFUSED",
    }
    assert status == STATUS[expected.get(name, "MEASUREMENT")]


def test_a_refused_command_is_repeated_then_the_vehicle_stops_for_good(driver):
    driver.step(tractor_steering=0.2)
    for _ in range(4):
        assert driver.step(tractor_steering=math.nan) == (STATUS["REFUSED"], [driver.time, 0.2, 0.0, 1.0])
    stop = (STATUS["STOPPED"], [0.2, 0.0, 0.0])
    for wish in (math.nan, 0.1, 0.1):
        status, command = driver.step(tractor_steering=wish)
        assert (status, command[1:]) == stop
    assert driver.set_path() == 0
    assert driver.step(tractor_steering=0.1) == (0, [driver.time, 0.1, 0.0, 1.0])


@pytest.mark.parametrize("wrong", [100.2, 100.1, -1e300, math.nan, math.inf])
def test_a_time_that_does_not_go_on_is_refused(driver, wrong):
    driver.step(tractor_steering=0.2, time=100.2)
    assert driver.step(tractor_steering=0.1, time=wrong) == (STATUS["TIME"], [100.2, 0.2, 0.0, 1.0])
    assert driver.step(tractor_steering=0.1, time=100.4) == (0, [100.4, 0.1, 0.0, 1.0])


def test_a_clock_that_stands_still_stops_the_vehicle(driver):
    driver.step(tractor_steering=0.2)
    assert statuses(driver, 6, elapsed=0.0) == [STATUS["TIME"]] * 4 + [STATUS["STOPPED"]] * 2
    assert driver.command[3] == 0.0


def test_samples_left_out_are_told_and_many_end_the_run(driver):
    driver.step(tractor_steering=0.1)
    assert [driver.step(elapsed=gap)[0] for gap in (0.05, 0.29, 0.31)] == [0, 0, Flag.LATE]
    assert driver.step(elapsed=1.05)[0] == Flag.LATE | Flag.SLOWED
    status, command = driver.step(elapsed=1.15)
    assert (status, command) == (STATUS["GAP"], [driver.time, 0.0, 0.0, 0.0])
    assert driver.step()[0] == STATUS["GAP"]


def test_a_run_begins_as_soon_as_it_can(driver):
    stand = [0.0, 0.0, 0.0]
    for values, expected in (({"progress": math.nan}, "POSITION"), ({"progress": -1.0}, "START")):
        for _ in range(10):  # waiting is no failure
            status, command = driver.step(**values, elapsed=7.0)
            assert (status, command[1:]) == (STATUS[expected], stand)
    assert driver.step(elapsed=7.0)[0] == 0


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"lateral_error": 5.1}, "OFF_COURSE"),
        ({"lateral_error": math.nan}, "OFF_COURSE"),
        ({"guidance": 2.0}, "GUIDANCE"),
    ],
)
def test_what_ends_a_run_stops_the_vehicle_where_it_steers(driver, values, expected):
    driver.step(tractor_steering=0.2)
    for wish in (values, {}):  # and it stays so
        status, command = driver.step(**wish, tractor_steering=-0.1)
        assert (status, command[1:]) == (STATUS[expected], [0.2, 0.0, 0.0])


def test_the_end_of_the_path_ends_the_run(driver):
    assert statuses(driver, 3, progress=LENGTH) == [0, STATUS["FINISHED"], STATUS["FINISHED"]]


def test_a_long_time_without_a_fix_ends_the_run(driver):
    driver.step()
    blind = statuses(driver, 12, fixes=1.0)
    assert blind[:9] == [0] * 9
    assert blind[11] == STATUS["BLIND"]


def test_what_stood_still_stays_so_until_there_is_a_new_command(driver):
    driver.step(progress=LENGTH)
    driver.step()
    driver.set_path()
    assert driver.step(progress=math.nan)[1][3] == 0.0


def test_a_new_run_repeats_no_command_of_the_last(driver):
    driver.step(tractor_steering=0.2, trailer_steering=0.1)
    driver.set_path()
    assert driver.step(tractor_steering=math.nan, trailer_steering=-0.1)[1][1:] == [0.0, -0.1, 0.0]


def test_feedback_and_prepare_alternate(driver):
    assert driver.prepare() == STATUS["ORDER"]
    assert driver.feedback(tractor_steering=0.1) == 0
    assert driver.feedback(tractor_steering=0.2) == STATUS["ORDER"]
    assert driver.command[:] == [driver.time - SAMPLE, 0.1, 0.0, 0.0]
    assert driver.prepare() == 0
    assert driver.prepare() == STATUS["ORDER"]
    assert driver.step(elapsed=0.0)[0] == 0
    assert driver.feedback(time=math.nan) == STATUS["TIME"]
    assert driver.prepare() == 0  # of nothing
    assert driver.feedback(elapsed=0.0) == 0


def test_nothing_is_prepared_that_was_not_fed(driver):
    driver.step()
    ctypes.memset(driver.calls(), 0, 64)
    driver.step(elapsed=0.0)
    driver.step(lateral_error=9.0)
    assert driver.calls().value == b"Meag"


@pytest.mark.parametrize("argument", range(3))
@pytest.mark.parametrize("name", ["feedback", "step"])
def test_no_pointer_may_be_null(driver, name, argument):
    arguments = [driver.state, driver.measurement(), driver.command]
    arguments[argument] = None
    driver.command[3] = 1.0
    assert getattr(driver.library, f"drawbar_{name}")(*arguments) == STATUS["NULL"]
    assert driver.command[3] == (1.0 if argument == 2 else 0.0)


def test_a_call_without_a_measurement_holds_the_steering(driver):
    driver.step(tractor_steering=0.1)
    before = bytes(driver.state)
    assert driver.library.drawbar_step(driver.state, None, driver.command) == STATUS["NULL"]
    assert driver.command[1:] == [0.1, 0.0, 0.0]
    assert bytes(driver.state) == before


def test_no_other_pointer_may_be_null_either(driver):
    library, state, nodes = driver.library, driver.state, ctypes.c_void_p(driver.nodes.ctypes.data)
    calls = [
        library.drawbar_init(None),
        library.drawbar_prepare(None),
        library.drawbar_set_path(None, nodes, 41),
        library.drawbar_set_path(state, None, 41),
        library.drawbar_get_estimate(None, state),
        library.drawbar_get_estimate(state, None),
        library.drawbar_get_diagnostics(None, state),
        library.drawbar_get_diagnostics(state, None),
    ]
    assert calls == [STATUS["NULL"]] * len(calls)


def test_a_state_wants_to_be_initialised(driver):
    rng = np.random.default_rng(0)
    driver.state[:] = rng.integers(0, 2**63, 512).view(np.float64).tolist()
    out, nodes = (ctypes.c_double * 64)(), ctypes.c_void_p(driver.nodes.ctypes.data)
    assert driver.step() == (STATUS["NOT_INITIALISED"], [0.0] * 4)
    assert driver.prepare() == STATUS["NOT_INITIALISED"]
    assert driver.library.drawbar_set_path(driver.state, nodes, 41) == STATUS["NOT_INITIALISED"]
    assert driver.library.drawbar_get_estimate(driver.state, out) == STATUS["NOT_INITIALISED"]
    assert driver.library.drawbar_get_diagnostics(driver.state, out) == STATUS["NOT_INITIALISED"]


def test_a_path_that_is_none_is_refused_and_changes_nothing(driver):
    driver.library.drawbar_init(driver.state)
    assert driver.step()[0] == STATUS["NO_PATH"]
    driver.nodes[20, 1] += 1.0
    assert driver.set_path() == STATUS["PATH"]
    assert driver.step()[0] == STATUS["NO_PATH"]
    driver.nodes[20, 1] -= 1.0
    assert driver.set_path() == 0
    assert driver.step()[0] == 0


def test_every_status_has_its_text_and_the_library_its_version(library):
    texts = [library.drawbar_status_text(value) for value in STATUS.values()]
    assert len(set(texts)) == len(texts)
    assert library.drawbar_status_text(-1) == library.drawbar_status_text(1000) == b"no status of this library"
    assert library.drawbar_version() == b"of this test"
    assert library.drawbar_state_size() == 512 * 8


def test_a_late_sample_lets_the_components_catch_up(driver):
    driver.step()
    ctypes.memset(driver.calls(), 0, 64)
    assert driver.step(elapsed=3 * SAMPLE)[0] == Flag.LATE
    assert driver.calls().value == b"sxyzsxyzMeagtrsETR"


def test_flags_are_a_set(driver):
    driver.step(tractor_steering=0.45)
    status, _ = driver.step(elapsed=2 * SAMPLE, tractor_steering=-0.45, estimator=4.0, fixes=math.inf)
    assert status == Flag.LATE | Flag.LIMITED | Flag.SOLVER | Flag.MEASUREMENT
    assert driver.library.drawbar_status_text(status) == b"a new command; several flags are set"
    assert told_by(driver).flags == status


@pytest.mark.parametrize("part", ["controllers", "estimator"])
def test_without_a_solution_the_vehicle_slows_down_and_stops(driver, part):
    driver.step()
    speeds, ends = [], []
    for _ in range(20):
        status, command = driver.step(**{part: 4.0})
        speeds.append(command[3])
        ends.append(status)
    kept, stopped = round(ENDURANCE / 6 / SAMPLE), round(ENDURANCE / SAMPLE)
    assert speeds[:kept] == [1.0] * kept
    assert (np.diff(speeds[kept : stopped - 1]) < 0.0).all()
    assert ends[kept : stopped - 1] == [Flag.SOLVER | Flag.SLOWED] * (stopped - 1 - kept)
    assert ends[stopped - 1 :] == [Status.UNSOLVED] * (len(ends) - stopped + 1)
    assert speeds[stopped - 1 :] == [0.0] * (len(ends) - stopped + 1)


def test_a_solution_in_time_lets_the_vehicle_speed_up_again(driver):
    driver.step()
    slow = [driver.step(estimator=4.0)[1][3] for _ in range(10)][-1]
    assert slow < 0.5
    faster = [driver.step()[1][3] for _ in range(10)]
    assert faster[0] == pytest.approx(slow + 0.5 * SAMPLE)
    assert faster[-1] == 1.0


def test_a_caller_who_is_always_late_is_slowed_and_stopped(driver):
    driver.step()
    ends = statuses(driver, 12, elapsed=0.6)
    assert ends[0] == Flag.LATE
    assert Flag.SLOWED & ends[2]
    assert ends[-1] == Status.OVERDUE
    assert driver.command[3] == 0.0


def test_a_command_is_repeated_for_a_second_by_the_clock_too(driver):
    driver.step(tractor_steering=0.2)
    ends = statuses(driver, 3, elapsed=0.6, tractor_steering=math.nan)
    assert ends == [STATUS["REFUSED"], STATUS["STOPPED"], STATUS["STOPPED"]]


def test_the_speed_can_be_set_within_its_bounds_and_is_approached_by_a_ramp(driver):
    library, speed = driver.library, ctypes.c_double
    driver.step()
    for wrong in (-0.1, 1.01, math.nan, math.inf):
        assert library.drawbar_set_speed(driver.state, speed(wrong)) == STATUS["RANGE"]
    assert driver.step()[1][3] == 1.0
    assert library.drawbar_set_speed(driver.state, speed(0.75)) == 0
    assert [driver.step()[1][3] for _ in range(4)] == pytest.approx([0.9, 0.8, 0.75, 0.75])


def test_a_run_begins_where_it_is_told(driver):
    library, place = driver.library, ctypes.c_double
    for wrong in (-0.1, LENGTH, math.nan):
        assert library.drawbar_begin_at(driver.state, place(wrong)) == STATUS["RANGE"]
    assert library.drawbar_begin_at(driver.state, place(4.0)) == 0
    assert driver.step(progress=3.0)[0] == STATUS["START"]  # the components here begin behind the start only
    assert told_by(driver).start_distance == 1.0
    assert driver.step(progress=4.5)[0] == 0
    assert library.drawbar_begin_at(driver.state, place(4.0)) == STATUS["ORDER"]


def test_the_path_changes_during_a_run_where_the_vehicle_is_on_the_new_one(driver):
    def change(place):
        nodes = ctypes.c_void_p(driver.nodes.ctypes.data)
        return driver.library.drawbar_change_path(driver.state, nodes, len(driver.nodes), ctypes.c_double(place))

    assert change(1.0) == STATUS["NO_RUN"]
    driver.step()
    assert change(1.0) == 0
    assert change(6.0) == STATUS["START"]
    assert change(-1.0) == STATUS["RANGE"]
    assert driver.step()[0] == 0
    driver.nodes[20, 1] += 1.0
    assert change(1.0) == STATUS["PATH"]
