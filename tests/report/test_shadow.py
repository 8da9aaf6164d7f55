"""The report of a drive at which drawbar only looked on."""

import dataclasses
import io
import json
import math

import numpy as np
import pytest
from chromium import LONGEST, open_chromium
from rich.cells import cell_len
from rich.console import Console

from drawbar.driving.evaluation.engageable import Engageable, Stretch
from drawbar.recording.log import LOG_NAME, read_log
from drawbar.recording.recorder import Recorder
from drawbar.report.console import summary
from drawbar.report.folder import write_report
from drawbar.report.metrics import compute_metrics
from drawbar.report.page import render_page
from drawbar.report.path_errors import Bodies, estimated_path_errors, true_path_errors
from drawbar.report.shadow import compare
from drawbar.safety.causes import Cause
from drawbar.signals import Flag, Status

STEPS, READY = 60, 20
"""of the drive; the first at which nothing stands against engaging"""


def stretches(log, cause=Cause.FIX_LOST, ready=READY):
    begin, change, end = log.wall_time[0], log.wall_time[ready] - 1e-5, log.wall_time[-1]
    return Engageable(stretches=(Stretch(begin, change, (cause,)), Stretch(change, end, ())))


@pytest.fixture
def shadow_log(make_run):
    def make(measured=True, joint_sign=1, steps=STEPS):
        run = make_run(truth=False, steps=steps)
        vehicle = run.header.vehicle.model_copy(update={"joint_sign": joint_sign})
        header = dataclasses.replace(run.header, vehicle=vehicle, shadow=True)
        records = tuple(look_on(each, measured=measured) for each in run.records)
        return dataclasses.replace(run, header=header, records=records, wall_time=1.8e9 + 0.2 * np.arange(steps))

    return make


def look_on(record, *, measured):
    """Return the record of a step at which drawbar was not engaged, without angles where none is measured."""
    known = record.measurement
    if not measured:
        known = dataclasses.replace(known, tractor_steering=math.nan, trailer_steering=math.nan)
    return dataclasses.replace(record, measurement=known, flags=Flag.RELEASED)


def metrics_of(log, shadow):
    return dataclasses.replace(compute_metrics(log, estimated_path_errors(log)), shadow=shadow.metrics())


def render(log, shadow):
    return render_page(log, metrics_of(log, shadow), true_path_errors(log), [], shadow)


@pytest.mark.parametrize("joint_sign", [1, -1])
def test_a_command_is_compared_with_the_angle_one_step_later_where_nothing_stood_against_engaging(
    shadow_log, joint_sign
):
    log = shadow_log(joint_sign=joint_sign)
    metrics = compare(log, stretches(log)).metrics()
    for body, sign in (("tractor", 1), ("trailer", joint_sign)):
        command, angle = log.column(f"{body}_steering.command"), log.column(f"measurement.{body}_steering")
        amounts = np.abs(sign * command[READY:-1] - angle[READY + 1 :])
        difference = getattr(metrics.difference_rad, body)
        assert (difference.mean, difference.max) == pytest.approx((amounts.mean(), amounts.max()), rel=1e-12)
        assert getattr(metrics.compared_steps, body) == STEPS - 1 - READY
        error = np.abs(log.column(f"reference.{body}.lateral_error"))[READY:]
        driver = getattr(metrics.driver_error_m, body)
        assert (driver.mean, driver.max) == pytest.approx((error.mean(), error.max()), abs=0.02)
    assert metrics.engageable_share == pytest.approx(1.0 - READY / (STEPS - 1), abs=1e-3)
    assert metrics.refused_s == {"FIX_LOST": pytest.approx(0.2 * READY, abs=1e-3)}


def test_a_step_without_a_new_command_is_not_compared(shadow_log):
    log = shadow_log()
    records = list(log.records)
    records[READY + 5] = dataclasses.replace(records[READY + 5], status=Status.REFUSED)
    log = dataclasses.replace(log, records=tuple(records))
    shadow = compare(log, stretches(log))
    assert np.flatnonzero(np.isnan(shadow.steerings.tractor.command)).tolist() == [*range(READY + 1), READY + 6]


