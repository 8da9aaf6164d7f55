"""The console in a real browser, in front of a real drive of stand-ins: engage, stop, and nothing from elsewhere."""

import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request

import pytest

from drawbar.console.screenshots import chromium_path

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")
playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

WAIT = 120_000
"""ms; a loaded machine takes its time"""

pytestmark = pytest.mark.skipif(chromium_path() is None, reason="no Chromium is installed")


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """Return the address of the console of a drive that is on."""
    tmp_path = tmp_path_factory.mktemp("drive")
    surroundings = {key: value for key, value in os.environ.items() if not key.startswith(("PYTEST", "NICEGUI"))}
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    arguments = [
        "drive",
        "--console",
        "--port",
        str(port),
        "--out",
        str(tmp_path / "run"),
        "--set",
        "safety.engage.quiet=0.5",
    ]
    with (tmp_path / "out").open("wb") as out:
        process = subprocess.Popen(
            [sys.executable, "-m", "drawbar", *arguments],
            stdout=out,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env=surroundings,
            cwd=tmp_path,
        )
    address = f"http://127.0.0.1:{port}/"
    try:
        _await_page(address, process, tmp_path / "out")
        yield address
    finally:
        process.send_signal(signal.SIGTERM)  # SIGINT is ignored by children of a shell's background job
        try:
            process.wait(15)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def _await_page(address, process, out):
    end = time.monotonic() + WAIT / 1000
    while time.monotonic() < end:
        assert process.poll() is None, out.read_text()
        try:
            urllib.request.urlopen(address, timeout=5).close()
            return
        except OSError:
            time.sleep(0.2)
    raise AssertionError(out.read_text())


@pytest.fixture(scope="module")
def browser():
    with playwright.sync_playwright() as playing:
        launched = playing.chromium.launch(executable_path=chromium_path(), args=["--no-sandbox"])
        yield launched
        launched.close()


@pytest.fixture
def another(browser):
    """Return what opens a page of one more visitor that reaches nothing but this computer.

    `asked` holds what it asked for, `troubles` what went wrong in it.
    """
    visitors = []

    def opened():
        visitors.append(browser.new_context(viewport={"width": 360, "height": 740}, locale="en-GB"))
        page = visitors[-1].new_page()
        page.set_default_timeout(WAIT)
        page.asked, page.troubles = [], []
        page.on("request", lambda request: page.asked.append(request.url))
        page.on("websocket", lambda line: page.asked.append(line.url.replace("ws://", "http://")))
        page.on("pageerror", lambda error: page.troubles.append(str(error)))
        page.route(lambda url: not url.startswith(("http://127.0.0.1:", "data:")), lambda route: route.abort())
        return page

    yield opened
    for visitor in visitors:
        visitor.close()


@pytest.fixture
def page(another):
    return another()


def see(page, word):
    page.locator(".word").get_by_text(word, exact=True).wait_for()


def press(page, name):
    page.get_by_role("button", name=name, exact=True).click()


def look_at_the_other_pages(drive, page):
    """Make a line, import one, change a number, and see a plot."""
    page.goto(f"{drive}fields")
    see(page, "Fields and lines")
    press(page, "Set A here")
    page.get_by_label("Heading").fill("30")
    press(page, "A and heading")
    page.locator(".field-map .line").first.wait_for()
    points = "<coordinates>4.7,50.87 4.7005,50.87 4.7007,50.8701 4.701,50.8701</coordinates>"
    kml = f"<kml><Placemark><name>bent</name><LineString>{points}</LineString></Placemark></kml>"
    page.locator("input[type=file]").set_input_files({"name": "b.kml", "mimeType": "text/xml", "buffer": kml.encode()})
    page.locator(".field-map .aside").first.wait_for(state="attached")
    assert "Smoothed by at most" in page.locator(".page.wide").inner_text()
    page.goto(f"{drive}setup")
    see(page, "Set-up")
    page.locator(".vehicle-drawing .letter", has_text="A").click()
    assert page.evaluate("document.activeElement.id") == "set-vehicle-wheelbase"
    page.locator("td", has_text=" Hz").first.wait_for()
    for name, title in (("inside", "Look inside"), ("runs", "Runs")):
        page.goto(drive + name)
        see(page, title)
        page.locator(".plot canvas, .run").first.wait_for()
        assert page.evaluate("document.documentElement.scrollWidth") <= 360


