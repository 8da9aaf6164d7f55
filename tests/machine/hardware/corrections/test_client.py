"""The NTRIP client against a caster in every dialect and with every fault, over real sockets, on the test's clock."""

import logging
import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random

import pytest
from certificates import certificate
from waiting import FakeClock, until

from drawbar.errors import ConfigurationError
from drawbar.machine.hardware.corrections.client import CorrectionsClient
from drawbar.machine.hardware.corrections.corrections import open_corrections
from drawbar.machine.hardware.corrections.credentials import Login
from drawbar.machine.hardware.corrections.session import HELD
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.hardware.corrections.status import CorrectionsState, CorrectionsStatus
from drawbar.machine.stand_in.caster import Caster, CasterFault, Dialect, empty_corrections
from drawbar.protocols.ntrip import gga_sentence
from drawbar.protocols.rtcm import RtcmFramer
from drawbar.transports.address import UdpAddress
from drawbar.transports.udp import UdpTransport

LOGIN = "farmer:s3cret"
GGA = gga_sentence(
    time_of_day=43200.0,
    latitude=0.888,
    longitude=0.082,
    quality=4,
    satellites=20,
    dilution=0.7,
    height=50.0,
    separation=45.0,
)
FAST = 0.005
"""between the epochs of casters here, s"""


class Bench:
    """A client with a clock that only the test moves, and all bytes that came out of it."""

    def __init__(self, port: int, *, login: str = LOGIN, **settings: object) -> None:
        given = {"host": "127.0.0.1", "port": port, "mount": "MP1"} | settings
        self.clock = FakeClock()
        self.client = CorrectionsClient(CorrectionsSettings.model_validate(given), Login(login), Random(0))
        self.stream = bytearray()

    def advance(self) -> None:
        self.stream += self.client.advance(self.clock.now)

    def until(self, seen: Callable[[], object], within: float = 10.0) -> None:
        def look() -> object:
            self.advance()
            return seen()

        until(look, within)

    def until_state(self, state: CorrectionsState) -> None:
        self.until(lambda: self.status.state is state)

    @property
    def status(self) -> CorrectionsStatus:
        return self.client.status(self.clock.now)

    @property
    def frames(self) -> list[bytes]:
        return RtcmFramer().feed(bytes(self.stream))


@pytest.fixture
def connect() -> Iterator[Callable[..., Bench]]:
    """Return a function that makes a bench; its client is closed in the end."""
    benches: list[Bench] = []

    def connect(port: int, **settings: object) -> Bench:
        benches.append(Bench(port, **settings))
        return benches[-1]

    yield connect
    for bench in benches:
        bench.client.close()


@pytest.mark.parametrize("dialect", Dialect)
@pytest.mark.parametrize("version", [1, 2])
def test_corrections_come_out_unchanged(connect: Callable[..., Bench], dialect: Dialect, version: int) -> None:
    with Caster(dialect=dialect, login=LOGIN, interval=FAST) as caster:
        bench = connect(caster.port, version=version)
        bench.until(lambda: len(bench.frames) >= 15)
    assert bytes(bench.stream[:200]) == b"".join(map(empty_corrections, range(20)))[:200]
    status = bench.status
    assert (status.station, status.attempts, status.message) == (123, 1, "")
    assert status.types[1077] >= 12
    assert status.types[1005] >= 2
    assert status.observation_age == 0.0
    assert not any(status.dropped.values())


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
def test_refusal_is_told_and_not_tried_again_within_a_minute(
    connect: Callable[..., Bench], caster: dict[str, object], client: dict[str, object], told: str
) -> None:
    with Caster(**({"login": LOGIN, "interval": FAST} | caster)) as there:  # type: ignore[arg-type]
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


BROKEN = {
    CasterFault.CLOSE: "the other end has closed the connection",
    CasterFault.RESET: "Connection reset by peer",
}


@pytest.mark.parametrize("fault", BROKEN)
@pytest.mark.parametrize("dialect", [Dialect.V1, Dialect.V2_CHUNKED])
def test_lost_connection_is_told_and_opened_again(
    connect: Callable[..., Bench], fault: CasterFault, dialect: Dialect
) -> None:
    with Caster(dialect=dialect, login=LOGIN, interval=FAST, fault=fault) as caster:
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


def test_pause_is_short_again_after_a_stream_that_lasted(connect: Callable[..., Bench]) -> None:
    with Caster(login=LOGIN, interval=FAST, fault=CasterFault.CLOSE, after=20) as caster:
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
    with Caster(login=LOGIN, interval=FAST, fault=CasterFault.STALL) as caster:
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
    with Caster(dialect=Dialect.V2_PLAIN, login=LOGIN, interval=interval, fault=fault, after=after) as caster:
        bench = connect(caster.port)
        bench.until(lambda: len(bench.frames) >= after and bench.status.received > sum(map(len, bench.frames)))
        begin = bench.clock.now
        while bench.status.state is not CorrectionsState.WAITING:
            received = bench.status.received
            bench.until(lambda received=received: bench.status.received > received)
            bench.clock.now += 1.0
            bench.advance()
    assert "sends bytes, but no intact frame of RTCM 3; check corrections.mount" in bench.status.message
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


@pytest.mark.parametrize(("dialect", "version"), [(Dialect.V1, 1), (Dialect.V2_CHUNKED, 2)])
def test_position_is_sent_at_once_and_every_ten_seconds(
    connect: Callable[..., Bench], dialect: Dialect, version: int
) -> None:
    with Caster(dialect=dialect, login=LOGIN, interval=FAST, needs_position=True) as caster:
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
    with Caster(login=LOGIN, interval=FAST, needs_position=True) as caster:
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
        assert set(caster.positions) == {GGA.strip()}, "the last one with a fix goes on"


