"""The console in a real browser, in front of a real drive of stand-ins: engage, stop, and nothing from elsewhere.

One drive and one browser serve all tests.
"""

import re

import pytest
from console_browser import new_page, press, press_until, see, word
from console_process import console_process, reaches, until

from drawbar.console import screenshots

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

_COLOUR = "(each) => {{ each.className = 'bar {}'; return getComputedStyle(each).backgroundColor; }}"
GREEN_BAR, IDLE = _COLOUR.format("tone-good"), _COLOUR.format("tone-idle")
BESIDE_FIGURES = """(all) => all.map((each) => [each, each.getBoundingClientRect()])
  .filter(([each, { left, right }]) => left < 0 || right > document.querySelector(".figures").clientWidth + 1
    || each.scrollWidth > each.clientWidth + 1)
  .map(([each]) => each.innerText)"""
AT_STOP = """(() => {
  const stop = [...document.querySelectorAll("button")].find((each) => each.innerText.trim() === "STOP");
  const { left, right, top, bottom } = stop.getBoundingClientRect();
  return stop.contains(document.elementFromPoint((left + right) / 2, (top + bottom) / 2));
})()"""
"""whoever presses where STOP is presses it"""


def look_at_the_other_pages(drive, page):
    """Make a line, import one, change a number, and see a plot."""
    page.goto(f"{drive}fields")
    see(page, "Fields and lines")
    press_until(page, page.get_by_text("A is set"), "Set A here")
    page.get_by_label("Heading").fill("30")
    press(page, "A and heading")
    page.locator(".field-map .line").first.wait_for()
    points = "<coordinates>4.7,50.87 4.7005,50.87 4.7007,50.8701 4.701,50.8701</coordinates>"
    kml = f"<kml><Placemark><name>bent</name><LineString>{points}</LineString></Placemark></kml>"
    page.locator("input[type=file]").set_input_files({"name": "b.kml", "mimeType": "text/xml", "buffer": kml.encode()})
    page.locator(".field-map .deviating").first.wait_for(state="attached")
    page.get_by_text("Smoothed by at most").first.wait_for()
    page.goto(f"{drive}setup")
    see(page, "Set-up")
    page.locator(".vehicle-drawing .letter", has_text="A").locator("circle").click(force=True)  # its letter is above it
    page.wait_for_function("document.activeElement.id === 'set-vehicle-wheelbase'")
    page.locator("td", has_text=" Hz").first.wait_for()
    for name, title in (("inside", "Look inside"), ("runs", "Runs")):
        page.goto(drive + name)
        see(page, title)
        page.locator(".plot canvas, .run").first.wait_for()
        assert page.evaluate("document.documentElement.scrollWidth") <= 360


def look_at_the_tubes(page):
    """Come closer until the tractor's tube, 21.8 cm wide, is broader than its plan."""
    page.evaluate(WATCH_STROKES)
    for _ in range(8):
        press(page, "Closer")
    scale = 80 * page.evaluate("Math.min(1, Math.max(0.5, document.querySelector('.map').clientHeight / 180))")
    page.wait_for_function(f"[...strokes].some((width) => Math.abs(width - {0.218 * scale}) < 0.02 * {scale})")


WATCH_STROKES = """() => {
  window.strokes = new Set();
  const { stroke } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.stroke = function () {
    strokes.add(this.lineWidth);
    return stroke.call(this);
  };
}"""


