"""The exported library in this process, built as Python's own solvers are: it does what they do."""

from dataclasses import replace
from itertools import islice

import pytest

from drawbar.export.units import units_of
from drawbar.simulation import drive


@pytest.fixture(scope="module")
def library(exported, compiled):
    return compiled(exported("articulated"))


@pytest.fixture(scope="module")
def records(build):
    """Return the first eight seconds of a run by the Python product."""
    return list(islice(drive(build("articulated"), time_limit=100.0), 40))


def test_commands_are_those_of_the_python_product(library, build, records) -> None:
    path = build("articulated").guidance.path
    commands, statuses = library.drive(path, [record.measurement for record in records])
    assert set(statuses) == {0}
    for command, record in zip(commands, records, strict=True):
        assert command.tractor_steering == pytest.approx(record.command.tractor_steering, rel=0.0, abs=1e-12)
        assert command.trailer_steering == pytest.approx(record.command.trailer_steering, rel=0.0, abs=1e-12)


def test_one_state_does_not_know_of_another(library, build, records) -> None:
    path = build("articulated").guidance.path
    measurements = [record.measurement for record in records]
    alone, _ = library.drive(path, measurements)
    other = type(library)(library.file)
    other.begin(path)
    library.begin(path)
    together = []
    for measurement in measurements:
        together.append(library.step(measurement)[0])
        other.step(replace(measurement, hitch_angle=0.5))
    assert together == alone


def test_a_part_knows_every_setting_after_it_is_initialised(library, build) -> None:
    for unit in units_of(build("articulated")):
        settings = {name: array.copy() for name, array in unit.workspace.settings().items()}
        unit.workspace.memory[:] = 0xFF
        library.functions[f"drawbar_{unit.name}_initialise"](unit.workspace.memory.ctypes.data_as(library.ADDRESS))
        for name, array in unit.workspace.settings().items():
            assert array.tobytes() == settings[name].tobytes(), f"{unit.name}: {name}"


def test_says_what_it_is(library) -> None:
    assert library.functions.drawbar_version().startswith(b"drawbar ")
    assert library.functions.drawbar_status_text(0) == b"a new command"
