"""The build cache: compiled once, never stale, safe for several processes, readable when it fails."""

import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from drawbar.codegen import Workspace, build, cache
from drawbar.codegen.cache import cache_folder
from drawbar.codegen.compiler import FLAGS, find_compiler
from drawbar.errors import CompilerError

SOURCE = """
#include "fields.h"
struct work {{ double x; }};
int64_t drawbar_size = sizeof(struct work);
const struct drawbar_field drawbar_fields[] = {{FIELD(work, x, 0, 1, 0, 0) END_OF_FIELDS}};
int answer(struct work *work) {{ return {answer}; }}
"""


@pytest.fixture
def compilations(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Every compiler call from here on."""
    calls: list[Any] = []
    run = subprocess.run

    def counted(command: list[str], **options: Any) -> Any:
        nonlocal calls
        calls += [command] if "-o" in command else []  # the platform module asks uname
        return run(command, **options)

    monkeypatch.setattr(subprocess, "run", counted)
    return calls


def answer(library: Path) -> int:
    return Workspace(library).function("answer")()


def test_same_content_is_compiled_once(own_cache: Path, compilations: list[Any]) -> None:
    first, second = (build("unit", SOURCE.format(answer=42)) for _ in range(2))
    assert first == second
    assert first.parent == own_cache
    assert len(compilations) == 1
    assert answer(first) == 42


@pytest.mark.parametrize("name", ["my robot", "field/../robot", "Räummaschine\n", "x" * 300])
def test_any_name_makes_a_file_in_the_cache(name: str, own_cache: Path) -> None:
    library = build(name, SOURCE.format(answer=7))
    assert library.parent == own_cache
    assert answer(library) == 7


@pytest.mark.usefixtures("own_cache")
def test_changed_content_is_compiled_again(compilations: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    source = SOURCE.format(answer=1)
    builds = [
        build("unit", source),
        build("unit", SOURCE.format(answer=2)),
        build("unit", source, (*FLAGS, "-g")),
    ]
    sources = cache.runtime_sources()
    monkeypatch.setattr(cache, "runtime_sources", lambda: {**sources, "fields.h": sources["fields.h"] + "\n"})
    builds.append(build("unit", source))
    assert len(set(builds)) == len(compilations) == 4
    assert [answer(library) for library in builds] == [1, 2, 1, 1]


@pytest.mark.usefixtures("own_cache")
def test_progress_of_several_units_is_reported() -> None:
    units = {f"unit{number}.c": f"int answer{number}(void) {{ return {number}; }}\n" for number in range(3)}
    told: list[tuple[int, int]] = []
    with cache.watch_compilation(lambda *of: told.append(of)):
        build("several", units)
        build("several", units)
    assert told == [(0, 3), (1, 3), (2, 3), (3, 3)]


@pytest.mark.usefixtures("own_cache")
def test_source_that_does_not_compile_shows_what_the_compiler_said() -> None:
    with pytest.raises(CompilerError, match=re.escape("could not compile broken-")) as error:
        build("broken", "int answer(void) { return forty_two; }\n")
    assert "forty_two" in str(error.value)
    assert len(str(error.value).splitlines()) <= 13
    left = [file.name for file in cache_folder().iterdir() if file.name != "zig"]  # the wheel's compiler keeps its own
    assert left == [], "a failed build leaves nothing behind"


def test_folder_is_the_users_unless_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DRAWBAR_CACHE", raising=False)
    assert cache_folder().name == "drawbar"
    monkeypatch.setenv("DRAWBAR_CACHE", "elsewhere")
    assert cache_folder() == Path("elsewhere")


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX locks")
def test_two_processes_that_need_the_same_library_build_it_once(
    own_cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    compiler, calls = tmp_path / "compiler", tmp_path / "calls"
    counted = f'case "$*" in *-shared*) echo once >> "{calls}"; sleep 0.5 ;; esac'  # zig also asks $CC for libc's place
    compiler.write_text(f'#!/bin/sh\n{counted}\nexec {shlex.join(find_compiler())} "$@"\n')
    compiler.chmod(0o755)
    monkeypatch.setenv("CC", str(compiler))
    program = (
        "import sys; from drawbar.codegen import Workspace, build; sys.stdin.readline();"
        f"print(Workspace(build('unit', {SOURCE.format(answer=7)!r})).function('answer')())"
    )
    command = [sys.executable, "-c", program]
    both = [subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    for process in both:
        assert process.stdin is not None
        process.stdin.write("go\n")
        process.stdin.flush()
    answers = [process.communicate(timeout=300)[0].strip() for process in both]
    assert answers == ["7", "7"]
    assert len(list(own_cache.glob("unit-*"))) == 2, "the library and its note"
    assert calls.read_text() == "once\n"
