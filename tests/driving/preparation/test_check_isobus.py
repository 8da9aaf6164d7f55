"""`drawbar check` of what is on an ISOBUS, with a clock of its own."""

import re
from dataclasses import replace

import pytest
from isobus_bench import GOOD
from isobus_devices import isobus_devices

from drawbar.driving.devices.actuators import isobus_wire
from drawbar.driving.preparation import check_isobus as check
from drawbar.driving.stand_in.memory_transports import MemoryBus
from drawbar.machine.stand_in.can_machine import CanMachine
from drawbar.protocols.isobus.address import CLAIM
from drawbar.protocols.isobus.guidance_messages import MACHINE_INFO, encode_machine_info
from drawbar.protocols.isobus.identifier import Message, encode
from drawbar.protocols.isobus.name import Name

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
        self.on, self.other = True, MemoryBus(ends, lambda: self.now)

    def _looks(self, seconds):
        for look in range(round(seconds / LOOK)):
            self.now = look * LOOK
            if self.on:
                self.machine.step(self.now, {"tractor": 0.1, "trailer": -0.05}, 1.0)
            self.also(look)
            yield self.now

    def also(self, look):
        """Do what else happens at a look."""

    def findings(self, *, drives=True):
        return {each.device: each for each in check.check_isobus(self.settings, 4.0, drives=drives)}


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


def test_another_device_that_claims_a_valves_address_is_reported(monkeypatch):
    yard, name = Yard(monkeypatch), Name(identity=900, manufacturer=0, function=0, device_class=1).data

    def also(look):
        if look == 100:
            yard.other.write(encode(Message(pgn=CLAIM, source=38, data=name)))

    yard.also = also
    found = yard.findings()
    assert found["tractor valve"].problems == [
        "two devices claim its address, of which one must leave it: give each its own, or leave one off"
    ]
    assert not found["trailer valve"].problems


def test_two_valves_that_report_from_one_address_are_reported(monkeypatch):
    yard, other = Yard(monkeypatch), encode_machine_info(replace(GOOD, curvature=0.0))

    def also(look):
        if look > 100 and look % 5 == 2:  # before, the valve would look for another address
            yard.other.write(encode(Message(pgn=MACHINE_INFO, source=38, data=other)))

    yard.also = also
    found = yard.findings()
    (problem,) = found["tractor valve"].problems
    assert re.match(r"its angle jumped away and back \d\d times: two valves report from its address", problem)
    assert not found["trailer valve"].problems


def test_a_second_valve_where_no_address_is_given_is_reported(monkeypatch):
    yard = Yard(monkeypatch)
    valve = yard.settings.tractor_valve.model_copy(update={"address": None})
    yard.settings = yard.settings.model_copy(update={"tractor_valve": valve, "trailer_valve": None})
    found = yard.findings()
    assert found["tractor valve"].problems == [
        "a second valve reports on this bus: write the address of the one that is meant"
    ]


@pytest.mark.parametrize("device", ["tractor valve", "trailer valve", "tractor's speed"])
def test_a_bus_without_anybody_is_reported(monkeypatch, device):
    yard = Yard(monkeypatch)
    yard.on = False
    assert not yard.findings()[device].received


def test_a_bus_that_cannot_be_opened_is_reported_with_what_to_do():
    settings = isobus_devices("can:socketcan:drawbar9").isobus
    found = {each.device: each for each in check.check_isobus(settings, 0.05, drives=True)}
    assert found.keys() == {"ISOBUS"}
    (problem,) = found["ISOBUS"].problems
    assert "socketcan drawbar9 cannot be opened" in problem
    assert "its interface is up" in problem


def test_of_a_bus_without_trouble_nothing_is_said(monkeypatch):
    assert "ISOBUS" not in Yard(monkeypatch).findings()
