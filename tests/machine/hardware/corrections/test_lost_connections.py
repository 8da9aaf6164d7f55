"""Casters that are lost, silent or send noise: how long that is borne, and when the next attempt is."""

import socket
from collections.abc import Callable

import pytest
from caster_bench import FAST, LOGIN, Bench

from drawbar.machine.hardware.corrections.status import CorrectionsNews, CorrectionsState
from drawbar.machine.stand_in.caster import Caster, CasterFault, CasterSettings, Dialect

BROKEN = {
    CasterFault.CLOSE: "the other end has closed the connection",
    CasterFault.RESET: "Connection reset by peer",
}


@pytest.mark.parametrize("fault", BROKEN)
@pytest.mark.parametrize("dialect", [Dialect.V1, Dialect.V2_CHUNKED])
def test_lost_connection_is_reported_and_opened_again(
    connect: Callable[..., Bench], fault: CasterFault, dialect: Dialect
) -> None:
    with Caster(CasterSettings(dialect=dialect, login=LOGIN, interval=FAST, fault=fault)) as caster:
        bench = connect(caster.port)
        for attempt in range(1, 4):
            bench.until_state(CorrectionsState.WAITING)
            assert BROKEN[fault] in bench.status.message
            assert bench.status.attempts == attempt
            for _ in range(50):
                bench.advance()
            assert len(caster.requests) == attempt, "no attempt before its time"
            bench.clock.now += bench.status.next_attempt + 0.001
    if fault is CasterFault.CLOSE:  # a reset takes with it what was not read yet
        assert len(bench.frames) == 3 * 4


def test_what_is_wrong_is_told_once_and_that_it_is_over(connect: Callable[..., Bench]) -> None:
    news = CorrectionsNews()
    with Caster(CasterSettings(login=LOGIN, interval=FAST, fault=CasterFault.CLOSE)) as caster:
        bench = connect(caster.port)
        bench.until_state(CorrectionsState.WAITING)
        told = news.update(bench.status)
        assert told == [bench.status.message]
        assert "the other end has closed the connection; next attempt in 1 s" in told[0]
        bench.clock.now += 0.5
        assert news.update(bench.status) == []
        bench.clock.now += 1.0
        bench.until_state(CorrectionsState.FLOWING)
        assert news.update(bench.status) == ["corrections come again"]


def test_pause_is_short_again_after_a_stream_that_lasted(connect: Callable[..., Bench]) -> None:
    with Caster(CasterSettings(login=LOGIN, interval=FAST, fault=CasterFault.CLOSE, after=20)) as caster:
        bench = connect(caster.port)
        bench.until_state(CorrectionsState.WAITING)
        assert bench.status.next_attempt <= 1.2
        bench.clock.now += 1.2
        bench.until_state(CorrectionsState.WAITING)
        assert 10.0 <= bench.status.next_attempt <= 12.0, "it had not lasted"
        bench.clock.now += 12.0
        bench.until_state(CorrectionsState.FLOWING)
        for _ in range(8):
            received = bench.status.received
            bench.clock.now += 9.0
            bench.until(lambda received=received: bench.status.received > received)
        bench.until_state(CorrectionsState.WAITING)
        assert bench.status.next_attempt <= 1.2


def test_stalled_stream_is_given_up_after_ten_seconds(connect: Callable[..., Bench]) -> None:
    with Caster(CasterSettings(login=LOGIN, interval=FAST, fault=CasterFault.STALL)) as caster:
        bench = connect(caster.port)
        bench.until(lambda: len(bench.frames) == 4)
        bench.clock.now += 9.9
        bench.advance()
        assert bench.status.state is CorrectionsState.FLOWING
        assert bench.status.observation_age == pytest.approx(9.9)
        bench.clock.now += 0.1
        bench.advance()
        assert bench.status.state is CorrectionsState.WAITING
        assert "no byte for 10 s" in bench.status.message


@pytest.mark.parametrize("after", [0, 3])
@pytest.mark.parametrize(("fault", "interval"), [(CasterFault.DRIP, 0.05), (CasterFault.GARBAGE, FAST)])
def test_bytes_without_frames_are_given_up_after_ten_seconds(
    connect: Callable[..., Bench], fault: CasterFault, interval: float, after: int
) -> None:
    with Caster(
        CasterSettings(dialect=Dialect.V2_PLAIN, login=LOGIN, interval=interval, fault=fault, after=after)
    ) as caster:
        bench = connect(caster.port)
        bench.until(lambda: len(bench.frames) >= after and bench.status.received > sum(map(len, bench.frames)))
        begin = bench.clock.now
        while bench.status.state is not CorrectionsState.WAITING:
            received = bench.status.received
            bench.until(lambda received=received: bench.status.received > received)
            bench.clock.now += 1.0
            bench.advance()
    assert "sends bytes, but no intact frame of RTCM 3; check devices.corrections.mount" in bench.status.message
    assert bench.clock.now - begin == 10.0
    assert bool(bench.stream) == bool(after), "nothing is forwarded before an intact frame"


def test_silent_answer_is_given_up(connect: Callable[..., Bench]) -> None:
    server = socket.create_server(("127.0.0.1", 0))
    bench = connect(server.getsockname()[1])
    bench.until_state(CorrectionsState.ASKING)
    bench.clock.now += 9.99
    bench.advance()
    assert bench.status.state is CorrectionsState.ASKING
    bench.clock.now += 0.02
    bench.advance()
    assert "no answer within 10 s" in bench.status.message
    server.close()
    bench.clock.now += 1.2
    bench.until_state(CorrectionsState.WAITING)
    assert "Connection refused" in bench.status.message
    assert bench.status.next_attempt >= 9.9
