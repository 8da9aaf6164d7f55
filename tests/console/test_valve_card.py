"""The card that pushes a bare valve, by simulated users: two steps, live, ended by STOP, by steering, by silence."""

import math
import threading
from dataclasses import replace

import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import staged, until
from nicegui import ui
from pushed_valve import SETTINGS, PushedValve

from drawbar.config import load_configuration
from drawbar.console import valve_card
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.messages import Action


class Bench:
    """A valve whose time passes while `goes` is set, or as fast as it can."""

    def __init__(self, monkeypatch):
        self.goes, self.lines = threading.Event(), []
        self.goes.set()
        monkeypatch.setattr(valve_card, "open_bare_valve", self._opened)

    def _opened(self, settings, wheelbase, motion):
        assert settings.counts == SETTINGS.counts
        self.lines.append(PushedValve(scale=0.9, each=lambda time, line: self.goes.wait(120.0)))
        return self.lines[-1].machine()

    @property
    def is_off(self):
        return self.lines[-1].received[-1] == 0


@pytest.fixture
def bench(monkeypatch):
    monkeypatch.setattr(valve_card, "PATIENCE", 600.0)  # nobody draws here, however long a busy machine takes
    return Bench(monkeypatch)


async def opened(stage, browser):
    """Return a page of a drive whose stand-ins have a bare valve."""
    machine = load_configuration("articulated", ["machine.attitude.tractor.present=true"])
    stage.next_drive.driven = with_stand_ins(machine)
    return await browser().open("/setup")


async def ended(stage):
    await until(lambda: stage.link.pushing is None)  # what was found is shown within the same turn


def test_it_pushes_draws_and_keeps_what_it_found(bench):
    @staged
    async def test(stage, browser):
        one = await opened(stage, browser)
        assert not one.enabled("2 Move now")
        bench.goes.clear()
        one.press("1 All is clear")
        one.press("2 Move now")
        await until(lambda: stage.link.pushing is not None)
        assert "moves the front wheels" in one.text()
        bench.goes.set()
        await ended(stage)
        assert "left: dead band: 0.14" in one.text()
        assert "✓ 6 / 6" in one.text()
        assert "✓ 10 / 10" in one.text()
        assert "settings of drawbar_actuate" in one.text()
        assert bench.is_off
        assert not bench.lines[0].connected
        assert sum(isinstance(each, ui.echart) and each.visible for each in one.user.client.elements.values()) == 2
        stage.next_drive.configuration = stage.next_drive.driven
        one.refresh()
        one.press("Save the sensor's scale")
        assert "saved" in one.notifications().lower()
        (version,) = stage.next_drive.versions.all()
        saved = load_configuration(str(version.file)).devices.bare_valve.angles
        assert saved == pytest.approx([0.9 * each for each in SETTINGS.angles], rel=0.05)

    test()


def test_stop_and_end_and_steering_and_a_page_that_hangs_end_it(bench):
    @staged
    async def test(stage, browser):
        one = await opened(stage, browser)

        def engages(pushing):
            gate = stage.link.gate
            stage.link._receive_gate(replace(gate, steers=1))
            stage.link._receive_gate(gate)

        ways = {
            "stopped by the operator": lambda pushing: one.press("■ End"),
            "by the operator": lambda pushing: stage.link.ask(one.page._visitor, Action.STOP),
            "drawbar steers now": engages,
            "no picture was drawn": lambda pushing: setattr(pushing, "_attended", -math.inf),
        }
        stage.run(0.1)
        for words, happen in ways.items():
            bench.goes.clear()
            one.press("1 All is clear")
            one.press("2 Move now")
            await until(lambda: stage.link.pushing is not None)
            one.refresh()
            assert not one.enabled("1 All is clear")
            happen(stage.link.pushing)
            bench.goes.set()
            await ended(stage)
            assert words in one.text()
            assert bench.is_off
            one.refresh()
            assert not one.enabled("Save the sensor's scale")

    test()


def test_nothing_is_moved_while_drawbar_steers_or_without_the_first_step(bench):
    @staged
    async def test(stage, browser):
        drives = await browser().open()
        stage.run(4.0, drives)
        one = await opened(stage, browser)
        with one.user.client:
            await one.page._valve._push()  # a forged event
        one.press("1 All is clear")
        for action in (Action.ARM, Action.ENGAGE):
            stage.link.ask(drives.page._visitor, action)
            stage.run(0.2, drives)
        one.refresh()
        assert not one.enabled("1 All is clear")
        with one.user.client:
            await one.page._valve._push()
        assert bench.lines == []

    test()


@staged
async def test_without_a_bare_valve_there_is_no_card(stage, browser):
    one = await browser().open("/setup")
    assert "Valve or motor without a loop" not in one.text()
