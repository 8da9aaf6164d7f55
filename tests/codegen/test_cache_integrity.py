"""A damaged, planted or unwritable cache: built again, refused, or told; never loaded, never a crash."""

import errno
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from drawbar.codegen import build
from drawbar.codegen.cache_integrity import describe, note_of
from drawbar.errors import CompilerError

posix = pytest.mark.skipif(sys.platform == "win32", reason="POSIX permissions")
SOURCE = """
#include "fields.h"
struct work {{ double x; }};
int64_t drawbar_size = sizeof(struct work);
const struct drawbar_field drawbar_fields[] = {{FIELD(work, x, 0, 1, 0, 0) END_OF_FIELDS}};
int answer(struct work *work) {{ return {answer}; }}
"""


def answer(source: str) -> str:
    """Build and load in a process of its own, which a damaged library would kill."""
    program = "import sys; from drawbar.codegen import Workspace, build;"
    program += f"print(Workspace(build('unit', {source!r})).function('answer')())"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    return done.stdout.strip() or f"{done.returncode}: {done.stderr.strip().splitlines()[-1:]}"


def truncated(size: int) -> Callable[[Path], None]:
    return lambda library: os.truncate(library, size)


def one_bit(library: Path) -> None:
    content = bytearray(library.read_bytes())
    content[len(content) // 2] ^= 1
    library.write_bytes(content)


DAMAGES = {
    "empty": truncated(0),
    "3000 bytes": truncated(3000),
    "half": lambda library: os.truncate(library, library.stat().st_size // 2),
    "one bit": one_bit,
    "no note": lambda library: note_of(library).unlink(),
    "empty note": lambda library: os.truncate(note_of(library), 0),
    "note that is no text": lambda library: note_of(library).write_bytes(bytes(range(256))),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_library_is_built_again(own_cache: Path, damage: str) -> None:
    source = SOURCE.format(answer=42)
    library = build("unit", source)
    DAMAGES[damage](library)
    assert answer(source) == "42"
    assert note_of(library).read_text() == describe(library.read_bytes())


@posix
def test_folder_and_files_are_the_users_alone(own_cache: Path) -> None:
    library = build("unit", SOURCE.format(answer=1))
    for path in (own_cache, library, note_of(library)):
        assert path.stat().st_mode & 0o077 == 0, path


@posix
@pytest.mark.parametrize("mode", [0o777, 0o770, 0o1777])
def test_folder_that_others_can_write_is_refused(own_cache: Path, mode: int) -> None:
    build("unit", SOURCE.format(answer=1))
    own_cache.chmod(mode)
    with pytest.raises(CompilerError, match=re.escape(f"{own_cache}: others may write to it") + ".*DRAWBAR_CACHE"):
        build("unit", SOURCE.format(answer=1))


@posix
def test_folder_of_another_user_is_refused(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    build("unit", SOURCE.format(answer=1))
    monkeypatch.setattr(os, "geteuid", lambda: 12345)
    if own_cache.stat().st_uid == 0:
        os.chown(own_cache, 54321, -1)
    with pytest.raises(CompilerError, match="another user owns it"):
        build("unit", SOURCE.format(answer=1))


@posix
def test_library_that_others_can_write_is_built_again(own_cache: Path) -> None:
    source = SOURCE.format(answer=5)
    library = build("unit", source)
    planted = b"not what was built"
    library.write_bytes(planted)
    note_of(library).write_text(describe(planted))
    library.chmod(0o666)
    assert answer(source) == "5"


@posix
def test_planted_lock_is_not_followed(own_cache: Path, tmp_path: Path) -> None:
    library = build("unit", SOURCE.format(answer=3))
    note_of(library).unlink()
    precious = tmp_path / "precious"
    precious.write_text("mine")
    library.with_suffix(".lock").symlink_to(precious)
    with pytest.raises(CompilerError, match=re.escape(f"{own_cache}: compiled solvers cannot be kept there")):
        build("unit", SOURCE.format(answer=3))
    assert precious.read_text() == "mine"


def test_full_disk_is_one_message(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(CompilerError, match=re.escape(f"{own_cache}: ") + ".*No space left.*free space"):
        build("unit", SOURCE.format(answer=6))


@pytest.mark.skipif(shutil.which("cc") is None, reason="no system compiler")
@posix
def test_no_home_and_a_chosen_cache_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("HOME")
    monkeypatch.setenv("DRAWBAR_CACHE", str(tmp_path / "cache"))
    assert answer(SOURCE.format(answer=9)) == "9"


@posix
def test_wheels_compiler_needs_no_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("ziglang")
    home = tmp_path / "home"
    home.write_text("no folder: nothing can be written below it, by root neither")
    for name in ("XDG_CACHE_HOME", "ZIG_GLOBAL_CACHE_DIR", "ZIG_LOCAL_CACHE_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("CC", f"'{sys.executable}' -m ziglang cc")
    monkeypatch.setenv("DRAWBAR_CACHE", str(tmp_path / "cache"))
    assert answer(SOURCE.format(answer=11)) == "11"