def test_it_engages_and_stops_and_loads_nothing_from_elsewhere(drive, page):
    page.goto(drive)
    see(page, "Not ready")
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    press(page, "EMERGENCY")
    see(page, "Emergency stop")
    press(page, "Acknowledge")
    see(page, "Ready")
    press(page, "1 Prepare")
    press(page, "2 Engage")
    see(page, "Steering")
    page.locator("body:not(.old-picture)").wait_for()
    assert float(page.locator(".body-figure b").first.inner_text()) < 100.0
    press(page, "Line 2 cm to the left")
    page.get_by_text("◀ 2 cm").or_(page.get_by_text("▶ 2 cm")).wait_for()
    cut = "(all) => all.filter((each) => each.getBoundingClientRect().right > innerWidth).length"
    assert page.locator(".controls .q-btn").evaluate_all(cut) == 0
    small = (
        "(all) => all.filter((each) => each.offsetHeight && Math.min(each.offsetWidth, each.offsetHeight) < 48).length"
    )
    assert page.locator("button").evaluate_all(small) == 0
    press(page, "STOP")
    see(page, "Stopped")
    look_at_the_other_pages(drive, page)
    elsewhere = [url for url in page.asked if not url.startswith((drive, "data:"))]
    assert elsewhere == []
    assert any("_nicegui_ws" in url for url in page.asked)
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
    page.get_by_text("Changes of state are silent").wait_for()
    page.goto(f"{drive}setup")
    see(page, "Set-up")
    page.locator(chosen).wait_for()
    assert not page.evaluate("sounds()")
    assert page.troubles == []


def test_a_wrong_file_is_refused_with_what_to_do(drive, page):
    page.goto(f"{drive}fields")
    see(page, "Fields and lines")
    choose = page.locator("input[type=file]")
    choose.set_input_files({"name": "photo.jpg", "mimeType": "image/jpeg", "buffer": b"\xff\xd8\xff"})
    page.get_by_text("photo.jpg: is of none of the types").wait_for()
    choose.set_input_files({"name": "large.kml", "mimeType": "text/xml", "buffer": b" " * (9 << 20)})
    page.get_by_text("one file of at most 8 MiB").wait_for()


def test_a_page_that_is_cut_off_says_that_its_picture_is_old(drive, page):
    page.goto(drive)
    page.locator("body:not(.old-picture)").wait_for()
    page.context.set_offline(True)
    page.evaluate("window.socket.disconnect()")
    page.locator("body.old-picture").wait_for(timeout=10_000)
    assert "OLD PICTURE" in page.locator(".old").inner_text()


def test_one_of_two_browsers_has_control_and_the_other_sees_who_and_is_refused(drive, another):
    one, other = another(), another()
    for page in (one, other):
        page.goto(drive)
        page.locator("body:not(.old-picture)").wait_for()
    press(one, "EMERGENCY")
    see(one, "Emergency stop")
    see(other, "Emergency stop")
    press(one, "Acknowledge")
    one.get_by_text("You have control").wait_for()
    other.get_by_text("has control").wait_for()
    press(other, "Ask for control")
    one.get_by_text("asks for control").wait_for()
    press(one, "EMERGENCY")
    press(other, "Acknowledge")
    other.get_by_text("another operator holds the lease").or_(other.get_by_text("the vehicle moves")).first.wait_for()


def test_a_curve_is_recorded_while_driving(drive, page):
    page.goto(f"{drive}fields")
    press(page, "● Record a curve")
    page.get_by_text("Recording:").wait_for()
    press(page, "Discard")
    page.get_by_text("Recording:").wait_for(state="hidden")


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
