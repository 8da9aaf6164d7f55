"""`drawbar config`, `events` and shell completion as their user sees them."""

import os
import subprocess
import sys
import tomllib

import pytest
from rich.cells import cell_len


def said(*arguments: str, **environment: str) -> tuple[int, str]:
    done = subprocess.run(
        [sys.executable, "-m", "drawbar", *arguments],
        env={**os.environ, "PYTHONIOENCODING": "utf-8", **environment},
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )
    return done.returncode, done.stdout + done.stderr


def test_config_shows_keys_with_units_and_fits_a_narrow_terminal() -> None:
    code, text = said("config", "paper", "--set", "vehicle.wheelbase=1.75", COLUMNS="60")
    assert code == 0
    assert "wheelbase = 1.75 m" in text
    assert "front to rear axle of the tractor" in text
    assert max(map(cell_len, text.splitlines())) <= 60


def test_config_as_toml_is_the_whole_configuration() -> None:
    code, text = said("config", "articulated", "--toml")
    assert code == 0
    assert tomllib.loads(text)["vehicle"]["wheelbase"] == 1.4


@pytest.mark.parametrize("arguments", [("--toml",), ("nowhere",)])
def test_config_refuses_what_it_cannot_show(arguments: tuple[str, ...]) -> None:
    assert said("config", *arguments)[0] == 2


def test_events_are_shown_with_a_command_that_uses_them() -> None:
    code, text = said("events")
    assert code == 0
    assert 'kind = "gps_loss"' in text
    assert "--set 'machine.events=[{kind=" in text


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_script_for_every_shell(shell: str) -> None:
    code, text = said(_DRAWBAR_COMPLETE=f"source_{shell}")
    assert code == 0
    assert "_DRAWBAR_COMPLETE=" in text


def test_completion_offers_commands() -> None:
    code, text = said(_DRAWBAR_COMPLETE="complete_bash", COMP_WORDS="drawbar re", COMP_CWORD="1")
    assert {"report", "replay"} <= set(text.split()), (code, text)
