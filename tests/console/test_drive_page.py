"""The drive page, by simulated users in front of the gate's real engagement."""

import math

import numpy as np
import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import staged

from drawbar.console.drawing import Moving
from drawbar.guidance.figure_eight import figure_eights
from drawbar.messages import Action, SupervisorState
from drawbar.safety.causes import Cause

READY, STANDBY = SupervisorState.READY, SupervisorState.STANDBY


async def ready(stage, browser):
    """Return a browser in front of a gate that is ready."""
    one = await browser().open()
    stage.run(4.0, one)
    assert stage.engagement.state is READY
    return one


async def driving(stage, browser):
    one = await ready(stage, browser)
    one.press("1 Prepare")
    stage.run(0.2, one)
    one.press("2 Engage")
    stage.run(2.0, one)
    assert stage.engagement.state is SupervisorState.ACTIVE
    return one


@staged
async def test_engaging_takes_two_steps_and_stop_stops(stage, browser):
    one = await ready(stage, browser)
    assert "Ready" in one.text()
    assert not one.enabled("2 Engage")
    one.press("1 Prepare")
    stage.run(0.2, one)
    assert "You have control" in one.text()
    assert not one.enabled("1 Prepare")
    one.press("2 Engage")
    stage.run(2.0, one)
    assert "Steering" in one.text()
    one.press("STOP")
    stage.run(0.1, one)
    assert stage.engagement.state is SupervisorState.STOPPING
    stage.standing = True
    stage.run(3.0, one)
    assert "Stopped" in one.text()
    one.press("Acknowledge")
    stage.run(0.1, one)
    assert stage.engagement.state is STANDBY


@staged
async def test_what_stands_against_engaging_is_listed_with_what_to_do(stage, browser):
    stage.causes = {Cause.FIX_LOST, Cause.TOO_SLOW}
    one = await browser().open()
    stage.run(4.0, one)
    assert not one.enabled("1 Prepare")
    for cause in stage.causes:
        assert cause.sentence[1:] in one.text()
        assert cause.advice[1:] in one.text()
    stage.causes = set()
    stage.run(3.0, one)
    assert Cause.FIX_LOST.sentence[1:] not in one.text()


@staged
async def test_a_refusal_is_reported_with_its_cause(stage, browser):
    one = await ready(stage, browser)
    stage.link.ask(one.page._visitor, Action.ENGAGE)
    stage.run(0.1, one)
    assert Cause.NOT_ARMED.sentence[1:] in one.notifications()
    assert stage.engagement.state is READY


@staged
async def test_without_the_gate_nothing_but_stops_can_be_pressed(stage, browser):
    one = await ready(stage, browser)
    stage.silent = True
    stage.run(1.2, one)
    one.refresh()
    assert "No contact" in one.text()
    assert not one.enabled("1 Prepare")
    assert one.page._instruments  # the picture says that it is old, and the browser acknowledges none of those
    before = len(stage.sent)
    for word in ("STOP", "EMERGENCY", "Release"):
        assert one.enabled(word)
        one.press(word)
    assert [each.action for each in stage.sent[before:]] == [Action.STOP, Action.EMERGENCY, Action.RELEASE]


@staged
async def test_commands_of_a_browser_that_draws_no_more_are_refused(stage, browser):
    one = await ready(stage, browser)
    stage.run(1.1)
    before = [each.action for each in stage.sent].count(Action.ARM)
    one.press("1 Prepare")
    one.refresh()
    assert [each.action for each in stage.sent].count(Action.ARM) == before
    assert Cause.SEEN_OLD.sentence[1:] in one.notifications()
    stage.run(0.1, one)
    one.press("1 Prepare")
    stage.run(0.1, one)
    assert stage.engagement.armed(stage.time)


@staged
async def test_a_command_carries_the_state_that_was_drawn_and_the_gate_refuses_an_old_one(stage, browser):
    one = await ready(stage, browser)
    drawn = stage.link.gate.sequence
    stage.run(0.5)
    one.press("1 Prepare")
    assert stage.sent[-1].action is Action.ARM
    assert stage.sent[-1].seen_sequence <= drawn
    assert stage.sent[-1].seen_time <= stage.time * 1e9 - 0.5e9


@staged
async def test_a_browser_that_draws_no_more_while_driving_ends_in_a_stop(stage, browser):
    await driving(stage, browser)  # its connection stands; it only says nothing any more: asleep, half open, frozen
    stage.run(2.0 - 0.3)
    assert stage.engagement.state is SupervisorState.ACTIVE
    stage.run(0.7)
    assert stage.engagement.state is SupervisorState.STOPPING
    assert stage.engagement.cause is Cause.NO_OPERATOR


