"""The progress of many runs, in a terminal and in a file."""

import io

import pytest
from rich.console import Console

from drawbar.experiment.progress import RunsProgress, progress_line
from drawbar.report import live


def test_a_line_says_how_far_how_fast_and_how_long() -> None:
    line = progress_line("robustness, runs", done=100, total=400, rate=2.5, failed=3).plain
    assert line.endswith(" 100/400  2.5/s  120 s left  3 failed")
    assert len(line) <= 100
    assert "left" in progress_line("x", done=0, total=0, rate=0.0, failed=0).plain


@pytest.mark.parametrize("terminal", [True, False])
def test_failures_and_the_end_are_always_shown(terminal: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "_PLAIN_REFRESH", 1e9)
    stream = io.StringIO()
    console = Console(file=stream, force_terminal=terminal, width=120)
    with RunsProgress(console, "tube") as shown:
        shown.begin("runs", 4, done=1)
        shown.advance("no such column")
        shown.advance("no such column")
        assert "failed: no such column" in stream.getvalue()
        assert "4/4" not in stream.getvalue()
        shown.advance()
    assert "tube, runs" in stream.getvalue()
    assert "4/4" in stream.getvalue()
    assert "2 failed" in stream.getvalue()
    assert stream.getvalue().count("no such column") == 1
