"""Positions for casters that send corrections for a place."""

from collections.abc import Callable

import pytest
from caster_bench import FAST, GGA, LOGIN, Bench
from waiting import until

from drawbar.machine.hardware.corrections.status import CorrectionsState
from drawbar.machine.stand_in.caster import Caster, CasterSettings, Dialect


@pytest.mark.parametrize(("dialect", "version"), [(Dialect.V1, 1), (Dialect.V2_CHUNKED, 2)])
def test_position_is_sent_at_once_and_every_ten_seconds(
    connect: Callable[..., Bench], dialect: Dialect, version: int
) -> None:
    with Caster(CasterSettings(dialect=dialect, login=LOGIN, interval=FAST, needs_position=True)) as caster:
        bench = connect(caster.port, version=version)
        assert bench.client.position(GGA)
        bench.until_state(CorrectionsState.FLOWING)
        first = bench.status.uploads
        until(lambda: len(caster.positions) >= 1)
        assert (b"Ntrip-GGA: " + GGA.strip() in caster.requests[0]) == (version == 2)
        for _ in range(8):
            received = bench.status.received
            bench.clock.now += 5.0
            bench.until(lambda received=received: bench.status.received > received)
        assert bench.status.uploads - first == 4
        sent = bench.status.uploads + (version == 1)  # version 1's also follows the request
        until(lambda: len(caster.positions) == sent)
        assert set(caster.positions) == {GGA.strip()}


def test_position_without_a_fix_is_never_sent(connect: Callable[..., Bench]) -> None:
    no_fix = GGA[:6] + b",,,,,,0,00,,,M,,M,,*66\r\n"
    with Caster(CasterSettings(login=LOGIN, interval=FAST, needs_position=True)) as caster:
        bench = connect(caster.port)
        assert not bench.client.position(no_fix)
        bench.until_state(CorrectionsState.LISTENING)
        bench.clock.now += 30.0
        bench.advance()
        assert bench.status.state is CorrectionsState.LISTENING, "a network may be waiting for the first fix"
        bench.client.position(GGA)
        bench.until_state(CorrectionsState.FLOWING)
        assert not bench.client.position(no_fix)
        bench.clock.now += 5.0
        received = bench.status.received
        bench.until(lambda: bench.status.received > received)
        bench.clock.now += 5.0
        bench.until(lambda: bench.status.uploads == 2)
        until(lambda: len(caster.positions) == 2)
        assert set(caster.positions) == {GGA.strip()}, "the last one with a fix continues"


def test_stream_that_waits_for_a_position_in_vain_is_given_up_in_the_end(connect: Callable[..., Bench]) -> None:
    with Caster(CasterSettings(login=LOGIN, interval=FAST, needs_position=True)) as caster:
        bench = connect(caster.port)
        bench.until_state(CorrectionsState.LISTENING)
        bench.clock.now += 60.0
        bench.advance()
        assert "waiting for a position, and the receiver has no fix" in bench.status.message
