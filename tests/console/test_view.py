"""What is shown of states and numbers, without a browser."""

import math
from dataclasses import replace

import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import Stage

from drawbar.console.language.words import Words
from drawbar.console.link import STALE
from drawbar.console.view import dashboard, picture
from drawbar.driving.messaging.datagrams import CorrectionsFailure, pack
from drawbar.messages import SupervisorState
from drawbar.safety.causes import Cause
from drawbar.statuses import Status

EN, DE = Words("en"), Words("de")


@pytest.fixture
def stage():
    stage = Stage()
    stage.run(0.1)
    return stage


def drawn(stage, words=EN, **numbers):
    stage.receive_controller(**numbers)
    return picture(stage.link.gate, stage.link.controller, None, words, stale=False)


@pytest.mark.parametrize(
    ("error", "figure", "side", "arrow"),
    [
        (0.12, "12", "left of the line", "◀"),
        (-0.12, "12", "right of the line", "▶"),
        (0.004, "0", "on the line", "◆"),
        (math.nan, "–", "not known", ""),
        (-25.0, "2500", "right of the line", "▶"),
    ],
)
def test_errors_are_said_as_the_driver_sees_them(stage, error, figure, side, arrow):
    body = drawn(stage, tractor_lateral_error=error)["bodies"][0]
    assert (body["figure"], body["side"], body["arrow"]) == (figure, side, arrow)
    assert body["bar"] is None or -1.0 <= body["bar"] <= 1.0


def test_the_worse_receiver_is_shown(stage):
    chip = drawn(stage, trailer_quality=4)["chips"][1]
    assert (chip["value"], chip["good"]) == ("RTK float", False)


@pytest.mark.parametrize(("heard", "name"), [((21, 17), "17 sat."), ((21, 0), "21 sat."), ((0, 0), "Position")])
def test_the_fewest_satellites_are_shown_where_they_are_known(stage, heard, name):
    stage.receive_fixes(0.0, 0.0, satellites=heard)
    stage.receive_controller()
    shown = picture(stage.link.gate, stage.link.controller, None, EN, stale=False, satellites=stage.link.satellites)
    assert shown["chips"][1]["name"].endswith(name)
    stage.now += 2 * 10**9
    assert stage.link.satellites == 0


def test_german_numbers_have_a_comma(stage):
    assert drawn(stage, DE, wheel_speed=1.0)["chips"][0]["value"] == "3,6 km/h"


def test_what_is_not_known_is_said_and_is_not_good(stage):
    chips = drawn(stage, wheel_speed=math.nan, receiver_speed=math.nan, correction_age=math.nan)["chips"]
    assert [chips[index]["value"] for index in (0, 2)] == ["not known"] * 2
    assert not chips[0]["good"]
    assert not chips[2]["good"]


def test_each_state_has_a_word_and_a_symbol_of_its_own(stage):
    states = [replace(stage.link.gate, state=state) for state in SupervisorState]
    dashboards = [dashboard(state, EN, stale=False, mine=False, holder=None, drives=True) for state in states]
    assert len({each.word for each in dashboards}) == len(SupervisorState)
    assert len({each.symbol for each in dashboards}) == len(SupervisorState) - 1  # starting and self-test share theirs


def test_the_driver_is_told_to_brake_until_the_vehicle_stands(stage):
    stopping = replace(stage.link.gate, state=SupervisorState.STOPPING, stop=1)
    for speed, brakes in ((1.0, True), (math.nan, True), (0.0, False)):
        shown = dashboard(stopping, EN, stale=False, mine=True, holder="1", drives=True, speed=speed)
        assert shown.brake is brakes


@pytest.mark.parametrize("words", [EN, DE], ids=["en", "de"])
@pytest.mark.parametrize("state", [SupervisorState.READY, SupervisorState.ACTIVE, SupervisorState.STOPPED])
def test_what_the_controller_tells_of_sensors_is_said_with_what_to_do(stage, words, state):
    stage.receive_controller()
    gate = replace(stage.link.gate, state=state, refusals=(0,) * 8)
    told = (Cause.YAW_REJECTED.value, Cause.RECEIVER_SILENT.value, *[0] * 6)
    shown = dashboard(
        gate, words, stale=False, mine=True, holder="1", drives=True,
        controller=replace(stage.link.controller, notices=told),
    )  # fmt: skip
    assert shown.reasons[-2:] == (words.cause(Cause.YAW_REJECTED), words.cause(Cause.RECEIVER_SILENT))
    listed = 3 if state is SupervisorState.STOPPED else 2  # there also what to press
    assert f"({listed})" in shown.heading or state is SupervisorState.READY


def test_why_no_corrections_come_is_shown_while_somebody_says_so(stage):
    told = "the caster has no such mount point (404); check devices.corrections.mount"
    stage.receive_controller()
    stage.link.receive(pack(CorrectionsFailure(told)))
    shown = dashboard(stage.link.gate, DE, stale=False, mine=True, holder="a", drives=True,
                  corrections=stage.link.corrections_failure)  # fmt: skip
    assert shown.reasons[-1] == (
        "Es kommen keine Korrekturen.",
        "der Caster kennt diesen Mountpoint nicht (404); devices.corrections.mount prüfen",
    )
    stage.link.receive(pack(CorrectionsFailure("")))
    assert stage.link.corrections_failure == ""
    stage.link.receive(pack(CorrectionsFailure(told)))
    stage.now += STALE + 1
    assert stage.link.corrections_failure == ""


