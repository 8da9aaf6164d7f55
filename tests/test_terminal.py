"""Tables for any width, and output for any encoding."""

import io
import os
import select
import subprocess
import sys

import pytest
from rich.console import Console

from drawbar.terminal import FittedTable, Output, forget_typed

COLUMNS = [(f"{body}\n{name}", "") for body in ("tractor", "trailer") for name in ("mean", "rms", "max")]
ROWS = [("straight", list("123456")), ("curve 0.125/m", [f"{value}.25" for value in range(6)])]


def printed(width: int) -> str:
    console = Console(file=io.StringIO(), width=width)
    console.print(FittedTable("error, cm", COLUMNS, ROWS, title_width=19))
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


@pytest.mark.parametrize("width", [24, 30, 40, 59, 60, 79, 80, 120])
def test_no_width_loses_a_figure(width: int) -> None:
    text = printed(width)
    for _, cells in ROWS:
        assert all(cell in text.split() for cell in cells)
    assert max(len(row) for row in text.splitlines()) <= width
    assert "…" not in text
    parts = text.strip().split("\n\n")
    for heading in ("tractor", "trailer"):
        assert text.count(heading) == sum(heading in part for part in parts), "once in each part of the table"
    assert all(part.split()[0] in ("tractor", "trailer") for part in parts)


def test_a_wide_terminal_has_one_table_and_a_narrow_one_a_table_for_each_body() -> None:
    assert printed(80).count("straight") == 1
    assert printed(60).count("straight") == 2
    first, second = printed(60).split("straight")[1:]
    assert "trailer" not in first.splitlines()[0]
    assert second.split()[:3] == ["4", "5", "6"]


def test_five_figures_of_a_body_stay_together_in_a_terminal_of_60_columns() -> None:
    columns = [
        (f"{body}\n{name}", "") for body in ("tractor", "trailer") for name in ("mean", "rms", "sd", "95 %", "max")
    ]
    console = Console(file=io.StringIO(), width=60)
    console.print(FittedTable("error, cm", columns, [("curve 0.125/m", ["41.5"] * 10)], title_width=19))
    assert isinstance(console.file, io.StringIO)
    one, other = console.file.getvalue().split("\n\n")
    assert "trailer" not in one
    assert "tractor" not in other


@pytest.mark.parametrize("columns", ["1", "10", "23"])
def test_hardly_any_columns_lose_no_figure(columns: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    file = io.StringIO()
    Output(file=file).print(FittedTable("error, cm", COLUMNS, ROWS, title_width=19))
    assert file.getvalue() == printed(24)


@pytest.mark.parametrize("columns", ["0", "000"])
def test_a_width_of_none_is_as_if_nothing_were_said(columns: str) -> None:
    program = [sys.executable, "-m", "drawbar", "events"]
    unsaid = {key: value for key, value in os.environ.items() if key != "COLUMNS"}
    texts = [subprocess.check_output(program, env=unsaid | more) for more in ({}, {"COLUMNS": columns})]
    assert texts[0] == texts[1] != b""


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "latin-1", "utf-8"])
def test_output_degrades_to_its_encoding(encoding: str) -> None:
    program = "from drawbar.terminal import degrade_output; degrade_output();"
    program += f"print({'µs × ━ 14.1° ± 2² … ⁺ 漢'!a})"  # a command line may not hold them
    surroundings = {**os.environ, "PYTHONIOENCODING": encoding}
    done = subprocess.run([sys.executable, "-c", program], env=surroundings, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    text = done.stdout.decode(encoding)
    if encoding == "utf-8":
        assert text.strip() == "µs × ━ 14.1° ± 2² … ⁺ 漢"
    if encoding == "ascii":
        assert text.strip() == "us x = 14.1 deg +- 22 ... + ?"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals")
def test_what_was_typed_before_a_question_is_no_answer_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    keyboard, terminal = os.openpty()
    with open(terminal, encoding="utf-8") as typed:
        monkeypatch.setattr("sys.stdin", typed)
        os.write(keyboard, b"y\n")
        assert select.select([typed], [], [], 10.0)[0]  # it has arrived
        forget_typed()
        os.write(keyboard, b"n\n")
        assert typed.readline() == "n\n"
    os.close(keyboard)


def test_a_pipe_keeps_its_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("y\n"))
    forget_typed()
    assert sys.stdin.readline() == "y\n"
