"""Casters that refuse: it is told, and not tried again within a minute."""

import socket
from collections.abc import Callable
from dataclasses import replace

import pytest
from caster_bench import FAST, LOGIN, Bench

from drawbar.machine.hardware.corrections.status import CorrectionsState
from drawbar.machine.stand_in.caster import Caster, CasterFault, CasterSettings, Dialect


def refusals() -> list[tuple[str, dict[str, object], dict[str, object], str]]:
    return [
        ("401", {"fault": CasterFault.UNAUTHORIZED}, {}, "refuses the user name or the password (401); check what"),
        ("404", {"fault": CasterFault.NOT_FOUND}, {}, "has no such mount point (404); check devices.corrections.mount"),
        ("wrong login", {"login": "x:y"}, {}, "refuses the user name or the password (401)"),
        ("wrong mount, v1", {"dialect": Dialect.V1}, {"mount": "MP2"}, "sends its table of mount points instead"),
        ("wrong mount, v2", {"dialect": Dialect.V2_PLAIN}, {"mount": "MP2"}, "sends its table of mount points instead"),
    ]


@pytest.mark.parametrize(
    ("caster", "client", "told"), [case[1:] for case in refusals()], ids=[c[0] for c in refusals()]
)
def test_refusal_is_reported_and_not_tried_again_within_a_minute(
    connect: Callable[..., Bench], caster: dict[str, object], client: dict[str, object], told: str
) -> None:
    with Caster(CasterSettings(**({"login": LOGIN, "interval": FAST} | caster))) as there:  # type: ignore[arg-type]
        bench = connect(there.port, **client)
        bench.until_state(CorrectionsState.WAITING)
        assert told in bench.status.message
        assert bench.status.message.endswith(f"next attempt in {bench.status.next_attempt:.0f} s")
        bench.clock.now += 59.9
        for _ in range(20):
            bench.advance()
        assert len(there.requests) == 1
        bench.clock.now += 12.2
        bench.until(lambda: len(there.requests) == 2)
    assert bench.stream == b""


def test_refusal_of_a_mount_point_that_has_worked_is_tried_again_soon(connect: Callable[..., Bench]) -> None:
    settings = CasterSettings(login=LOGIN, interval=FAST, fault=CasterFault.CLOSE)
    with Caster(settings) as there:
        bench = connect(there.port)
        bench.until(lambda: bench.stream)
        bench.until_state(CorrectionsState.WAITING)
    with Caster(replace(settings, fault=CasterFault.NOT_FOUND), address=("127.0.0.1", there.port)) as restarted:
        bench.clock.now += 1.3
        bench.until(lambda: "no such mount point" in bench.status.message)
        assert 10.0 <= bench.status.next_attempt <= 12.0
        bench.clock.now += 12.1
        bench.until(lambda: len(restarted.requests) == 2)


def test_a_page_is_known_at_once_and_tried_again_soon(connect: Callable[..., Bench]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        bench = connect(server.getsockname()[1])
        bench.until_state(CorrectionsState.ASKING)
        other, _ = server.accept()
        with other:
            other.sendall(b"HTTP/1.1 200 OK\r\nContent-Type: text/html; charset=utf-8\r\n\r\n<html>")
            bench.until_state(CorrectionsState.WAITING)
    assert "answers something that is not NTRIP (200); check devices.corrections.host" in bench.status.message
    assert 0.8 <= bench.status.next_attempt <= 1.2


@pytest.mark.parametrize(
    ("code", "shortest", "longest"),
    [(400, 60.0, 72.0), (409, 60.0, 72.0), (499, 60.0, 72.0), (500, 0.8, 1.2), (503, 0.8, 1.2)],
)
def test_caster_in_trouble_is_tried_again_soon(
    connect: Callable[..., Bench], code: int, shortest: float, longest: float
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        bench = connect(server.getsockname()[1])
        bench.until_state(CorrectionsState.ASKING)
        other, _ = server.accept()
        with other:
            other.sendall(b"HTTP/1.1 %d No\r\n\r\n" % code)
            bench.until_state(CorrectionsState.WAITING)
    assert f"refuses the request ({code})" in bench.status.message
    assert shortest <= bench.status.next_attempt <= longest


def test_redirect_is_of_a_modem_or_its_network(connect: Callable[..., Bench]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        bench = connect(server.getsockname()[1])
        bench.until_state(CorrectionsState.ASKING)
        other, _ = server.accept()
        with other:
            other.sendall(b"HTTP/1.1 302 Found\r\nLocation: http://192.168.8.1/login\r\n\r\n")
            bench.until_state(CorrectionsState.WAITING)
    assert "leads to another page (302); see whether the modem or its network asks for a login" in bench.status.message
    assert 0.8 <= bench.status.next_attempt <= 1.2
