"""A console in memory: the gate's real engagement behind it, a clock of its own, NiceGUI's simulated users."""

import asyncio
import functools
import math
import os
import re
import sys
import tempfile
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path

import httpx
from fixes import fixes_of
from nicegui import Client, core, ui
from nicegui.functions.navigate import Navigate
from nicegui.functions.notify import notify
from nicegui.testing.general import nicegui_reset_globals, prepare_simulation
from nicegui.testing.user import User

from drawbar.config import load_configuration
from drawbar.console.audit import Audit
from drawbar.console.drawing import Lines
from drawbar.console.instruments import Instruments
from drawbar.console.link import Link
from drawbar.console.next_drive import NextDrive
from drawbar.console.pages import Pages
from drawbar.driving.messaging.console_options import ConsoleOptions
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.geometry import LocalFrame
from drawbar.guidance.figure_eight import figure_eights
from drawbar.messages import ControllerState
from drawbar.messages.records import encode
from drawbar.safety.causes import Cause
from drawbar.safety.engagement import Engagement, Situation
from drawbar.safety.gate_report import Actuation, Counts, Tick, gate_state
from drawbar.safety.operator_requests import OperatorRequests
from drawbar.safety.settings import SafetySettings

HOST = "test"
FRAME = LocalFrame(latitude=50.87, longitude=4.7)
STANDING = {
    "speed": 1.0,
    "workingWidth": 3.0,
    "boundary": [],
    "tractor": [],
    "trailer": [],
    "steered": 0,
    "tubes": [0.1, 0.2],
}
TICK = 20_000_000
"""ns"""


class Stage:
    """Gate and link; `run` lets time pass."""

    def __init__(self, audit=None, folder=None):
        self.settings = SafetySettings()
        self.engagement = Engagement(self.settings)
        self.requests = OperatorRequests(self.settings, self.engagement)
        self.now, self.sequence = 100 * 10**9, 0
        self.causes, self.standing, self.silent = set(), False, False
        self.sent = []
        self.configuration = load_configuration("articulated")
        self.link = Link(self._send, Audit(audit), lambda: self.now, self.configuration.vehicle)
        folder = folder or Path("nowhere")
        self.next_drive = NextDrive(
            self.configuration,
            with_stand_ins(self.configuration),
            FRAME,
            fields=folder / "fields",
            setup=folder / "setup",
        )

    @property
    def time(self):
        """s"""
        return self.now * 1e-9

    def _send(self, message):
        self.sent.append(message)
        self.requests.receive(self.time, message)

    def run(self, duration, *watching):
        """Let time pass, s; pages that watch draw what they are sent, and say so, ten times a second."""
        for count in range(round(duration / (TICK * 1e-9))):
            self.now += TICK
            self._tick()
            self.link.pass_time()
            if count % 5 == 0:
                for page in watching:
                    page.draw()

    def _tick(self):
        causes = set(self.causes)
        if self.requests.age(self.time) > self.settings.drive.operator:
            causes.add(Cause.NO_OPERATOR)
        self.engagement.update(
            self.time,
            Situation(causes=tuple(causes), actions=self.requests.take(), taken=True, standing=self.standing),
        )
        self.sequence += 1
        tick = Tick(
            now=self.time,
            causes=sorted(causes, key=lambda cause: cause.value),
            actuation=Actuation(tractor=None, trailer=None, speed=None),
            angles=(math.nan, math.nan),
            speed_limit=1.0,
        )
        state = gate_state(tick, self.engagement, self.requests, Counts(states=self.sequence), valid=1.0)
        self.requests.show(state.sequence, state.time)
        if not self.silent:
            self.link.receive(encode(state))

    def receive_controller(self, **values):
        """Let the controller say where both bodies are."""
        names = ["lateral_deviation", "heading_deviation", "tractor_heading_error", "trailer_heading_error"]
        numbers = dict.fromkeys([*names, "hitch_angle"], 0.0)
        numbers |= {"correction_age": 1.0, "wheel_speed": 1.0, "receiver_speed": 1.0}
        numbers |= {"tractor_lateral_error": 0.0, "trailer_lateral_error": 0.0} | values
        now = self.now
        counts = dict.fromkeys(["configuration", "wiggled", "status", "flags", "solved", "overruns"], 0)
        qualities = {"tractor_quality": 5, "trailer_quality": 5}
        self.link.receive(encode(ControllerState(time=now, valid_until=now + 10**9, **counts, **(qualities | numbers))))

    def receive_fixes(self, x, y, course=math.nan, quality=5, satellites=(0, 0), **values):
        """Let the receivers say where the tractor's antenna is."""
        whole = ("sequence", "valid_until", "hitch_angle_time", "wheel_speed_time")
        numbers = dict.fromkeys((*whole, "tractor_attitude_time", "trailer_attitude_time"), 0)
        numbers |= {"time": self.now, "epoch": self.now, "first_byte": self.now, "trailer_quality": quality}
        numbers |= {"tractor_x": x, "tractor_y": y, "tractor_course": course, "tractor_quality": quality}
        numbers |= dict(zip(("tractor_satellites", "trailer_satellites"), satellites, strict=True)) | values
        self.link.receive(encode(fixes_of(math.nan, **numbers)))


