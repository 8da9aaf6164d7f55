"""The speed actuator of a tractor on the ISOBUS, against the stand-in tractor on a wire."""

import pytest
from can_adapter import Wire

from drawbar.machine.stand_in.can_devices import CanDevices
from drawbar.machine.stand_in.tractor_ecu import StandInTractor
from drawbar.protocols.actuator import Readiness
from drawbar.protocols.isobus.address import AddressClaim
from drawbar.protocols.isobus.guidance_messages import PASSING_EXITS, ExitReason
from drawbar.protocols.isobus.name import Name
from drawbar.protocols.isobus.node import IsobusNode
from drawbar.protocols.isobus.speed_actuator import MachineSpeed
from drawbar.protocols.speed_actuator import SpeedRequest
from drawbar.transports.base import CanFrame

TICK = 0.02
DECELERATION = 0.5


def node(identity: int, address: int) -> IsobusNode:
    return IsobusNode(AddressClaim(Name(identity=identity, manufacturer=1407, function=29), address))


class Yard:
    """Both sides on a wire, with a clock."""

    def __init__(self) -> None:
        self.wire, self.ticks = Wire(), 0
        self.bus, far = self.wire.end(), self.wire.end()
        self.speed = MachineSpeed(node(1000, 0x80), 3.0)
        machine = node(3, 0xA2)
        self.tractor = StandInTractor(machine)
        self.devices = CanDevices(far, [machine])

    def run(self, seconds: float, speed: float | None = None) -> "Yard":
        request = SpeedRequest(drive=speed is not None, speed=speed or 0.0, deceleration=DECELERATION)
        for _ in range(round(seconds / TICK)):
            self.wire.time = self.ticks * TICK
            self.devices.step(self.wire.time)
            for received, frame in self.bus.read():
                self.speed.receive(received, frame)
            for frame in self.speed.send(self.wire.time, request):
                self.bus.write(frame)
            self.ticks += 1
        return self

    @property
    def commanded(self) -> float | None:
        return self.tractor.commanded(self.wire.time)

    @property
    def readiness(self) -> Readiness:
        return self.speed.report(self.wire.time).readiness


def test_it_asks_for_no_speed_until_it_is_to_drive() -> None:
    yard = Yard().run(0.5)
    assert yard.readiness in (Readiness.ADDRESS_LOST, Readiness.SILENT, Readiness.TOO_NEW)
    yard.run(2.5)
    assert yard.readiness is Readiness.READY
    assert yard.commanded is None
    assert not yard.speed.report(yard.wire.time).engaged
    yard.run(0.5, 1.25)
    assert yard.commanded == 1.25
    assert yard.speed.report(yard.wire.time).engaged


def test_it_stops_by_a_ramp_and_holds_zero() -> None:
    yard = Yard().run(3.0).run(0.5, 1.0)
    yard.run(1.0)
    assert yard.commanded == pytest.approx(1.0 - DECELERATION * 1.0, abs=0.06)
    assert not yard.speed.report(yard.wire.time).overridden
    yard.run(5.0)
    assert yard.commanded == 0.0
    yard.run(0.5, 0.5)
    assert yard.commanded == 0.5


def test_after_a_lost_address_it_does_not_drive_on_but_holds_zero_and_drives_when_asked_again() -> None:
    yard = Yard().run(3.0).run(0.5, 1.0)
    stronger = Name(identity=1, manufacturer=0, function=0)
    yard.wire.end().write(CanFrame(0x18EEFF80, stronger.data))
    yard.run(8.0, 1.0)
    assert yard.commanded is None
    assert not yard.speed.report(yard.wire.time).engaged
    yard.run(2.5)
    assert yard.commanded == 0.0
    yard.run(0.5, 0.5)
    assert yard.commanded == 0.5
    assert yard.speed.report(yard.wire.time).engaged


def test_an_operator_who_takes_over_is_not_driven_against() -> None:
    yard = Yard().run(3.0).run(0.5, 1.0)
    yard.tractor.operator_drives = True
    yard.run(0.3, 1.0)
    assert yard.speed.report(yard.wire.time).overridden
    yard.tractor.operator_drives = False
    yard.run(1.0, 1.0)
    assert yard.commanded is None
    yard.run(0.3)
    assert not yard.speed.report(yard.wire.time).overridden
    assert yard.run(0.5, 1.0).commanded == 1.0


def test_a_tractor_that_falls_silent_is_not_engaged() -> None:
    yard = Yard().run(3.0).run(0.5, 1.0)
    yard.tractor.wheel_speed = None
    yard.run(0.5, 1.0)
    assert yard.readiness is Readiness.SILENT
    assert not yard.speed.report(yard.wire.time).engaged


def test_a_speed_beyond_the_limit_is_not_asked_for() -> None:
    yard = Yard().run(3.0).run(0.5, 1.0).run(0.3, 3.5)
    assert yard.commanded is None


@pytest.mark.parametrize("reason", PASSING_EXITS)
def test_an_exit_reason_that_a_tractor_keeps_is_over_after_a_second(reason: ExitReason) -> None:
    yard = Yard().run(3.0)
    yard.tractor.exit_reason = reason
    assert yard.run(0.8).readiness in (Readiness.NOT_READY, Readiness.OVERRIDDEN)
    assert yard.run(0.5).readiness is Readiness.READY
    yard.run(0.3, 1.0)
    yard.tractor.exit_reason = ExitReason.NONE
    assert yard.run(1.0, 1.0).commanded == 1.0
    assert yard.speed.report(yard.wire.time).engaged
    yard.tractor.exit_reason = reason
    yard.run(0.3, 1.0)
    assert not yard.speed.report(yard.wire.time).engaged


def test_a_tractor_that_drives_must_clear_its_exit_reason_within_half_a_second() -> None:
    yard = Yard().run(3.0)
    yard.tractor.exit_reason = ExitReason.OPERATOR_OVERRIDE
    yard.run(2.0).run(0.4, 1.0)
    assert yard.commanded == 1.0
    yard.run(0.4, 1.0)
    assert yard.speed.report(yard.wire.time).overridden
    assert yard.commanded is None


@pytest.mark.parametrize("reason", [ExitReason.NOT_CALIBRATED, ExitReason.FUNCTION_FAULT, 40])
def test_other_exit_reasons_stand_against_driving_for_as_long_as_they_are_reported(reason: int) -> None:
    yard = Yard().run(3.0)
    yard.tractor.exit_reason = reason
    assert yard.run(5.0).readiness is Readiness.NOT_READY
    yard.tractor.exit_reason, yard.tractor.operator_drives = ExitReason.OPERATOR_OVERRIDE, True
    assert yard.run(5.0).readiness is Readiness.OVERRIDDEN
