"""The exported library in this process, built as Python's own: it does what that does."""

import ctypes
import ctypes.util
import platform
import re
import shutil
import subprocess
import sys
from dataclasses import astuple, replace
from itertools import islice

import numpy as np
import pytest

from drawbar.codegen.compiler import find_compiler
from drawbar.signals import Flag, Status

ROUNDING = {"x86_64": (0x400, 0x800, 0xC00), "aarch64": (0x800000, 0x400000, 0xC00000)}
"""down, up and towards zero, as fesetround() is told by the machine's <fenv.h>; to the nearest is 0"""


@pytest.fixture(scope="module")
def library(exported, compiled):
    return compiled(exported("articulated"))


@pytest.fixture(scope="module")
def simulation(build):
    with build("articulated") as simulation:
        yield simulation


@pytest.fixture(scope="module")
def records(simulation):
    """Return the first eight seconds of a run by the Python product."""
    return list(islice(simulation.steps(), 40))


@pytest.fixture
def begun(library, simulation, records):
    """Return the library as it is a second before the last of those."""
    library.drive(simulation.path, [record.measurement for record in records[:35]])
    return library


def test_commands_are_those_of_the_python_product(library, simulation, records) -> None:
    commands, statuses = library.drive(simulation.path, [record.measurement for record in records])
    assert set(statuses) == {0}
    assert commands == [record.command for record in records]


def test_one_state_does_not_know_of_another(library, simulation, records) -> None:
    measurements = [record.measurement for record in records]
    alone, _ = library.drive(simulation.path, measurements)
    other = type(library)(library.file)
    other.begin(simulation.path)
    library.begin(simulation.path)
    together = []
    for measurement in measurements:
        together.append(library.step(measurement)[0])
        other.step(replace(measurement, hitch_angle=0.5))
    assert together == alone


def test_a_copy_of_the_state_goes_on_as_the_original_would(library, simulation, records) -> None:
    """Beside the path: how far is remembered in the state, and the step knows where that is."""
    measurements = [record.measurement for record in records]
    commands = []
    for copied in (False, True):
        library.begin(simulation.path)
        assert library.call("set_offset", ctypes.c_double(0.02)) == Status.OK
        of_run = [library.step(each) for each in measurements[:20]]
        if copied:
            original, library.state = library.state, type(library.state).from_buffer_copy(library.state)
            ctypes.memset(original, 0xFF, ctypes.sizeof(original))
        commands.append(of_run + [library.step(each) for each in measurements[20:]])
    assert commands[0] == commands[1]
    assert len({status for _, status in commands[0]}) == 1


@pytest.mark.parametrize("mode", ROUNDING.get(platform.machine(), ()))
def test_a_caller_may_round_otherwise(library, simulation, records, mode: int) -> None:
    """Towards infinity angles were a whole turn astray."""
    set_rounding = ctypes.CDLL(ctypes.util.find_library("m")).fesetround
    rounding = type(library)(library.file)

    def call(name: str, *arguments: object) -> int:
        assert set_rounding(mode) == 0
        try:
            return library.call(name, *arguments)
        finally:
            set_rounding(0)

    rounding.call = call
    measurements = [record.measurement for record in records]
    commands, statuses = library.drive(simulation.path, measurements)
    rounded, rounded_statuses = rounding.drive(simulation.path, measurements)
    assert rounded_statuses == statuses
    assert rounded != commands
    np.testing.assert_allclose(list(map(astuple, rounded)), list(map(astuple, commands)), rtol=0.0, atol=1e-8)


def test_a_component_knows_every_setting_after_it_is_initialised(library, build) -> None:
    for component in build("articulated").autopilot.library.components.values():
        component.live.memory[:] = 0xFF
        memory = component.live.memory.ctypes.data_as(ctypes.c_void_p)
        getattr(library.functions, f"drawbar_{component.name}_initialise")(memory)
        expected = component.settings.settings()
        for name, array in component.live.settings().items():
            assert array.tobytes() == expected[name].tobytes(), f"{component.name}: {name}"


def test_the_step_knows_its_settings_after_it_is_initialised(begun, records) -> None:
    """Its own numbers are in no component: the speed that may be set, and how fast it is approached."""
    assert begun.call("set_speed", ctypes.c_double(1.01)) == Status.RANGE
    assert begun.call("set_speed", ctypes.c_double(0.7)) == Status.OK
    speeds = [begun.step(record.measurement)[0].speed for record in records[35:]]
    assert speeds == pytest.approx([0.9, 0.8, 0.7, 0.7, 0.7], rel=1e-12)


def test_a_run_goes_on_along_another_path(begun, simulation, records) -> None:
    nodes = simulation.path.nodes.copy()
    address, at = nodes.ctypes.data_as(ctypes.c_void_p), ctypes.c_double(records[34].reference.tractor.progress)
    assert begun.call("change_path", address, len(nodes), ctypes.c_double(20.0)) == Status.ELSEWHERE
    assert begun.call("change_path", address, len(nodes), at) == Status.OK
    assert [begun.step(record.measurement) for record in records[35:]] == [(each.command, 0) for each in records[35:]]


