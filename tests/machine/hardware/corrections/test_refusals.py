"""Casters that refuse: it is told, and not tried again within a minute."""

import socket
from collections.abc import Callable

import pytest
from caster_bench import FAST, LOGIN, Bench

from drawbar.machine.hardware.corrections.status import CorrectionsState
from drawbar.machine.stand_in.caster import Caster, CasterFault, CasterSettings, Dialect


def refusals() -> list[tuple[str, dict[str, object], dict[str, object], str]]:
    return [
        ("401", {"fault": CasterFault.UNAUTHORIZED}, {}, "refuses the user name or the password (401); check what"),
        ("404", {"fault": CasterFault.NOT_FOUND}, {}, "has no such mount point (404); check corrections.mount"),
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


@pytest.mark.parametrize(("code", "shortest", "longest"), [(499, 60.0, 72.0), (500, 0.8, 1.2), (503, 0.8, 1.2)])
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
