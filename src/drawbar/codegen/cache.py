"""Compile C once: shared libraries live in the user's cache folder under the hash of all that went into them."""

import hashlib
import os
import platform
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache
from importlib import resources
from pathlib import Path

from platformdirs import user_cache_path

from drawbar.codegen.compiler import FLAGS, compiler_identity, find_compiler
from drawbar.errors import CompilerError

_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def cache_folder() -> Path:
    """Return the folder that keeps compiled libraries: $DRAWBAR_CACHE, else the user's cache folder."""
    chosen = os.environ.get("DRAWBAR_CACHE")
    return Path(chosen) if chosen else user_cache_path("drawbar", appauthor=False)


@cache
def runtime_sources() -> dict[str, str]:
    """Return all hand-written C99 headers of the package by file name, which is unique among them."""
    with resources.as_file(resources.files("drawbar")) as root:
        return {file.name: file.read_text("utf-8") for file in sorted(root.rglob("*.h"))}


@cache
def _processor() -> str:
    """Return what -march=native depends on: a cache folder may be shared between machines."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
        return next(line for line in lines if line.startswith(("flags", "Features")))
    except (OSError, StopIteration):
        return f"{platform.machine()} {platform.processor()}"


def build(name: str, source: str | Mapping[str, str], flags: tuple[str, ...] = FLAGS) -> Path:
    """Compile C (it may include the package's headers) and return the shared library.

    Args:
        name: readable part of the file name; what a file system may not like is replaced.
        source: C99 text of one unit, or the texts of several units and headers by file name.
        flags: compiler flags.

    Raises:
        CompilerError: no compiler, or the compiler refused the source (its first lines are quoted).
    """
    files = {"unit.c": source} if isinstance(source, str) else dict(source)
    parts = [f"{name}\n{text}" for name, text in sorted({**runtime_sources(), **files}.items())]
    parts += [*flags, compiler_identity(), _processor(), platform.platform()]
    digest = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:20]
    readable = re.sub(r"[^A-Za-z0-9_]", "_", name)[:40]
    library = cache_folder() / f"{readable}-{digest}{_SUFFIX}"
    if not library.exists():
        _compile(files, flags, library)
    return library


def _workshop(folder: Path) -> tempfile.TemporaryDirectory[str]:
    """Return a temporary folder within the cache folder, as a context."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        return tempfile.TemporaryDirectory(dir=folder)
    except OSError as error:
        raise CompilerError(
            f"{folder}: compiled solvers cannot be kept there ({error.strerror}); set DRAWBAR_CACHE to another."
        ) from error


@contextmanager
def _turn(library: Path) -> Iterator[None]:
    """Wait until no other process builds this library; where there are no such locks, both build it, to no harm."""
    if sys.platform == "win32":
        yield
        return
    import fcntl  # POSIX alone has it

    lock = library.with_suffix(".lock")
    with lock.open("w") as stream:
        fcntl.flock(stream, fcntl.LOCK_EX)  # ends with the process, however that ends
        try:
            yield
        finally:
            lock.unlink(missing_ok=True)


def _compile(files: Mapping[str, str], flags: tuple[str, ...], library: Path) -> None:
    with _workshop(library.parent) as text, _turn(library):
        if library.exists():
            return
        folder = Path(text)
        for file, content in {**runtime_sources(), **files}.items():
            (folder / file).write_text(content, "utf-8")
        units = sorted(name for name in files if name.endswith(".c"))
        linked = [*flags, "-o", library.name]
        if len(units) == 1:
            _run([*linked, *units, "-lm"], folder, library.stem)
        else:
            with ThreadPoolExecutor(os.cpu_count()) as pool:
                compiled = [flag for flag in flags if flag != "-shared"]
                commands = [[*compiled, "-c", name, "-o", f"{name}.o"] for name in units]
                list(pool.map(lambda command: _run(command, folder, library.stem), commands))
            _run([*linked, *(f"{name}.o" for name in units), "-lm"], folder, library.stem)
        os.replace(folder / library.name, library)  # atomic: no process sees half a library


def _run(arguments: Sequence[str], folder: Path, name: str) -> None:
    """Call the compiler in a folder."""
    command = [*find_compiler(), *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = "\n".join(done.stderr.splitlines()[:12])
        raise CompilerError(f"{' '.join(command[:2])} … could not compile {name}:\n{lines}")