def test_it_engages_and_stops_and_loads_nothing_from_elsewhere(drive, page):
    page.add_init_script("navigator.wakeLock.request = (kind) => Promise.resolve((window.awake = kind))")
    page.goto(f"{drive}runs")
    page.goto(drive)
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    page.locator(".why li").first.wait_for()
    assert page.evaluate("window.awake") == "screen"
    assert page.locator(".map").evaluate("(each) => each.offsetHeight") >= 180
    stop = page.locator(".stop")
    assert stop.evaluate("(each) => each.getBoundingClientRect().bottom") <= 740
    page.keyboard.press("Tab")
    stop.focus()
    assert stop.evaluate("(each) => getComputedStyle(each).outlineWidth") == "4px"
    press_until(page, word(page, "Emergency stop"), "EMERGENCY")
    press_until(page, word(page, "Ready"), "Acknowledge")
    press_until(page, word(page, "Steering"), "1 Prepare", "2 Engage")
    page.locator("body:not(.old-picture)").wait_for()
    assert float(page.locator(".body-figure b").first.inner_text()) < 100.0
    press_until(page, page.get_by_text(re.compile("[◀▶] [0-9]+ cm")), "Line 2 cm to the left")
    cut = "(all) => all.filter((each) => each.getBoundingClientRect().right > innerWidth).length"
    assert page.locator(".controls .q-btn").evaluate_all(cut) == 0
    small = (
        "(all) => all.filter((each) => each.offsetHeight && Math.min(each.offsetWidth, each.offsetHeight) < 48).length"
    )
    assert page.locator("button").evaluate_all(small) == 0
    page.set_viewport_size({"width": 640, "height": 300})  # a small phone on its side, less what the browser takes
    page.wait_for_function("innerWidth === 640")
    assert page.locator(".controls .q-btn").evaluate_all(cut) == 0
    too_wide = "(all) => all.filter((each) => each.offsetParent && each.scrollWidth > each.clientWidth).length"
    assert page.locator(".controls .value").evaluate_all(too_wide) == 0
    page.set_viewport_size({"width": 568, "height": 320})  # the smallest on its side
    page.wait_for_function("innerWidth === 568")
    page.locator(".body-side").evaluate_all("(all) => all.forEach((each) => (each.innerText = 'right of the line'))")
    assert page.locator(".chips li, .body-error, .lightbar").evaluate_all(BESIDE_FIGURES) == []
    page.set_viewport_size({"width": 360, "height": 380})  # half a phone's screen
    page.wait_for_function(f"innerHeight === 380 && {AT_STOP}")
    page.set_viewport_size(screenshots.PHONE)
    look_at_the_tubes(page)
    page.go_back()  # a swipe from the edge
    page.get_by_text("Press STOP first").wait_for()
    assert (page.url, word(page, "Steering").count()) == (drive, 1)
    press_until(page, word(page, "Stopped"), "STOP")
    page.go_back()
    see(page, "Runs")
    look_at_the_other_pages(drive, page)
    elsewhere = [url for url in page.asked if not url.startswith((drive, "data:"))]
    assert elsewhere == []
    assert any("_nicegui_ws" in url for url in page.asked)
    assert page.troubles == []


def test_signals_are_plotted_by_their_words_with_their_names_beside(drive, page):
    page.goto(f"{drive}inside")
    page.wait_for_function("[...plots.values()].some(({ rows }) => rows.length > 3)")
    chosen = page.locator(".q-chip")
    assert chosen.first.inner_text().strip().startswith("Left of the line · tractor (m)")
    page.get_by_label("Signals").fill("measurement.tractor_x")
    option = page.locator(".q-menu .q-item")
    option.get_by_text("East · tractor · measured (m)").wait_for()
    assert option.locator(".raw").inner_text() == "measurement.tractor_x"
    option.first.click()
    page.wait_for_function("[...plots.values()].some(({ lines }) => lines.length === 3)")
    ahead = "(() => { const [{ rows }] = plots.values(); return rows[rows.length - 1][0] })()"
    before = page.evaluate(ahead)
    page.wait_for_function(f"{ahead} > {before}")
    assert page.troubles == []


def test_light_or_dark_and_sound_hold_on_all_pages(drive, page):
    page.goto(drive)
    dark = page.locator("body.body--dark").count()
    press(page, "Menu")
    page.get_by_text("Light or dark").click()
    chosen = "body.body--light" if dark else "body.body--dark"
    page.locator(chosen).wait_for()
    press(page, "Menu")
    page.get_by_text("Sound on or off").click()
    page.wait_for_function("!sounds()")
    page.goto(f"{drive}setup")
    see(page, "Set-up")
    page.locator(chosen).wait_for()
    assert not page.evaluate("sounds()")
    assert page.troubles == []


def test_a_wrong_file_is_refused_with_what_to_do(drive, page):
    page.goto(f"{drive}fields")
    see(page, "Fields and lines")
    told = page.locator(".q-notification")
    choose = page.locator("input[type=file]")
    choose.set_input_files({"name": "photo.jpg", "mimeType": "image/jpeg", "buffer": b"\xff\xd8\xff"})
    told.get_by_text("photo.jpg: is of none of the types").wait_for()
    page.wait_for_function(AT_STOP)
    assert page.get_by_role("button", name="Choose a field's file").count() == 1
    choose.set_input_files({"name": "large.kml", "mimeType": "text/xml", "buffer": b" " * (9 << 20)})
    told.get_by_text("one file of at most 8 MiB").wait_for()
    assert page.troubles == []


