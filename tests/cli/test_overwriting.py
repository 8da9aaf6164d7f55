"""What a command reads is never what it writes, and what it cannot write whole stays as it was."""

import errno
import os
import stat
from pathlib import Path
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

from drawbar.cli import calibrate
from drawbar.cli.main import app
from drawbar.driving.preparation.calibrated_file import calibrated_file
from drawbar.errors import DrawbarError

LINE = "x,y\n" + "".join(f"{5 * i},0\n" for i in range(40))


def refusal(*arguments):
    """Return the refusal of a command line, empty if there is none."""
    result = CliRunner().invoke(app, [str(each) for each in arguments])
    assert result.exception is None or isinstance(result.exception, DrawbarError), result.exception
    return str(result.exception or "")


@pytest.mark.parametrize("option", ["--csv", "--ros2", "--geojson"])
def test_a_log_is_not_replaced_by_its_export(tmp_path, option):
    log, other = tmp_path / "log.mcap", tmp_path / "by_another_name"
    log.write_bytes(b"a log")
    other.symlink_to(log)
    for run, target in ((log, log), (tmp_path, log), (log, other)):
        assert f"{option} {target}: would overwrite" in refusal("log", "export", run, option, target)
        assert log.read_bytes() == b"a log"


def test_two_exports_into_one_file_are_refused(tmp_path):
    log, target = tmp_path / "log.mcap", tmp_path / "one"
    log.write_bytes(b"a log")
    said = refusal("log", "export", log, "--csv", target, "--geojson", target)
    assert said == f"--csv {target} and --geojson {target}: are one file; give each its own."


def test_a_recorded_line_is_not_replaced_by_its_table(tmp_path):
    line = tmp_path / "line.csv"
    line.write_text(LINE, "utf-8")
    assert "choose another file" in refusal("path", "articulated", "--path", line, "--out", line)
    assert "choose another file" in refusal("path", "articulated", "--set", f"path.file={line}", "--out", line)
    assert line.read_text("utf-8") == LINE
    assert refusal("path", "articulated", "--path", line, "--out", tmp_path / "table.csv") == ""
    assert refusal("path", "articulated", "--path", line, "--out", tmp_path / "table.csv") == ""


@pytest.fixture
def export(tmp_path, monkeypatch):
    """Return a function that exports a log as CSV by a writer; its refusal."""
    monkeypatch.setattr("drawbar.recording.log.read_log", lambda file: SimpleNamespace(shortcomings=()))

    def export(writer, target):
        monkeypatch.setattr("drawbar.recording.table.write_csv", writer)
        return refusal("log", "export", tmp_path, "--csv", target)

    return export


@pytest.mark.parametrize("before", [None, "the export of another run"])
def test_an_export_that_a_full_disk_cuts_off_leaves_what_was_there(export, tmp_path, before):
    def fill(log, file):
        file.write_text("half a table", "utf-8")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    target = tmp_path / "table.csv"
    if before is not None:
        target.write_text(before, "utf-8")
    assert "cannot be written (No space left on device)" in export(fill, target)
    assert [each.read_text("utf-8") for each in tmp_path.iterdir()] == ([] if before is None else [before])


@pytest.fixture
def full(monkeypatch):
    """Let every text be cut off by a full disk."""

    def fill(path, text, *given):
        path.write_bytes(text[: len(text) // 2].encode())
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_text", fill)


@pytest.mark.usefixtures("full")
@pytest.mark.parametrize("before", [None, b"the table of another path"])
def test_a_path_that_a_full_disk_cuts_off_leaves_what_was_there(tmp_path, before):
    target = tmp_path / "table.h"
    if before is not None:
        target.write_bytes(before)
    assert "cannot be written (No space left on device)" in refusal("path", "articulated", "--out", target)
    assert [each.read_bytes() for each in tmp_path.iterdir()] == ([] if before is None else [before])


@pytest.mark.usefixtures("full")
def test_a_calibration_that_a_full_disk_cuts_off_leaves_the_one_before(tmp_path):
    configuration, before = tmp_path / "my.toml", b'extends = "my.toml"\n'
    configuration.write_bytes(b'extends = "articulated"\n')
    calibrated_file(configuration).write_bytes(before)
    with pytest.raises(DrawbarError, match="cannot be written"):
        calibrate._write(configuration, [], "log.mcap")
    assert calibrated_file(configuration).read_bytes() == before
    assert len(list(tmp_path.iterdir())) == 2


def test_the_ending_of_a_table_may_be_in_capitals(tmp_path):
    assert refusal("path", "articulated", "--out", tmp_path / "TABLE.CSV") == ""


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes here")
def test_an_export_goes_through_a_pipe_and_a_link_stays_one(export, tmp_path):
    pipe, link, linked = (tmp_path / name for name in ("pipe", "link", "linked"))
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    linked.touch()
    link.symlink_to(linked)
    for target in (pipe, link):
        assert not export(lambda log, file: file.write_text("a table", "utf-8"), target)
    assert os.read(reader, 99) == b"a table" == linked.read_bytes()
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert link.is_symlink()
    again = CliRunner().invoke(app, ["log", "export", str(tmp_path), "--csv", str(pipe)])
    assert again.output == ""  # where the pipe is standard output, its name would be a row of the table
    os.close(reader)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes here")
def test_an_export_whose_reader_goes_away_ends_quietly(export, tmp_path, capfd):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)

    def write(log, file):
        with file.open("w", encoding="utf-8") as stream:
            os.close(reader)
            stream.write("a table")

    assert not export(write, pipe)
    assert capfd.readouterr() == ("", "")
