"""TLS to a caster, and that the password goes nowhere else."""

import logging
from collections.abc import Callable
from pathlib import Path

import pytest
from caster_bench import FAST, GGA, LOGIN, Bench
from certificates import certificate
from waiting import until

from drawbar.errors import ConfigurationError
from drawbar.machine.hardware.corrections.status import CorrectionsState
from drawbar.machine.stand_in.caster import Caster, CasterFault, CasterSettings, empty_corrections


@pytest.mark.parametrize("fault", [CasterFault.NONE, CasterFault.CLOSE, CasterFault.RESET])
def test_tls_carries_corrections_and_positions(
    connect: Callable[..., Bench], tmp_path: Path, fault: CasterFault
) -> None:
    context, file = certificate(tmp_path)
    with Caster(
        CasterSettings(login=LOGIN, interval=FAST, needs_position=True, fault=fault, after=12), tls=context
    ) as caster:
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
    with Caster(CasterSettings(login=LOGIN, interval=FAST), tls=context) as caster:
        bench = connect(caster.port, tls=True)
        bench.until_state(CorrectionsState.WAITING)
        assert "TLS: self-signed certificate" in bench.status.message
        assert not caster.requests


def test_caster_without_tls_is_reported(connect: Callable[..., Bench]) -> None:
    with Caster(CasterSettings(login=LOGIN, interval=FAST)) as caster:
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
    with pytest.raises(ConfigurationError, match=r"devices.corrections.certificate: .*give a PEM file"):
        connect(1, tls=True, certificate=str(file))


@pytest.mark.parametrize("fault", CasterFault)
def test_password_shows_nowhere(
    connect: Callable[..., Bench], fault: CasterFault, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    told = []
    with Caster(
        CasterSettings(login=LOGIN if fault is CasterFault.NONE else "other:login", interval=FAST, fault=fault)
    ) as caster:
        bench = connect(caster.port)
        for _ in range(30):
            bench.advance()
            told.append(f"{bench.status} {bench.client!r} {bench.client.__dict__}")
    everything = " ".join(told) + caplog.text
    assert "s3cret" not in everything
    assert "ZmFybWVyOnMzY3JldA" not in everything