@staged
async def test_words_of_pictures_that_were_never_sent_are_no_presence(stage, browser):
    one = await driving(stage, browser)
    for _ in range(30):
        stage.run(0.1)
        for word in (10**9, -1, None, "5", True, [stage.sequence]):
            stage.link.drawn(one.page._visitor, word)
    assert stage.engagement.state is SupervisorState.STOPPING


@staged
async def test_one_of_two_operators_holds_the_lease_and_both_see_who(stage, browser):
    one = await ready(stage, browser)
    other = await browser().open()
    stage.run(0.3, one, other)
    one.press("1 Prepare")
    stage.run(0.3, one, other)
    assert "You have control" in one.text()
    assert "Operator 1 has control" in other.text()
    assert not other.enabled("1 Prepare")
    stage.link.ask(other.page._visitor, Action.ARM)
    stage.run(0.3, one, other)
    assert Cause.LEASE_HELD.sentence[1:] in other.notifications()
    assert stage.requests.lease == one.page._visitor.number


async def with_a_wish(stage, browser):
    """Return an operator who has control, and one who has just asked for it."""
    one = await ready(stage, browser)
    other = await browser().open()
    one.press("1 Prepare")
    stage.run(0.3, one, other)
    other.press("Ask for control")
    return one, other


@staged
async def test_control_is_handed_over_by_asking_and_giving(stage, browser):
    one, other = await with_a_wish(stage, browser)
    stage.run(0.3, one, other)
    assert "Operator 2 asks for control" in one.text()
    one.press("Give control")
    stage.run(3.0, one, other)
    assert "Nobody has control" in other.text()
    assert "asks for control" not in one.text()
    other.press("1 Prepare")
    stage.run(0.3, one, other)
    assert stage.requests.lease == other.page._visitor.number


@staged
async def test_whoever_leaves_the_page_no_longer_asks_for_control(stage, browser):
    one, other = await with_a_wish(stage, browser)
    stage.run(9.0, one)
    assert "Operator 2 asks for control" in one.text(), "a network that is bad for a while"
    stage.run(2.0, one)
    assert "asks for control" not in one.text()
    assert not one.enabled("Give control")
    stage.run(2.0, one, other)
    assert "asks for control" not in one.text(), "asked long ago"


@staged
async def test_whoever_logs_out_no_longer_asks_for_control(stage, browser):
    one, other = await with_a_wish(stage, browser)
    stage.run(0.3, one, other)
    other.page._visitor.is_known = False
    stage.run(0.3, one, other)
    assert "asks for control" not in one.text()


@staged
async def test_control_is_not_given_while_driving(stage, browser):
    one = await driving(stage, browser)
    other = await browser().open()
    stage.run(0.3, one, other)
    other.press("Ask for control")
    stage.run(0.3, one, other)
    assert "Stop first" in one.text()
    assert not one.enabled("Give control")


@staged
async def test_anybody_can_stop_a_drive_of_another(stage, browser):
    one = await driving(stage, browser)
    other = await browser().open()
    other.press("STOP")
    stage.run(0.1, one, other)
    assert stage.engagement.state is SupervisorState.STOPPING


@staged
async def test_a_page_loaded_again_is_the_same_operator(stage, browser):
    one = await driving(stage, browser)
    await one.open()
    stage.run(3.0, one)
    assert stage.engagement.state is SupervisorState.ACTIVE
    assert "You have control" in one.text()


@staged
async def test_a_page_loaded_again_between_both_steps_engages_nothing(stage, browser):
    one = await ready(stage, browser)
    one.press("1 Prepare")
    stage.run(0.2, one)
    await one.open()
    stage.run(6.0, one)
    assert stage.engagement.state is READY
    assert not one.enabled("2 Engage")


@staged
async def test_nudge_and_speed_reach_the_gate(stage, browser):
    one = await driving(stage, browser)
    one.user.find(marker="nudge_left").click()
    stage.run(0.1, one)
    one.user.find(marker="slower").click()
    stage.run(0.2, one)
    assert stage.requests.nudge == pytest.approx(0.02)
    assert stage.requests.set_speed == pytest.approx(1.0 - 0.2 / 3.6)
    assert "◀ 2 cm" in one.text()
    assert "3.4 km/h" in one.text()