def test_a_page_that_is_cut_off_says_that_its_picture_is_old(drive, somebody_else):
    page = new_page(somebody_else)
    page.goto(drive)
    page.locator("body:not(.old-picture)").wait_for()
    page.context.set_offline(True)
    page.evaluate("window.socket.disconnect()")
    page.locator("body.old-picture .old", has_text="OLD PICTURE").wait_for()
    assert page.locator("body:not(.old-picture)").count() == 0
    assert page.locator(".bar").evaluate(GREEN_BAR) == page.locator(".bar").evaluate(IDLE), "an old state is not green"
    page.locator("#popup[aria-hidden=false]").wait_for(state="attached")
    assert page.locator("#popup").evaluate("(each) => getComputedStyle(each).display") == "none"


LATE = """async ([url, ages]) => {
  const { data, methods } = (await import(url)).default;
  const page = { ...data(), ...methods, quickest: Infinity, state: null, $emit() {}, paint() {} };
  return ages.map((age) => {
    page.draw({ sent: performance.now() - age, stale: false, state: "ACTIVE", seen: 1, bodies: [], chips: [] });
    return page.old;
  });
}"""
"""draws pictures that came so much later than the first one, ms, and returns which of them are said to be old"""


def test_pictures_that_waited_for_a_frozen_browser_are_old(drive, page):
    page.goto(drive)
    page.locator("body:not(.old-picture)").wait_for()
    (url,) = (each for each in page.asked if "instruments.js" in each)
    ages = [300.0, 800.0, 60_000.0, 1900.0, 200.0, -60_000.0, -58_000.0, -59_900.0]  # its clock stands while it sleeps
    old = [False, False, True, True, False, False, True, False]
    assert page.evaluate(LATE, [url, ages]) == old


def test_a_page_is_loaded_again_once_its_console_was_started_again(somebody_else, tmp_path):
    page = new_page(somebody_else)
    with console_process(tmp_path) as (_, _, port):
        until(lambda: reaches("127.0.0.1", port))
        page.goto(f"http://127.0.0.1:{port}/")
        page.wait_for_function("window.socket?.connected")
        page.evaluate("window.before = true")
    with console_process(tmp_path, port):
        page.wait_for_function("!window.before && window.socket?.connected")
        assert page.get_by_text("Prepare").count() > 0


def test_a_lost_connection_is_reported_in_german_too(drive, somebody_else):
    page = new_page(somebody_else)
    page.goto(f"{drive}language/de")
    page.goto(f"{drive}fields")
    assert "Verbindung verloren" in page.locator("#popup").text_content()


def test_one_of_two_browsers_has_control_and_the_other_sees_who_and_is_refused(drive, page, somebody_else):
    other = new_page(somebody_else)
    for each in (page, other):
        each.goto(drive)
        each.locator("body:not(.old-picture)").wait_for()
    press(page, "EMERGENCY")
    see(page, "Emergency stop")
    see(other, "Emergency stop")
    press_until(page, page.get_by_text("You have control"), "Acknowledge")
    other.get_by_text("has control").wait_for()
    press_until(other, page.get_by_text("asks for control"), "Ask for control")
    press(page, "EMERGENCY")
    see(other, "Emergency stop")
    refused = other.get_by_text("another operator has control").or_(other.get_by_text("the vehicle moves"))
    press_until(other, refused, "Acknowledge")
    assert other.get_by_text("You have control").count() == 0


def test_a_curve_is_recorded_while_driving(drive, page):
    page.goto(f"{drive}fields")
    press_until(page, page.get_by_text("Recording, points:"), "● Record a curve")
    press(page, "Discard")
    page.get_by_text("Recording, points:").wait_for(state="hidden")
    assert page.troubles == []


def test_a_drive_by_hand_is_evaluated(drive, page):
    page.goto(f"{drive}setup")
    press(page, "● Begin")
    page.locator(".to-do .count", has_text="/ 30 m").wait_for()
    page.locator(".track-plot canvas").wait_for()
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    press(page, "■ End and evaluate")
    page.get_by_text("Found:").wait_for()
    assert page.get_by_text("✖ front wheels: scale").count() == 1
    assert page.troubles == []


BETWEEN_LEFT_CARDS = """() => {
  const cards = [...document.querySelectorAll(".set-up > div:not(.numbers-column) > .card, .set-up > .card")];
  const edges = cards.map((each) => each.getBoundingClientRect());
  return edges.slice(1).map(({ top }, i) => top - edges[i].bottom);
}"""
"""px between the cards beside the numbers"""


def test_on_a_small_tablet_nothing_is_left_empty_beside_the_numbers(drive, page):
    page.set_viewport_size({"width": 1024, "height": 768})
    page.goto(f"{drive}setup")
    page.get_by_text("Calibrate by driving").wait_for()
    between = page.evaluate(BETWEEN_LEFT_CARDS)
    assert len(between) == 2
    assert max(between) < 40
