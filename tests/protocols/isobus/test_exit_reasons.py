"""Why a steering valve last ceased to steer: how long that counts where it keeps the reason."""

from dataclasses import replace

import pytest
from isobus_bench import GOOD, PASSING, Bench

from drawbar.protocols.actuator import Readiness
from drawbar.protocols.isobus.guidance_messages import ExitReason, Intention

OFF, ON = Intention.NOT_INTENDED, Intention.INTENDED


@pytest.mark.parametrize("reason", PASSING)
def test_an_exit_reason_that_a_ready_valve_keeps_is_over_after_a_second(reason: ExitReason) -> None:
    bench = Bench()
    bench.run(1.5)
    bench.info = replace(GOOD, exit_reason=reason)
    bench.run(0.9)
    assert bench.valve.report(bench.time).readiness is not Readiness.READY
    bench.run(0.4)
    assert bench.valve.report(bench.time).readiness is Readiness.READY
    assert {what for _, what in bench.run(0.2, steer=True)} == {ON}
    bench.info = GOOD
    assert {what for _, what in bench.run(2.0, steer=True)} == {ON}
    bench.info = replace(GOOD, exit_reason=reason)
    assert [what for _, what in bench.run(0.5, steer=True)][1:] == [OFF] * 4


@pytest.mark.parametrize("change", [{"ready": False}, {"in_position": False}, {"locked_out": True}])
def test_an_exit_reason_of_a_valve_that_is_not_ready_is_not_over(change: dict[str, object]) -> None:
    bench = Bench()
    bench.info = replace(GOOD, exit_reason=ExitReason.OPERATOR_OVERRIDE, **change)
    bench.run(4.0)
    assert bench.valve.report(bench.time).readiness is Readiness.OVERRIDDEN


def test_a_valve_that_steers_must_clear_its_exit_reason_within_half_a_second() -> None:
    bench = Bench()
    bench.info = replace(GOOD, exit_reason=ExitReason.OPERATOR_OVERRIDE)
    bench.run(2.0)
    said = bench.run(1.5, steer=True)
    first = said[0][0]
    assert {what for time, what in said if time <= first + 0.5} == {ON}
    assert {what for time, what in said if time > first + 0.7} == {OFF}
    assert bench.valve.report(bench.time).overridden


def test_another_exit_reason_is_news_again() -> None:
    bench = Bench()
    bench.info = replace(GOOD, exit_reason=ExitReason.OPERATOR_OVERRIDE)
    bench.run(2.0)
    bench.info = replace(GOOD, exit_reason=ExitReason.COMMAND_TIMEOUT)
    bench.run(0.5)
    assert bench.valve.report(bench.time).readiness is Readiness.NOT_READY
    bench.info = None
    bench.run(0.5)
    bench.info = replace(GOOD, exit_reason=ExitReason.COMMAND_TIMEOUT)
    bench.run(0.9)
    assert bench.valve.report(bench.time).readiness is not Readiness.READY
