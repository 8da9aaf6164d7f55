"""Help and version: quick, because nothing heavy is imported for them."""

import os
import subprocess
import sys
from typing import Any

import pytest
from typer.main import get_command

from drawbar.cli.main import app
from drawbar.configurations import shipped_names

HEAVY = "casadi scipy numpy plotly matplotlib dask distributed optuna"
COMMANDS = ("run", "report", "replay", "config", "events", "path", "tube", "export", "bench", "experiment", "tune")


def loaded_by(statement: str) -> set[str]:
    """Return which of HEAVY a fresh interpreter holds after a statement."""
    program = f"import sys\ntry:\n    {statement}\nexcept SystemExit as end:\n    assert not end.code\n"
    program += f"print('loaded:', *(name for name in {HEAVY.split()} if name in sys.modules))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return set(done.stdout.splitlines()[-1].removeprefix("loaded:").split())


def program(*arguments: str) -> str:
    return f"sys.argv = ['drawbar', *{arguments}]; from drawbar.cli.main import main; main()"


def said(*arguments: str, columns: int = 80) -> tuple[int, str]:
    command = [sys.executable, "-m", "drawbar", *arguments]
    environment = {**os.environ, "COLUMNS": str(columns)}
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=False, env=environment)
    return done.returncode, done.stdout + done.stderr


def test_import_loads_nothing_heavy() -> None:
    assert loaded_by("import drawbar") == set()


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_help_loads_nothing_heavy(command: str) -> None:
    assert loaded_by(program(*command.split(), "--help")) == set()


def test_what_is_loaded_is_seen() -> None:
    assert {"numpy", "casadi"} <= loaded_by("import drawbar.step.build")


def test_help_names_every_command() -> None:
    code, text = said("--help")
    assert code == 0
    assert all(name in text for name in COMMANDS)


@pytest.mark.parametrize("command", ["run", "tube", "export", "tune"])
def test_help_names_the_shipped_configurations(command: str) -> None:
    code, text = said(command, "--help")
    assert code == 0
    assert all(name in text for name in shipped_names())


@pytest.mark.parametrize("command", ["", "drive", "check", "calibrate", "stand-in", "identify", *COMMANDS])
def test_help_is_whole_in_a_narrow_window(command: str) -> None:
    code, text = said(*command.split(), "--help", columns=60)
    assert code == 0
    assert max(map(len, text.splitlines())) == 60
    assert "…" not in text


def helps_of(command: Any) -> list[str]:
    """Return the texts that the help of a command and of those below it is made of."""
    below = getattr(command, "commands", {}).values()
    own = [command.help or "", *(getattr(each, "help", None) or "" for each in command.params)]
    return [*own, *(text for each in below for text in helps_of(each))]


def test_no_help_has_brackets_which_would_be_taken_for_styles() -> None:
    helps = helps_of(get_command(app))
    assert any("AgOpenGPS boards" in text for text in helps)
    assert not [text for text in helps if "[" in text]


def test_help_breaks_no_line_where_the_source_does() -> None:
    helps = helps_of(get_command(app))
    assert any("\n\n" in text for text in helps)
    assert not [text for text in helps if "\n" in text.replace("\n\n", "")]


@pytest.mark.parametrize(("command", "usage"), [("config", "[CONFIG]"), ("tune", "[RANGES]")])
def test_help_has_one_pair_of_brackets_around_what_may_be_left_out(command: str, usage: str) -> None:
    _, text = said(command, "--help")
    assert usage in text
    assert "[[" not in text
