"""`drawbar --version`, as somebody reports it with a fault."""

import platform
import sys
from pathlib import Path

import pytest

from drawbar import __version__
from drawbar.cli import main as cli
from drawbar.codegen.compiler import find_compiler


def said(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    monkeypatch.setattr(sys, "argv", ["drawbar", *arguments])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    captured = capsys.readouterr()
    return int(ended.value.code or 0), captured.out + captured.err


def test_version_is_one_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert said(monkeypatch, capsys, "--version") == (0, f"drawbar {__version__}\n")


def test_verbose_tells_the_surroundings(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setenv("DRAWBAR_CACHE", str(tmp_path))
    code, text = said(monkeypatch, capsys, "--version", "--verbose")
    assert code == 0
    for expected in (platform.python_version(), platform.platform(), " ".join(find_compiler()), str(tmp_path)):
        assert expected in text


def test_a_missing_compiler_does_not_hide_the_rest(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CC", "/nonexistent/cc")
    find_compiler.cache_clear()
    try:
        code, text = said(monkeypatch, capsys, "--verbose", "--version")
    finally:
        find_compiler.cache_clear()
    assert code == 0
    assert "CC='/nonexistent/cc' names no program" in text
    assert "cache" in text


def test_verbose_alone_is_refused(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    code, text = said(monkeypatch, capsys, "--verbose")
    assert code == 2
    assert "--version" in text
