"""Another device at the address of a steering valve."""

from dataclasses import replace

import pytest
from isobus_bench import VALVE, Bench

from drawbar.protocols.actuator import Readiness
from drawbar.protocols.isobus.address import CLAIM
from drawbar.protocols.isobus.guidance_messages import Intention
from drawbar.protocols.isobus.name import Name

ITS = Name(identity=50, manufacturer=200, function=130)
STRONGER, WEAKER = replace(ITS, identity=49), replace(ITS, identity=51)
OFF, ON = Intention.NOT_INTENDED, Intention.INTENDED


@pytest.mark.parametrize("address", [VALVE, None])
def test_a_stronger_device_at_the_valves_address_is_no_valve_until_it_has_reported_for_a_second(
    address: int | None,
) -> None:
    bench = Bench(address=address)
    bench.run(0.5)
    bench.receive(CLAIM, ITS.data)
    bench.engage()
    assert not bench.valve.contested
    bench.receive(CLAIM, STRONGER.data)
    (_, first), *_ = said = bench.run(0.5, steer=True)  # its machine information comes without a gap
    assert {first, *(what for _, what in said)} == {OFF}
    assert bench.valve.contested
    assert bench.valve.report(bench.time).readiness is Readiness.FAULT
    bench.run(0.2)
    assert bench.valve.report(bench.time).readiness is Readiness.TOO_NEW
    bench.run(0.6)
    assert {what for _, what in bench.run(0.5, steer=True)} == {ON}


@pytest.mark.parametrize(
    ("data", "contested"), [(ITS.data, False), (WEAKER.data, True), (STRONGER.data[:7], False), (b"", False)]
)
def test_a_weaker_claim_and_the_valves_own_end_nothing(data: bytes, contested: bool) -> None:
    bench = Bench(address=VALVE)
    bench.receive(CLAIM, ITS.data)
    bench.engage()
    for claim in (data, ITS.data):
        bench.receive(CLAIM, claim)
        assert {what for _, what in bench.run(1.0, steer=True)} == {ON}
    assert bench.valve.contested is contested


def test_claims_of_other_addresses_are_others() -> None:
    bench = Bench(address=VALVE)
    bench.receive(CLAIM, ITS.data)
    bench.receive(CLAIM, STRONGER.data, 0x27)
    bench.engage()
    assert not bench.valve.contested


def test_another_valve_that_is_found_where_none_is_named_contests_nothing() -> None:
    bench = Bench()
    bench.run(0.5)
    bench.receive(CLAIM, ITS.data)
    bench.info = None
    bench.run(1.0)
    bench.tell(0x27)
    bench.receive(CLAIM, STRONGER.data, 0x27)
    assert not bench.valve.contested


def test_angles_of_two_valves_at_one_address_swing_and_those_of_one_do_not() -> None:
    bench = Bench(address=VALVE)
    bench.run(2.0)
    assert bench.valve.swings.count == 0
    bench.info = None
    for number in range(10):
        bench.tell(curvature=0.1 if number % 2 else 0.15)
        bench.run(0.06)
    assert bench.valve.swings.count == 9


def test_two_valves_at_one_address_end_steering_and_an_outlier_does_not() -> None:
    bench = Bench(address=VALVE).engage()
    bench.tell(curvature=0.15)
    assert {what for _, what in bench.run(1.0, steer=True)} == {ON}
    assert bench.valve.swings.count == 1
    for _ in range(5):
        bench.tell(curvature=0.15)
        bench.run(0.1, steer=True)
    assert bench.valve.report(bench.time).readiness is Readiness.FAULT
    assert {what for _, what in bench.run(1.0, steer=True)} == {OFF}
    bench.run(0.4)
    assert bench.valve.report(bench.time).readiness is Readiness.READY
