"""The console on small and narrow phones: nothing is cut off, and nothing lies over what matters."""

import pytest
from console_browser import new_page, press_until, word

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")


WITH_MANY_MESSAGES = """() => {
  const [map, list, stop] = [".map", ".why", ".stop"].map((each) => document.querySelector(each));
  const sentence = "<li><b>The receivers have no RTK fix for long enough</b><span>Wait under open sky</span></li>";
  list.querySelector("ol").innerHTML = sentence.repeat(8);
  const sizes = () => [map.offsetHeight, list.offsetHeight, stop.getBoundingClientRect().bottom];
  return [sizes(), (list.focus(), sizes())];
}"""
"""heights of map and list, and where STOP ends, before and while the list has the focus"""


def open_on_phone(drive, page, height):
    page.set_viewport_size({"width": 360, "height": height})
    page.goto(drive)
    for each in (".why li", ".chips li"):
        page.locator(each).first.wait_for()


@pytest.mark.parametrize("height", [640, 740])
def test_many_messages_leave_room_for_the_map_and_the_stops(drive, page, height):
    open_on_phone(drive, page, height)
    (map_height, short, bottom), (_, whole, bottom_below_whole) = page.evaluate(WITH_MANY_MESSAGES)
    assert map_height >= 180 or short == 52
    assert whole > short
    assert bottom == bottom_below_whole <= height


@pytest.mark.parametrize("height", [581, 632])
def test_whatever_stands_above_them_no_stop_is_cut_off_on_a_low_phone(drive, page, height):
    open_on_phone(drive, page, height)
    page.evaluate("document.querySelector('.lease').style.minHeight = '200px'")
    bottoms = "(all) => all.map((each) => each.getBoundingClientRect().bottom)"
    assert max(page.locator(".stops button").evaluate_all(bottoms)) <= height


TOO_WIDE = "(all) => all.filter((each) => each.scrollWidth > each.clientWidth).map((each) => each.innerText)"
TITLE_BEFORE_STOP = """() => {
  const words = document.createRange();
  words.selectNodeContents(document.querySelector(".page-bar .word"));
  return document.querySelector(".bar-stop").getBoundingClientRect().left - words.getBoundingClientRect().right;
}"""
"""px between the title and STOP"""


@pytest.mark.parametrize("language", ["en", "de"])
def test_on_the_narrowest_phone_no_word_reaches_stop_or_leaves_its_button(drive, somebody_else, language):
    page = new_page(somebody_else)
    page.set_viewport_size({"width": 320, "height": 568})
    page.goto(f"{drive}language/{language}")
    page.locator(".why li").first.wait_for()
    assert page.locator(".stops button").evaluate_all(TOO_WIDE) == []
    for name in ("fields", "setup", "runs", "inside"):
        page.goto(drive + name)
        page.locator(".page-bar .word").wait_for()
        assert page.evaluate(TITLE_BEFORE_STOP) > 0, name
        assert page.evaluate("document.documentElement.scrollWidth") <= 320, name


COVERED = """() => {
  const { left, width } = document.querySelector(".map").getBoundingClientRect();
  const rects = [...document.querySelectorAll(".zoom button")].map((each) => each.getBoundingClientRect());
  return rects.filter((each) => each.left < left + width / 2 + 20 && each.right > left + width / 2 - 20).length;
}"""
"""buttons that lie over the middle of the map, where the vehicle is"""
HEIGHTS = """() => ["on the line", "right of the line"].map((side) => {
  document.querySelectorAll(".body-side").forEach((each) => (each.innerText = side));
  return document.querySelector(".figures").offsetHeight;
})"""
CUT_OFF = """() => {
  const bottom = (each) => document.querySelector(each).getBoundingClientRect().bottom;
  return bottom(".why li b") - bottom(".why");
}"""
"""px of the first message that are hidden"""


def test_on_the_narrowest_phone_vehicle_speed_and_what_to_do_are_seen(drive, somebody_else):
    page = new_page(somebody_else)
    page.set_viewport_size({"width": 320, "height": 568})
    page.goto(drive)
    page.locator(".why li").first.wait_for()
    assert page.evaluate(COVERED) == 0
    press_until(page, word(page, "Emergency stop"), "EMERGENCY")
    press_until(page, word(page, "Ready"), "Acknowledge")
    press_until(page, word(page, "Steering"), "1 Prepare", "2 Engage")
    for language in ("en", "de"):
        page.goto(f"{drive}language/{language}")
        page.locator(".adjust .value").first.wait_for()
        assert page.locator(".adjust .value, .adjust small").evaluate_all(TOO_WIDE) == [], language
    first, second = page.evaluate(HEIGHTS)
    assert first == second, "the map does not jump when a body leaves the line"
    press_until(page, word(page, "Angehalten"), "STOPP")
    page.locator(".why li").first.wait_for()
    assert page.evaluate(CUT_OFF) <= 0
