"""The command line as a function."""

import sys
from pathlib import Path

import pytest
from short_run import Drawbar

from drawbar.cli import main as cli


@pytest.fixture
def drawbar(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Drawbar:
    """Return a function that runs the command line inside tmp_path: exit code, and what it said."""

    def drawbar(*arguments: str) -> tuple[int, str]:
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["drawbar", *arguments])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        captured = capsys.readouterr()
        return int(ended.value.code or 0), captured.out + captured.err

    return drawbar