class Watcher:
    """A simulated user with a browser that draws."""

    def __init__(self, stage, pages):
        http = httpx.AsyncClient(transport=httpx.ASGITransport(core.app), base_url=f"http://{HOST}")
        self.stage, self.pages, self.user = stage, pages, User(http)

    async def open(self, path="/"):
        await self.user.open(path)
        return self

    @property
    def page(self):
        return self.pages._open[self.user.client.id][1]

    def refresh(self):
        with self.user.client:
            self.page.refresh()

    def draw(self):
        """Do what the browser does with a picture."""
        self.refresh()
        if not self.stage.link.is_stale:
            self.user.find(Instruments).trigger("drawn", self.stage.link.gate.sequence)

    def press(self, text):
        """Press a button, found by its text or mark."""
        self.button(text).click()

    def button(self, text):
        return self.user.find(kind=ui.button, content=text) if text in self._contents() else self.user.find(text)

    def _contents(self):
        return [element.text for element in self.user.client.elements.values() if isinstance(element, ui.button)]

    def enabled(self, text):
        (found,) = (
            each for each in self.user.client.elements.values() if isinstance(each, ui.button) and each.text == text
        )
        return found.enabled and found.visible

    def text(self):
        """Return all visible texts of labels, one a line."""
        labels = (each for each in self.user.client.elements.values() if isinstance(each, ui.label))
        return "\n".join(each.text for each in labels if _seen(each))

    def notifications(self):
        return " / ".join(self.user.notify.messages)


def _seen(element):
    while element is not None:
        if not element.visible:
            return False
        element = element.parent_slot.parent if element.parent_slot else None
    return True


@contextmanager
def _modules_kept():
    """Keep drawbar's modules, which NiceGUI takes away where they hold pages: other tests go on with them."""
    kept = {name: module for name, module in sys.modules.items() if name.partition(".")[0] == "drawbar"}
    try:
        yield
    finally:
        sys.modules.update(kept)


@asynccontextmanager
async def console(stage, users=None, **options):
    """Serve the pages to simulated browsers; yields what opens a new one."""
    settings = ConsoleOptions(**{"folder": "", "configuration": "", "names": (HOST,), **options})
    with _modules_kept(), nicegui_reset_globals():
        os.environ["NICEGUI_USER_SIMULATION"] = "true"
        try:
            prepare_simulation()
            lines = Lines(figure_eights((8.0,), 20.0), 3.0)
            pages = Pages(settings, stage.link, stage.next_drive, STANDING, lines, users, stage.link._audit)
            pages.install()
            ui.run(storage_secret="simulated", reload=False, show=False)
            failure = None
            async with core.app.router.lifespan_context(core.app):
                try:
                    yield lambda: Watcher(stage, pages)
                except BaseException as error:  # NiceGUI ends its tasks only where its life ends well
                    failure = error
            if failure is not None:
                raise failure
        finally:
            os.environ.pop("NICEGUI_USER_SIMULATION", None)
            ui.navigate, ui.notify = Navigate(), notify


async def until(condition):
    """Wait until something that is done in a thread has happened."""
    for _ in range(1200):
        if condition():
            return
        await asyncio.sleep(0.05)
    raise AssertionError("it did not happen")


def client_id(text):
    """Return the id of the client in a page's text."""
    found = re.search(r"'client_id': '([0-9a-f-]+)'", text)
    assert found is not None
    assert found.group(1) in Client.instances
    return found.group(1)


def staged(test):
    """Run an asynchronous test with a stage and what opens browsers."""

    @functools.wraps(test)
    def run():
        async def whole():
            with tempfile.TemporaryDirectory() as folder:
                stage = Stage(folder=Path(folder))
                async with console(stage) as browser:
                    await test(stage, browser)

        asyncio.run(whole())

    del run.__wrapped__  # its parameters are no fixtures
    return run
