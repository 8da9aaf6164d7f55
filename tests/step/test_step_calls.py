"""The functions of an exported library: their order, wrong calls, and what may be set during a run."""

import ctypes
import math

import numpy as np
import pytest
from step_bench import LENGTH, SAMPLE, STATUS, told_by


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


def test_a_path_that_is_set_ends_the_sample_one_that_is_refused_does_not(driver):
    driver.step()
    driver.feedback()
    driver.nodes[20, 1] += 1.0
    assert driver.set_path() == STATUS["PATH"]
    assert driver.prepare() == 0
    driver.feedback()
    driver.nodes[20, 1] -= 1.0
    assert driver.set_path() == 0
    assert driver.prepare() == STATUS["ORDER"]
    assert driver.feedback() == 0
    assert driver.prepare() == 0


def test_nothing_is_prepared_that_was_not_fed(driver):
    driver.step()
    ctypes.memset(driver.calls(), 0, 64)
    driver.step(elapsed=0.0)
    driver.step(lateral_error=9.0)
    assert driver.calls().value == b"MPeag"


@pytest.mark.parametrize("argument", range(3))
@pytest.mark.parametrize("name", ["feedback", "step"])
def test_no_pointer_may_be_null(driver, name, argument):
    arguments = [driver.state, driver.measurement(), driver.command]
    arguments[argument] = None
    driver.command[3] = 1.0
    assert getattr(driver.library, f"drawbar_{name}")(*arguments) == STATUS["NULL"]
    assert driver.command[3] == (1.0 if argument == 2 else 0.0)


def test_what_is_not_aligned_is_refused_and_not_touched(driver):
    library, room = driver.library, (ctypes.c_double * 600)()
    state, nodes = driver.state, ctypes.c_void_p(driver.nodes.ctypes.data)
    odd, measurement = ctypes.c_void_p(ctypes.addressof(room) + 4), driver.measurement()
    driver.step(tractor_steering=0.1)
    before = bytes(state), bytes(room)
    driver.command[3] = 1.0
    calls = [
        library.drawbar_init(odd),
        library.drawbar_set_path(odd, nodes, 41),
        library.drawbar_set_path(state, odd, 41),
        library.drawbar_change_path(state, odd, 41, ctypes.c_double(0.0)),
        library.drawbar_prepare(odd),
        library.drawbar_set_speed(odd, ctypes.c_double(0.5)),
        library.drawbar_get_estimate(state, odd),
        library.drawbar_get_diagnostics(state, odd),
        library.drawbar_step(state, measurement, odd),
        library.drawbar_step(odd, measurement, driver.command),
    ]
    assert calls == [STATUS["UNALIGNED"]] * len(calls)
    assert driver.command[:] == [0.0] * 4
    assert library.drawbar_step(state, odd, driver.command) == STATUS["UNALIGNED"]
    assert driver.command[1:] == [0.1, 0.0, 0.0]
    assert (bytes(state), bytes(room)) == before


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
    driver.state[:] = rng.integers(0, 2**63, 544).view(np.float64).tolist()
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
    assert library.drawbar_state_size() == 544 * 8


def test_the_speed_can_be_set_within_its_bounds_and_is_approached_by_a_ramp(driver):
    library, speed = driver.library, ctypes.c_double
    driver.step()
    for wrong in (-0.1, 1.01, math.nan, math.inf):
        assert library.drawbar_set_speed(driver.state, speed(wrong)) == STATUS["RANGE"]
    assert driver.step()[1][3] == 1.0
    assert library.drawbar_set_speed(driver.state, speed(0.75)) == 0
    assert [driver.step()[1][3] for _ in range(4)] == pytest.approx([0.9, 0.8, 0.75, 0.75])


def test_an_offset_beyond_its_bounds_changes_nothing(driver):
    library, offset = driver.library, ctypes.c_double
    driver.step()
    before = bytes(driver.state)
    for wrong in (-100.1, 101.0, math.nan, math.inf, -math.inf):
        assert library.drawbar_set_offset(driver.state, offset(wrong)) == STATUS["RANGE"]
    assert bytes(driver.state) == before
    assert library.drawbar_set_offset(driver.state, offset(-100.0)) == 0  # the path is straight
    assert library.drawbar_set_offset(None, offset(0.0)) == STATUS["NULL"]


def test_a_run_begins_where_it_is_asked_to(driver):
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
    assert change(6.0) == STATUS["ELSEWHERE"]
    assert change(-1.0) == STATUS["RANGE"]
    assert driver.step()[0] == 0
    driver.nodes[20, 1] += 1.0
    assert change(1.0) == STATUS["PATH"]