@staged
async def test_the_next_line_is_chosen_while_nothing_is_steered_as_the_driver_sees_it(stage, browser):
    one = await browser().open()
    stage.causes = {Cause.OFF_LINE}
    stage.receive_controller(line_offset=0.0)
    stage.run(0.8, one)
    one.press("pass_left")
    stage.receive_controller(line_offset=3.0)
    stage.run(0.3, one)
    assert stage.requests.line == 1
    assert "You have control" in one.text()
    stage.receive_controller(line_offset=3.0, against=1)
    for _ in range(2):
        one.press("pass_left")
        stage.run(0.3, one)
    assert stage.requests.line == -1
    stage.run(1.2, one)
    assert "-1 ✖ not drivable" in one.text()
    stage.receive_controller(line_offset=-3.0, against=1)
    stage.run(0.3, one)
    assert "not drivable" not in one.text()
    one.press("nudge_left")
    stage.run(0.1, one)
    assert stage.requests.nudge == pytest.approx(-0.02)
    assert "◀ 2 cm" in one.text()


@staged
async def test_the_nearest_pass_is_chosen_by_where_the_tractor_stands(stage, browser):
    one = await browser().open()
    stage.causes = {Cause.OFF_LINE}
    stage.receive_controller(line_offset=0.0)
    stage.run(0.8, one)
    stage.link.moving = None
    one.press("pass_nearest_help")  # nobody knows where the tractor is
    stage.run(0.3, one)
    assert stage.requests.line == 0
    x, y, yaw = figure_eights((8.0,), 20.0).sample(np.array([0.5]))[0, :3]
    place = x - 5.6 * math.sin(yaw), y + 5.6 * math.cos(yaw), yaw
    stage.link.moving = Moving(tractor=place, trailer=place, steering=0.0, plans=([], []))
    one.press("pass_nearest_help")
    stage.run(0.3, one)
    assert stage.requests.line == 2  # of lines that are 3 m apart


@staged
async def test_the_line_is_not_chosen_while_it_is_steered(stage, browser):
    one = await driving(stage, browser)
    (row,) = (each for each in one.user.client.elements.values() if "passes" in each.classes)
    assert not row.visible
    stage.link.ask(one.page._visitor, Action.LINE, 1.0)
    stage.run(0.1, one)
    assert Cause.STEERED.sentence[1:] in one.notifications()


@staged
async def test_a_double_tap_on_engage_is_one_and_changes_nothing_else(stage, browser):
    one = await ready(stage, browser)
    for _ in range(2):
        one.press("1 Prepare")
    stage.run(0.2, one)
    asked = len(stage.sent)
    one.press("2 Engage")
    stage.run(0.1, one)
    with one.user.client:
        one.page._send(Action.ENGAGE)  # the button has gone, but not yet in the browser
    one.user.find(marker="faster").click()  # what stands at its place as soon as it steers
    stage.run(0.1, one)
    assert [each.action for each in stage.sent[asked:] if each.action is not Action.PRESENT] == [Action.ENGAGE]
    assert one.notifications() == ""
    stage.run(1.0, one)
    one.user.find(marker="slower").click()
    stage.run(0.1, one)
    assert stage.requests.set_speed == pytest.approx(1.0 - 0.2 / 3.6)


@staged
async def test_a_finger_that_adjusts_does_not_acknowledge_the_stop_that_comes_meanwhile(stage, browser):
    one = await driving(stage, browser)
    stage.standing = True
    stage.run(1.0, one)
    one.press("STOP")
    while stage.engagement.state is not SupervisorState.STOPPED:
        stage.run(0.1, one)
    one.refresh()
    one.press("Acknowledge")
    stage.run(0.1, one)
    assert stage.engagement.state is SupervisorState.STOPPED
    stage.run(1.0, one)
    one.press("Acknowledge")
    stage.run(0.1, one)
    assert stage.engagement.state is STANDBY


@staged
async def test_whoever_steers_is_not_led_away_by_the_menu(stage, browser):
    one = await driving(stage, browser)
    one.user.find(marker="runs").click()
    assert "Press STOP first" in one.notifications()
    assert one.user.back_history[-1] == "/"
    other = await browser().open()
    stage.run(0.2, one, other)
    other.user.find(marker="runs").click()
    assert other.notifications() == ""


@staged
async def test_commands_in_a_burst_are_limited_and_stops_are_not(stage, browser):
    one = await driving(stage, browser)
    before = len(stage.sent)
    for _ in range(100):
        one.user.find(marker="nudge_left").click()
    assert len(stage.sent) - before <= 10
    assert "Too many commands" in one.notifications()
    for _ in range(20):
        one.press("STOP")
    assert [each.action for each in stage.sent].count(Action.STOP) == 20


@staged
async def test_a_slow_browser_is_sent_no_queue_of_old_pictures(stage, browser):
    one = await ready(stage, browser)
    sent = []
    one.page._instruments.run_method = lambda name, picture: sent.append(picture)
    for _ in range(20):
        stage.run(0.1)
        one.refresh()
    assert len(sent) <= 3