def test_angles_that_nobody_measured_are_estimated_and_that_is_told(shadow_log):
    log = shadow_log(measured=False)
    shadow = compare(log, stretches(log))
    assert shadow.metrics().angle_measured == Bodies(tractor=False, trailer=False)
    np.testing.assert_array_equal(shadow.steerings.trailer.driven, log.column("estimate.trailer_steering"))
    page = render(log, shadow)
    assert "driver&#x27;s angle of front wheels and joint is estimated" in page
    assert "Driver, estimated" in page
    measured = shadow_log()
    assert "is estimated, as none was measured" not in render(measured, compare(measured, stretches(measured)))


def test_the_page_draws_the_commands_where_they_could_have_been_sent_beside_the_drivers_angles(shadow_log):
    log = shadow_log()
    page = render(log, compare(log, stretches(log)))
    figures = json.loads(page.split('id="page">')[1].split("</script>")[0])["figures"]
    driver, command = figures["tractor-steering"]["data"]
    assert (driver["name"], command["name"]) == ("Driver, measured", "drawbar's command")
    assert [value is None for value in command["y"]] == [True] * (READY + 1) + [False] * (STEPS - READY - 1)
    assert None not in driver["y"]
    assert list(figures)[:4] == ["map", "tractor-steering", "trailer-steering", "errors"]
    text = page.partition("<script>")[0]
    assert "drawbar shadow drive" in text
    assert "together they are no course that drawbar would have driven" in text
    assert Cause.FIX_LOST.sentence in text
    assert "commands changed by the gate" not in text
    assert "nothing against engaging" in text


@pytest.mark.parametrize("width", [60, 80])
def test_the_terminal_tells_it_within_its_width(shadow_log, width):
    log = shadow_log()
    console = Console(file=io.StringIO(), width=width)
    console.print(summary(metrics_of(log, compare(log, stretches(log)))))
    text = console.file.getvalue()
    assert max(cell_len(row.rstrip()) for row in text.splitlines()) <= width
    assert "…" not in text
    told = " ".join(text.split())
    assert "nothing stood against engaging for 66 % of 12 s;" in told
    assert f"- 4.0 s: {Cause.FIX_LOST.sentence}" in told
    assert [row.split()[:4] for row in text.splitlines() if row.startswith("driver to")] == [
        ["driver", "to", what, statistic] for what in ("command,", "line,") for statistic in ("mean", "max")
    ]


def test_a_drive_that_could_never_have_been_engaged_has_no_differences(shadow_log):
    log = shadow_log()
    for engageable in (stretches(log, ready=STEPS - 1), Engageable(stretches=())):
        metrics = metrics_of(log, compare(log, engageable))
        assert math.isnan(metrics.shadow.difference_rad.tractor.mean)
        assert metrics.shadow.compared_steps.tractor == 0
        console = Console(file=io.StringIO(), width=80)
        console.print(summary(metrics))
        told = " ".join(console.file.getvalue().split())
        assert "driver to command" not in told
        known = bool(engageable.stretches)
        assert ("nothing stood against engaging for 0 %" in told) == known
        assert ("it is not known whether anything stood against engaging" in told) != known


def test_a_log_tells_whether_drawbar_only_looked_on(tmp_path, shadow_log, make_run):
    for name, log in (("shadow", shadow_log(steps=3)), ("run", make_run(steps=3))):
        (tmp_path / name).mkdir()
        with Recorder(tmp_path / name / LOG_NAME, log.header) as recorder:
            for record in log.records:
                recorder.write(record)
        assert read_log(tmp_path / name).header.shadow == (name == "shadow")
        assert (write_report(tmp_path / name).shadow is not None) == (name == "shadow")
        written = json.loads((tmp_path / name / "metrics.json").read_text())["shadow"]
        assert (written is not None) == (name == "shadow")


@pytest.mark.parametrize("width", [1280, 390])
def test_it_fits_a_desktop_and_a_phone(shadow_log, tmp_path, width):
    log = shadow_log(measured=False)
    (tmp_path / "report.html").write_text(render(log, compare(log, stretches(log))), "utf-8")
    with open_chromium() as browser:
        page = browser.new_page(viewport={"width": width, "height": 800})
        page.goto((tmp_path / "report.html").as_uri(), timeout=1e3 * LONGEST)
        page.wait_for_function("document.querySelector('#trailer-steering .legend')", timeout=1e3 * LONGEST)
        assert page.evaluate("document.documentElement.scrollWidth") == width
        widths = page.evaluate("Array.from(document.querySelectorAll('.table'), t => [t.scrollWidth, t.clientWidth])")
        assert all(needed <= shown for needed, shown in widths)
