"""Credentials: from a variable or a file that only its owner reads; never in a text that anybody sees."""

import os
from pathlib import Path

import pytest
from pydantic import ValidationError

from drawbar.errors import ConfigurationError
from drawbar.machine.hardware.corrections.credentials import Login, read_login
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings

SECRET = "farmer:s3cret-Wört"


def secret_file(folder: Path, text: str | bytes = SECRET + "\n", mode: int = 0o600) -> Path:
    file = folder / "login"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    file.chmod(mode)
    return file


def test_login_comes_from_a_variable_or_a_file(tmp_path: Path) -> None:
    assert read_login("environment:CASTER", {"CASTER": SECRET}) == Login(SECRET)
    assert read_login(f"file:{secret_file(tmp_path)}") == Login(SECRET)
    assert read_login(f"file:{secret_file(tmp_path, mode=0o400)}") == Login(SECRET)
    assert read_login("") == Login("")


def test_login_shows_nowhere() -> None:
    login = Login(SECRET)
    assert SECRET not in f"{login!r} {login}"


@pytest.mark.parametrize("mode", [0o644, 0o640, 0o604, 0o620, 0o601, 0o660])
def test_file_that_others_may_read_is_refused(tmp_path: Path, mode: int) -> None:
    file = secret_file(tmp_path, mode=mode)
    with pytest.raises(ConfigurationError, match=f"has the mode 0{mode:o}.*chmod 600 {file}") as caught:
        read_login(f"file:{file}")
    assert "s3cret" not in str(caught.value)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a file to somebody else")
def test_file_of_somebody_else_is_refused(tmp_path: Path) -> None:
    file = secret_file(tmp_path)
    os.chown(file, 12345, -1)
    with pytest.raises(ConfigurationError, match="belongs to somebody else"):
        read_login(f"file:{file}")


def test_file_that_is_not_there_is_reported(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"No such file or directory.*write user:password into it"):
        read_login(f"file:{tmp_path / 'none'}")
    with pytest.raises(ConfigurationError, match="is no file"):
        read_login(f"file:{tmp_path}")
    os.mkfifo(tmp_path / "pipe", 0o600)
    with pytest.raises(ConfigurationError, match="is no file"):
        read_login(f"file:{tmp_path / 'pipe'}")


@pytest.mark.parametrize(
    "text", ["", "s3cret", ":s3cret", "a:s3cret\nb:c", "a:s3cret\tx", "a:" + "s3cret" * 500, b"a:s3cret\xff"]
)
def test_text_that_is_no_login_is_refused_without_showing_it(tmp_path: Path, text: str | bytes) -> None:
    with pytest.raises(ConfigurationError, match="must hold one line, user:password") as caught:
        read_login(f"file:{secret_file(tmp_path, text)}")
    assert "s3cret" not in str(caught.value)


def test_variable_that_is_not_set_is_reported() -> None:
    with pytest.raises(ConfigurationError, match="the environment variable CASTER is not set; set it to user:password"):
        read_login("environment:CASTER", {})


WRONG = {
    "credentials": ["farmer:s3cret", "s3cret", "environment:farmer:s3cret", 7355608, "file:"],
    "host": ["farmer:s3cret@caster.example", "ntrip://farmer:s3cret@caster.example:2101/MP1", "caster.example/s3cret"],
}


@pytest.mark.parametrize(("key", "value"), [(key, value) for key, values in WRONG.items() for value in values])
def test_settings_refuse_credentials_without_showing_them(key: str, value: object) -> None:
    with pytest.raises(ValidationError) as caught:
        CorrectionsSettings.model_validate({"host": "caster.example", "mount": "MP1", key: value})
    assert "s3cret" not in str(caught.value)
    assert "7355608" not in str(caught.value)
    (error,) = caught.value.errors()
    assert error["loc"] == (), "a message about the section does not print what a key holds"
    assert "s3cret" not in error["msg"]


def test_unknown_key_for_a_password_is_refused_without_showing_it() -> None:
    with pytest.raises(ValidationError, match="has no key password") as caught:
        CorrectionsSettings.model_validate({"host": "caster.example", "mount": "MP1", "password": "s3cret"})
    assert "s3cret" not in str(caught.value)


@pytest.mark.parametrize(
    ("key", "value"),
    [("mount", "/MP1"), ("mount", "a b"), ("mount", ""), ("port", 0), ("version", 3), ("upload", 5.0), ("upload", 0.2),
     ("silence", 0.5), ("forward", ["udp://0.0.0.0:0"]), ("forward", ["file:/tmp/x"]), ("forward", ["board"])],
)  # fmt: skip
def test_settings_that_no_caster_stands_are_refused(key: str, value: object) -> None:
    with pytest.raises(ValidationError):
        CorrectionsSettings.model_validate({"host": "caster.example", "mount": "MP1", key: value})


def test_settings_of_a_usual_farm_are_taken() -> None:
    settings = CorrectionsSettings(
        host="caster.example",
        mount="VRS_3M",
        credentials="environment:CASTER",
        forward=("udp://0.0.0.0:0?peer=192.168.5.255:2233&broadcast=1", "serial:/dev/ttyUSB1@115200"),
    )
    assert (settings.port, settings.version, settings.tls) == (2101, 2, False)