def test_stream_that_waits_for_a_position_in_vain_is_given_up_in_the_end(connect: Callable[..., Bench]) -> None:
    with Caster(login=LOGIN, interval=FAST, needs_position=True) as caster:
        bench = connect(caster.port)
        bench.until_state(CorrectionsState.LISTENING)
        bench.clock.now += 60.0
        bench.advance()
        assert "waiting for a position, and the receiver has no fix" in bench.status.message


def test_text_before_the_first_frame_reaches_no_receiver(connect: Callable[..., Bench]) -> None:
    def corrections(epoch: int) -> bytes:
        return b"Welcome to this caster!\r\n" * (epoch < 3) + empty_corrections(epoch)[: None if epoch else -1]

    with Caster(login=LOGIN, interval=FAST, corrections=corrections) as caster:
        bench = connect(caster.port)
        bench.until(lambda: len(bench.frames) >= 5)
    assert bench.stream[:1] == b"\xd3"


def test_all_of_a_burst_that_begins_the_stream_reaches_the_receivers(connect: Callable[..., Bench]) -> None:
    burst = b"".join(map(empty_corrections, range(400)))
    assert len(burst) > 2 * HELD
    with Caster(login=LOGIN, interval=FAST, corrections=lambda epoch: b"" if epoch else burst) as caster:
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

    with Caster(login=LOGIN, interval=FAST, corrections=corrections) as caster:
        bench = connect(caster.port)
        bench.until(lambda: bench.status.station == 124)
        assert bench.status.station_changed == 0.0
        bench.clock.now += 4.0
        assert bench.status.station_changed == 4.0


@pytest.mark.parametrize("fault", [CasterFault.NONE, CasterFault.CLOSE, CasterFault.RESET])
def test_tls_carries_corrections_and_positions(
    connect: Callable[..., Bench], tmp_path: Path, fault: CasterFault
) -> None:
    context, file = certificate(tmp_path)
    with Caster(login=LOGIN, interval=FAST, tls=context, needs_position=True, fault=fault, after=12) as caster:
        bench = connect(caster.port, tls=True, certificate=str(file))
        bench.client.position(GGA)
        if fault is CasterFault.NONE:
            bench.until(lambda: len(bench.frames) >= 13)
        else:
            bench.until_state(CorrectionsState.WAITING)
        until(lambda: caster.positions)
    expected = b"".join(map(empty_corrections, range(1000)))
    assert bench.stream
    assert expected.startswith(bytes(bench.stream))


def test_caster_that_cannot_prove_its_name_gets_no_password(connect: Callable[..., Bench], tmp_path: Path) -> None:
    context, _ = certificate(tmp_path)
    with Caster(login=LOGIN, interval=FAST, tls=context) as caster:
        bench = connect(caster.port, tls=True)
        bench.until_state(CorrectionsState.WAITING)
        assert "TLS: self-signed certificate" in bench.status.message
        assert not caster.requests


def test_caster_without_tls_is_told(connect: Callable[..., Bench]) -> None:
    with Caster(login=LOGIN, interval=FAST) as caster:
        bench = connect(caster.port, tls=True)
        bench.until(lambda: bench.client.fileno() != -1)
        bench.advance()
        bench.clock.now += 10.1
        bench.advance()
    assert "no connection within 10 s while agreeing on TLS" in bench.status.message


@pytest.mark.parametrize("text", [None, "no certificate"])
def test_wrong_file_of_certificates_is_refused(connect: Callable[..., Bench], tmp_path: Path, text: str | None) -> None:
    file = tmp_path / "ca.pem"
    if text is not None:
        file.write_text(text)
    with pytest.raises(ConfigurationError, match=r"corrections.certificate: .*give a PEM file"):
        connect(1, tls=True, certificate=str(file))


@pytest.mark.parametrize("fault", CasterFault)
def test_password_shows_nowhere(
    connect: Callable[..., Bench], fault: CasterFault, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    told = []
    with Caster(login=LOGIN if fault is CasterFault.NONE else "other:login", interval=FAST, fault=fault) as caster:
        bench = connect(caster.port)
        for _ in range(30):
            bench.advance()
            told.append(f"{bench.status} {bench.client!r} {bench.client.__dict__}")
    everything = " ".join(told) + caplog.text
    assert "s3cret" not in everything
    assert "ZmFybWVyOnMzY3JldA" not in everything


def test_section_of_a_configuration_feeds_a_board(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CASTER", LOGIN)
    board = UdpTransport(UdpAddress(host="127.0.0.1", port=0))
    with Caster(login=LOGIN, interval=FAST) as caster:
        settings = CorrectionsSettings(
            host="127.0.0.1",
            port=caster.port,
            mount="MP1",
            credentials="environment:CASTER",
            forward=(f"udp://127.0.0.1:0?peer=127.0.0.1:{board.port}",),
        )
        corrections = open_corrections(settings)
        now, returned, received = 0.0, bytearray(), bytearray()

        def fed() -> bool:
            nonlocal now
            now += 0.02
            returned.extend(corrections.advance(now))
            received.extend(b"".join(piece.data for piece in board.read()))
            return len(received) > 300

        until(fed)
        corrections.close()
    assert returned.startswith(received)
    board.close()