def test_a_line_beside_the_path_is_driven_as_python_does(library, simulation, records, build) -> None:
    python = build("articulated").autopilot
    python.begin(simulation.path)
    library.begin(simulation.path)
    for step, record in enumerate(records):
        if step in (5, 8, 30):
            offset = {5: 0.3, 8: -0.1, 30: 0.0}[step]
            assert library.call("set_offset", ctypes.c_double(offset)) == Status.OK
            python.set_offset(offset)
        command, status = library.step(record.measurement)
        assert (Status.OK if status < Status.REFUSED else status, command) == python.feedback(record.measurement)
        python.prepare()
    assert library.call("set_offset", ctypes.c_double(7.0)) == Status.RANGE


def test_a_run_begins_where_it_is_told_to(library, simulation, records) -> None:
    library.begin(simulation.path)
    first = records[20].measurement
    assert library.step(first)[1] == Status.OK
    assert library.call("begin_at", ctypes.c_double(1.0)) == Status.ORDER
    library.begin(simulation.path)
    assert library.call("begin_at", ctypes.c_double(simulation.path.length)) == Status.RANGE
    assert library.call("begin_at", ctypes.c_double(20.0)) == Status.OK
    assert library.step(first)[1] == Status.START
    assert library.call("begin_at", ctypes.c_double(records[20].reference.tractor.progress)) == Status.OK
    assert library.step(first)[1] == Status.OK


def test_says_what_it_is(library, exported) -> None:
    header = (exported("articulated") / "include" / "drawbar_size.h").read_text("utf-8")
    version = library.functions.drawbar_version().decode()
    assert re.fullmatch(r"drawbar \S+ [0-9a-f]{16} double", version)
    assert re.findall(r'^#define DRAWBAR_VERSION "(.*)"$', header, re.MULTILINE) == [version]


def test_the_state_of_another_export_is_none_here(begun, exported, compiled) -> None:
    other = compiled(exported("pure-pursuit-pi"), ("-std=c99", "-O0", "-fPIC", "-shared"))
    assert other.functions.drawbar_prepare(begun.state) == Status.NOT_INITIALISED
    assert other.functions.drawbar_set_speed(begun.state, ctypes.c_double(0.5)) == Status.NOT_INITIALISED
    assert begun.call("set_speed", ctypes.c_double(0.5)) == Status.OK


def test_a_library_does_not_call_another_in_the_same_program(exported, compiled) -> None:
    """The first is linked with the program, so that its functions go before those of the second, of the same names."""
    flags = ("-std=c99", "-O0", "-fPIC", "-fvisibility=hidden", "-shared")
    files = [str(compiled(exported(name), flags).file) for name in ("lqr-pi", "pure-pursuit-pi")]
    script = f"""if True:
        from ctypes import CDLL, RTLD_GLOBAL, c_double
        first, second = CDLL({files[0]!r}, RTLD_GLOBAL), CDLL({files[1]!r})
        state = (c_double * (second.drawbar_state_size() // 8))()
        assert second.drawbar_init(state) == 0
        print(second.drawbar_step(state, (c_double * 27)(), (c_double * 4)()))
    """
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert int(said) == Status.NO_PATH


def test_the_example_does_not_go_on_with_headers_of_another_export(library, exported, tmp_path) -> None:
    folder, headers = exported("articulated"), tmp_path / "include"
    shutil.copytree(folder / "include", headers)
    size = headers / "drawbar_size.h"
    for text, code in ((size.read_text("utf-8"), 0), (size.read_text("utf-8").replace(" double", " single"), 2)):
        size.write_text(text, "utf-8")
        example = [str(folder / "example" / "main.c"), str(library.file), "-lm", "-o", str(tmp_path / "example")]
        subprocess.run([*find_compiler(), "-O0", f"-I{headers}", *example], check=True)
        tables = ["measurements.csv", "path.csv"]
        done = subprocess.run(
            [tmp_path / "example", *tables], cwd=folder / "example", capture_output=True, text=True, check=False
        )
        assert done.returncode == code
    assert "compiled for drawbar" in done.stderr


def test_says_what_each_status_and_each_flag_means(library) -> None:
    said = library.functions.drawbar_status_text
    texts = [said(status) for status in Status] + [said(flag) for flag in Flag]
    assert texts[: len(Status)] == [status.text.encode() for status in Status]
    assert texts[len(Status) :] == [f"a new command; {flag.text}".encode() for flag in Flag]
    assert said(Flag.LATE | Flag.SLOWED) not in texts
    assert said(max(Status) + 1) == said(-1) not in texts
