"""`drawbar --version`, as somebody reports it with a fault."""

import platform
from pathlib import Path

import pytest
from short_run import Drawbar

from drawbar import __version__
from drawbar.codegen.compiler import find_compiler


def test_version_is_one_line(drawbar: Drawbar) -> None:
    assert drawbar("--version") == (0, f"drawbar {__version__}\n")


def test_verbose_tells_the_surroundings(drawbar: Drawbar, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("DRAWBAR_CACHE", str(tmp_path))
    code, text = drawbar("--version", "--verbose")
    assert code == 0
    for expected in (platform.python_version(), platform.platform(), " ".join(find_compiler()), str(tmp_path)):
        assert expected in text


def test_a_missing_compiler_does_not_hide_the_rest(drawbar: Drawbar, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "/nonexistent/cc")
    find_compiler.cache_clear()
    try:
        code, text = drawbar("--verbose", "--version")
    finally:
        find_compiler.cache_clear()
    assert code == 0
    assert "CC='/nonexistent/cc' names no program" in text
    assert "cache" in text


def test_verbose_alone_is_refused(drawbar: Drawbar) -> None:
    code, text = drawbar("--verbose")
    assert code == 2
    assert "--version" in text
