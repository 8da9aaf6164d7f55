"""Output: one message where it cannot be written; what is said without a terminal."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from drawbar.cli import options
from drawbar.cli.main import app
from drawbar.codegen import build

FULL = Path("/dev/full")


@pytest.mark.skipif(not FULL.exists(), reason="this system has no /dev/full")
@pytest.mark.parametrize("arguments", [("config", "articulated"), ("--version",)], ids=["long", "short"])
def test_a_full_disk_behind_standard_output_is_one_message(arguments):
    with FULL.open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "drawbar", *arguments], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert (done.returncode, done.stderr) == (2, "error: output cannot be written: No space left on device\n")


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "--out", ""),
        ("drive", "--out", ""),
        ("export", "articulated", "--out", ""),
        ("path", "articulated", "--out", ""),
        ("report", "run", "--out", ""),
        ("tube", "articulated", "--out", ""),
        ("tune", "paper", "--parameters", "speed=0.5..1.5", "--out", ""),
        ("bench", "--json", ""),
        ("log", "export", "run", "--csv", ""),
        ("log", "export", "run", "--ros2", ""),
        ("log", "export", "run", "--geojson", ""),
    ],
    ids=" ".join,
)
def test_an_empty_name_of_what_is_to_be_written_is_refused(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 2
    assert f"Invalid value for '{arguments[-2]}': is empty; name a file or folder" in done.output
    assert not list(tmp_path.iterdir())


def test_a_dash_makes_no_file_of_that_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ("log", "export", "run", "--csv", "-"))
    assert done.exit_code == 2
    assert "/dev/stdout for standard output" in " ".join(done.output.replace("│", " ").split())
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(os.name != "posix", reason="closes standard output as a shell does by >&-")
@pytest.mark.parametrize("closed", [">&-", ">&- <&-", ">&- 2>&-"])
def test_closed_standard_files_are_as_the_null_device(closed, tmp_path):
    out = tmp_path / "path.csv"
    command = f"exec '{sys.executable}' -m drawbar path articulated --out '{out}' {closed}"
    done = subprocess.run(["sh", "-c", command], stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert out.read_text("utf-8").startswith("arc_length,")


@pytest.mark.parametrize(
    "arguments",
    [("config", "articulated", "--toml"), ("config",), ("events",), ("--version",), ("--help",), ("run", "--help")],
    ids=" ".join,
)
def test_a_reader_that_goes_away_is_no_error(arguments):
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        [sys.executable, "-m", "drawbar", *arguments], stdout=write, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(write)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_reader_that_goes_away_ends_nothing():
    program = (
        "import sys; from drawbar.cli.options import console; sys.stdin.readline();"
        "console.print('x'); console.print('y'); print('done', file=sys.stderr)"
    )
    pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    with subprocess.Popen([sys.executable, "-c", program], **pipes) as process:
        process.stdout.close()
        _, error = process.communicate(b"\n")
    assert (process.returncode, error.decode()) == (0, "done\n")


@pytest.mark.parametrize("named", ["compiled", "kept"])
def test_without_a_terminal_one_line_says_that_something_is_compiled(named, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DRAWBAR_CACHE", str(tmp_path))
    units = {f"unit{number}.c": f"int answer{number}(void) {{ return {number}; }}\n" for number in range(2)}
    if named == "kept":
        build("two", units)
    with options.compiling():
        build("two", units)
    assert capsys.readouterr().out == ("compiling the control step, once …\n" if named == "compiled" else "")