@pytest.mark.parametrize("words", [EN, DE], ids=["en", "de"])
def test_what_waits_for_the_operator_says_so_first_and_not_to_drive(stage, words):
    causes = (Cause.TOO_SLOW, Cause.FIX_LOST)
    gate = replace(stage.link.gate, refusals=(*(cause.value for cause in causes), *[0] * 6))
    first = {}
    for state in (SupervisorState.STOPPED, SupervisorState.FAULT, SupervisorState.ESTOP, SupervisorState.OVERRIDE):
        shown = dashboard(replace(gate, state=state), words, stale=False, mine=True, holder="1", drives=True)
        assert shown.heading.startswith(words("next"))
        (first[state], _), *others = shown.reasons
        assert words("acknowledge") in first[state]
        assert others == [words.cause(Cause.FIX_LOST)], "it is to stand, not to begin to drive"
    assert first[SupervisorState.OVERRIDE] != first[SupervisorState.STOPPED], "that one may roll"
    looks_on = dashboard(
        replace(gate, state=SupervisorState.STOPPED), words, stale=False, mine=False, holder="1", drives=False
    )
    assert looks_on.reasons == (words.cause(Cause.FIX_LOST),), "who may only look cannot press it"


@pytest.mark.parametrize("ended", [True, False])
def test_on_a_headland_only_that_is_said_which_the_driver_can_do_and_no_old_distance(stage, ended):
    unknown = (Cause.UNPROVED, Cause.POSITION_LOST, Cause.HEADING_UNSURE, Cause.LINE_LOST, Cause.HITCH_ANGLE)
    causes = (*unknown, Cause.OVERRUN)
    gate = replace(stage.link.gate, state=SupervisorState.STANDBY, refusals=(*(each.value for each in causes), 0, 0))
    stage.receive_controller()
    beside = stage.link.controller
    away = replace(beside, status=Status.FINISHED) if ended else replace(beside, tractor_lateral_error=math.nan)
    others = {"stale": False, "mine": True, "holder": "1", "drives": True}
    shown = dashboard(gate, EN, controller=away, **others)
    assert shown.reasons == (EN.cause(Cause.OFF_LINE), EN.cause(Cause.OVERRUN))
    assert len(dashboard(gate, EN, controller=beside, **others).reasons) == len(causes)
    figures = picture(gate, away, None, EN, stale=False)
    assert [body["side"] for body in figures["bodies"]] == ["not known"] * 2
    steered = replace(gate, state=SupervisorState.STOPPING)
    still = picture(steered, replace(away, tractor_lateral_error=0.05), None, EN, stale=False)
    assert still["bodies"][0]["figure"] == "5", "while it stops past the end"


def test_while_it_takes_over_nobody_is_told_to_turn_the_wheels(stage):
    gate = replace(stage.link.gate, refusals=(Cause.FIX_LOST.value, Cause.STEERING_APART.value, *[0] * 6))
    others = {"stale": False, "mine": True, "holder": "1", "drives": True}
    listed = {
        state: dashboard(replace(gate, state=state), EN, **others).reasons
        for state in (SupervisorState.STANDBY, SupervisorState.ENGAGING)
    }
    assert EN.cause(Cause.STEERING_APART) in listed[SupervisorState.STANDBY]
    assert listed[SupervisorState.ENGAGING] == (EN.cause(Cause.FIX_LOST),)


@pytest.mark.parametrize("tried", [True, False])
def test_nobody_is_told_to_drive_before_the_emergency_stop_has_been_tried(stage, tried):
    causes = (Cause.TOO_SLOW, *([] if tried else [Cause.EMERGENCY_UNTRIED]))
    codes = (*(cause.value for cause in causes), *[0] * (8 - len(causes)))
    gate = replace(stage.link.gate, state=SupervisorState.STANDBY, refusals=codes)
    shown = dashboard(gate, EN, stale=False, mine=True, holder="1", drives=True)
    assert shown.reasons == (EN.cause(causes[-1]),)


@pytest.mark.parametrize("words", [EN, DE], ids=["en", "de"])
def test_how_the_controllers_run_has_ended_is_said(stage, words):
    stopped = replace(stage.link.gate, state=SupervisorState.STOPPED, cause=Cause.CONTROLLER_STOPS.value)
    stage.receive_controller()
    told = set()
    for status in (each for each in Status if each.has_ended):
        heard = replace(stage.link.controller, status=status)
        shown = dashboard(stopped, words, stale=False, mine=True, holder="1", drives=True, controller=heard)
        assert words.cause(Cause.CONTROLLER_STOPS)[0] not in shown.detail, "the reason alone is enough"
        assert (status.text.removeprefix("stopped: ")[1:] in shown.detail) == (words is EN)
        told.add(shown.detail)
    assert len(told) == sum(each.has_ended for each in Status), "each says why in words of its own"
