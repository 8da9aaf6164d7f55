"""`drawbar console` and the ports of `drawbar drive`: what is told before anything is started."""

import socket
import subprocess
import sys
import tempfile
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

from drawbar.cli.main import app
from drawbar.driving.messaging.process_options import OPTIONS_NAME, ProcessOptions
from drawbar.errors import HardwareError

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")


@pytest.fixture
def stale(tmp_path, monkeypatch):
    """Return the folder that a drive has left that was killed, the only one on this computer."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    folder = tmp_path / "drawbar-killed"
    folder.mkdir()
    options = ProcessOptions(folder=str(folder), run="runs/a", configuration="config.toml")
    (folder / OPTIONS_NAME).write_text(options.model_dump_json(), "utf-8")
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as gate:
        gate.bind(str(folder / "gate"))
    return folder


@pytest.fixture
def taken():
    """Return a port of this computer that another program listens at."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server.getsockname()[1]


def refusal(*arguments):
    error = CliRunner().invoke(app, [str(each) for each in arguments]).exception
    assert isinstance(error, HardwareError), repr(error)
    return str(error)


def test_a_console_joins_no_drive_that_was_killed(stale):
    assert refusal("console") == "no drive is on; start one with drawbar drive --console"
    assert refusal("console", "--drive", stale) == (
        f"{stale} is not the folder of a drive that is on; start one with drawbar drive"
    )
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as gate:
        (stale / "gate").unlink()
        gate.bind(str(stale / "gate"))
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as other:
            other.bind(str(stale / "console"))
            assert refusal("console") == f"the drive in {stale} has a console already; open that one, or end it"


def test_a_console_takes_the_place_of_one_that_was_killed(stale, monkeypatch):
    begun = []

    def run(*_, **__):
        begun.append((stale / "console").exists())
        return SimpleNamespace(returncode=0)

    monkeypatch.setattr(subprocess, "run", run)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as gate:
        (stale / "gate").unlink()
        gate.bind(str(stale / "gate"))
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as killed:
            killed.bind(str(stale / "console"))
        result = CliRunner().invoke(app, ["console", "--port", "0"])
    assert result.exit_code == 0
    assert begun == [False]


@pytest.mark.parametrize(
    ("option", "who"), [(["--console", "--port"], "the console"), (["--live", "--live-port"], "the live log")]
)
def test_a_port_that_is_taken_is_reported_before_anything_starts(taken, tmp_path, option, who):
    if "--console" in option:
        pytest.importorskip("nicegui", reason="the extra `console` is not installed")
    said = refusal("drive", "--out", tmp_path / "run", *option, taken)
    assert f"{who} cannot listen at 127.0.0.1:{taken}" in said
    assert not (tmp_path / "run").exists()


def test_options_of_the_pages_are_refused_where_none_are_served(tmp_path):
    given = ["--port", "0", "--name", "tractor.lan", "--key", "key.pem"]
    result = CliRunner().invoke(app, ["drive", "--out", str(tmp_path / "run"), "--shadow", *given, "--seconds", "0.1"])
    assert "no pages are served; add it, or leave out --port, --name, --key" in str(result.exception)
    assert not (tmp_path / "run").exists()


def test_a_port_of_the_live_log_is_refused_where_none_is_served(tmp_path):
    result = CliRunner().invoke(app, ["drive", "--out", str(tmp_path / "run"), "--live-port", "0", "--seconds", "0.1"])
    assert "without --live no live log is served; add it, or leave out --live-port" in str(result.exception)
    assert not (tmp_path / "run").exists()


def test_a_user_that_cannot_be_is_refused_before_a_password_is_asked_for(tmp_path):
    result = CliRunner().invoke(app, ["console-user", str(tmp_path / "users"), "a b"], input="0123456789\n0123456789\n")
    assert "user name 'a b'" in str(result.exception)
    assert "password" not in result.output
