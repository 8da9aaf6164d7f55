"""`drawbar check` of what is on an ISOBUS, with a clock of its own."""

import pytest
from isobus_devices import isobus_devices

from drawbar.driving.devices.actuators import isobus_wire
from drawbar.driving.preparation import check
from drawbar.driving.stand_in.memory_transports import MemoryBus
from drawbar.machine.stand_in.can_machine import CanMachine

LOOK = 0.02


class Yard:
    """A machine on a bus in memory, which moves on at each look of the check."""

    def __init__(self, monkeypatch):
        self.now, ends = 0.0, []
        self.settings = isobus_devices().isobus
        self.machine = CanMachine(MemoryBus(ends, lambda: self.now), self.settings, takes_speed=True)
        near = MemoryBus(ends, lambda: self.now)
        monkeypatch.setattr(check, "isobus_wire", lambda settings, limit: isobus_wire(settings, limit, near))
        monkeypatch.setattr(check, "poll_times", self._looks)
        self.on = True

    def _looks(self, seconds):
        for look in range(round(seconds / LOOK)):
            self.now = look * LOOK
            if self.on:
                self.machine.step(self.now, {"tractor": 0.1, "trailer": -0.05}, 1.0)
            yield self.now

    def findings(self, *, drives=True):
        return {each.device: each for each in check._isobus(self.settings, 4.0, drives=drives)}


def test_what_is_ready_is_reported_with_its_angle_and_nothing_is_asked_for(monkeypatch):
    yard = Yard(monkeypatch)
    found = yard.findings()
    assert found["tractor valve"].facts == ["angle 5.7°", "ready"]
    assert found["trailer valve"].facts == ["angle -2.9°", "ready"]
    assert found["tractor's speed"].facts == ["ready"]
    assert not any(each.problems for each in found.values())
    assert not any(valve.engaged for valve in yard.machine.valves.values())
    assert yard.machine.tractor.commanded(yard.now) is None
    assert "tractor's speed" not in yard.findings(drives=False)


def test_what_is_silent_or_locked_out_is_reported_with_what_to_do(monkeypatch):
    yard = Yard(monkeypatch)
    yard.machine.valves["tractor"].locked_out = True
    yard.machine.valves["trailer"].silent = True
    found = yard.findings()
    assert "display" in found["tractor valve"].problems[0]
    assert not found["trailer valve"].received
    assert "check its power" in found["trailer valve"].problems[0]


@pytest.mark.parametrize("device", ["tractor valve", "trailer valve", "tractor's speed"])
def test_a_bus_without_anybody_is_reported(monkeypatch, device):
    yard = Yard(monkeypatch)
    yard.on = False
    assert not yard.findings()[device].received


def test_a_bus_that_cannot_be_opened_is_reported_with_what_to_do():
    settings = isobus_devices("can:socketcan:drawbar9").isobus
    found = {each.device: each for each in check._isobus(settings, 0.05, drives=True)}
    assert found.keys() == {"ISOBUS"}
    (problem,) = found["ISOBUS"].problems
    assert "socketcan drawbar9 cannot be opened" in problem
    assert "its interface is up" in problem


def test_of_a_bus_without_trouble_nothing_is_said(monkeypatch):
    assert "ISOBUS" not in Yard(monkeypatch).findings()
