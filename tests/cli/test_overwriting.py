"""What a command reads is never what it writes."""

import pytest
from typer.testing import CliRunner

from drawbar.cli.main import app
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
