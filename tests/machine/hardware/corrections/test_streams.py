"""Streams of casters in every dialect: what of them reaches the receivers, and what they say of themselves."""

import socket
from collections.abc import Callable
from dataclasses import replace

import pytest
from caster_bench import FAST, LOGIN, Bench

from drawbar.machine.hardware.corrections.session import AT_ONCE
from drawbar.machine.hardware.corrections.status import CorrectionsNews, CorrectionsState
from drawbar.machine.stand_in.caster import Caster, CasterSettings, Dialect, empty_corrections


@pytest.mark.parametrize("dialect", Dialect)
@pytest.mark.parametrize("version", [1, 2])
def test_corrections_come_out_unchanged(connect: Callable[..., Bench], dialect: Dialect, version: int) -> None:
    with Caster(CasterSettings(dialect=dialect, login=LOGIN, interval=FAST)) as caster:
        bench = connect(caster.port, version=version)
        bench.until(lambda: len(bench.frames) >= 15)
    assert bytes(bench.stream[:200]) == b"".join(map(empty_corrections, range(20)))[:200]
    status = bench.status
    assert (status.station, status.attempts, status.message) == (123, 1, "")
    assert status.types[1077] >= 12
    assert status.types[1005] >= 2
    assert status.observation_age == 0.0
    assert not any(status.dropped.values())


_COMMANDS = (
    b"Welcome to this caster!\r\n",
    b"$PUBX,40,GGA,0,0,0,0*5A\r\n",
    bytes.fromhex("B562 0600 0000 0618"),
    b"\xd3\x00",
)


@pytest.mark.parametrize("command", _COMMANDS, ids=("text", "NMEA command", "UBX command", "cut frame"))
def test_nothing_but_intact_frames_reaches_a_receiver(connect: Callable[..., Bench], command: bytes) -> None:
    def corrections(epoch: int) -> bytes:
        return command + empty_corrections(epoch) + command

    with Caster(CasterSettings(login=LOGIN, interval=FAST, corrections=corrections)) as caster:
        bench = connect(caster.port)
        bench.until(lambda: len(bench.frames) >= 15)
    frames = b"".join(map(empty_corrections, range(40)))
    assert frames.startswith(bytes(bench.stream))
    assert bench.status.dropped["bytes"] >= 14 * len(command)


def test_all_of_a_burst_that_begins_the_stream_reaches_the_receivers(connect: Callable[..., Bench]) -> None:
    burst = b"".join(map(empty_corrections, range(400)))
    assert len(burst) > 2 * AT_ONCE
    with Caster(
        CasterSettings(login=LOGIN, interval=FAST, corrections=lambda epoch: b"" if epoch else burst)
    ) as caster:
        bench = connect(caster.port)
        bench.until(lambda: len(bench.frames) >= 1)
        bench.until(lambda: bench.status.received >= len(burst))
    assert bench.stream == burst


def test_end_of_the_chunks_is_the_end_of_the_stream(connect: Callable[..., Bench]) -> None:
    frame = empty_corrections(1)
    with socket.create_server(("127.0.0.1", 0)) as server:
        bench = connect(server.getsockname()[1])
        bench.until_state(CorrectionsState.ASKING)
        other, _ = server.accept()
        with other:
            head = b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n"
            other.sendall(head + b"%x\r\n%b\r\n0\r\n\r\n" % (len(frame), frame))
            bench.until_state(CorrectionsState.WAITING)
    assert "has ended the stream" in bench.status.message
    assert bytes(bench.stream) == frame


def test_switched_base_is_noticed(connect: Callable[..., Bench]) -> None:
    def corrections(epoch: int) -> bytes:
        return empty_corrections(epoch, station=123 if epoch < 5 else 124)

    news = CorrectionsNews()
    with Caster(CasterSettings(login=LOGIN, interval=FAST, corrections=corrections)) as caster:
        bench = connect(caster.port)
        bench.until(lambda: bench.status.station == 123)
        assert news.update(bench.status) == []
        bench.until(lambda: bench.status.station == 124)
        assert news.update(bench.status) == ["corrections come from another base, station 124: positions may jump"]
    assert news.update(bench.status) == []
    assert news.update(replace(bench.status, station=123)) == [], "stations in turns are told once"
