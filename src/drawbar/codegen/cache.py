"""Cache of compiled C: shared libraries are compiled once and lie in the user's folder under their inputs' hash."""

import hashlib
import os
import platform
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from importlib import resources
from pathlib import Path

from platformdirs import user_cache_path

from drawbar.codegen.cache_integrity import demand_own_folder, describe, is_whole, note_of
from drawbar.codegen.compiler import FLAGS, compiler_identity, environment, find_compiler, library_flags
from drawbar.errors import CompilerError

_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")

Observer = Callable[[int, int], None]
"""is called with how many units of how many are compiled, first that none is"""
_OBSERVER: ContextVar[Observer] = ContextVar("observer", default=lambda done, total: None)


@contextmanager
def watch_compilation(observer: Observer) -> Iterator[None]:
    """Report all that is compiled to an observer within the context: only libraries of several units have steps."""
    token = _OBSERVER.set(observer)
    try:
        yield
    finally:
        _OBSERVER.reset(token)


def cache_folder() -> Path:
    """Return the folder that keeps compiled libraries: $DRAWBAR_CACHE, else the user's cache folder.

    Raises:
        CompilerError: neither is known.
    """
    if chosen := os.environ.get("DRAWBAR_CACHE"):
        return Path(chosen)
    try:
        return user_cache_path("drawbar", appauthor=False)
    except RuntimeError as error:  # no HOME, and no user of this number
        raise CompilerError(
            f"The user's cache folder is not known ({error}); set DRAWBAR_CACHE to a folder."
        ) from error


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
        CompilerError: no compiler, the compiler refused the source (its first lines are quoted), or the cache folder
            cannot be written, or can be by others.
    """
    files = {"unit.c": source} if isinstance(source, str) else dict(source)
    parts = [f"{name}\n{text}" for name, text in sorted({**runtime_sources(), **files}.items())]
    parts += [*flags, compiler_identity(), _processor(), platform.platform()]
    digest = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:20]
    readable = re.sub(r"[^A-Za-z0-9_]", "_", name)[:40]
    library = cache_folder() / f"{readable}-{digest}{_SUFFIX}"
    own_cache_folder()
    if not is_whole(library):
        with _kept_in(library.parent):
            _compile(files, flags, library)
    return library


def own_cache_folder() -> Path:
    """Return the cache folder, made where there was none.

    Raises:
        CompilerError: it cannot be made, or others can write into it.
    """
    folder = cache_folder()
    with _kept_in(folder):
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        demand_own_folder(folder)
    return folder


@contextmanager
def _kept_in(folder: Path) -> Iterator[None]:
    """Turn an error of the file system into one that the folder cannot keep what is compiled."""
    try:
        yield
    except OSError as error:
        raise CompilerError(
            f"{folder}: compiled solvers cannot be kept there ({error.strerror}); free space there, "
            f"or set DRAWBAR_CACHE to another folder."
        ) from error


@contextmanager
def _turn(library: Path) -> Iterator[None]:
    """Wait until no other process builds this library; where there are no such locks, both build it, to no harm."""
    if sys.platform == "win32":
        yield
        return
    import fcntl  # POSIX alone has it

    lock = library.with_suffix(".lock")
    # nothing is truncated, and a link that somebody left there is not followed
    with os.fdopen(os.open(lock, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)) as stream:
        fcntl.flock(stream, fcntl.LOCK_EX)  # ends with the process, however that ends
        try:
            yield
        finally:
            lock.unlink(missing_ok=True)


def _compile(files: Mapping[str, str], flags: tuple[str, ...], library: Path) -> None:
    with tempfile.TemporaryDirectory(dir=library.parent) as text, _turn(library):
        if is_whole(library):
            return
        folder = Path(text)
        for file, content in {**runtime_sources(), **files}.items():
            (folder / file).write_text(content, "utf-8")
        _link(folder, sorted(name for name in files if name.endswith(".c")), flags, library)
        _keep(folder, library)


def _link(folder: Path, units: Sequence[str], flags: tuple[str, ...], library: Path) -> None:
    """Compile the units in a folder, each on a core of its own, the largest first, to a library of the final name."""
    linked = [*flags, "-o", library.name]
    if len(units) == 1:
        _run([*linked, *units, *library_flags(flags)], folder, library.stem)
        return
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        compiled = [flag for flag in flags if flag != "-shared"]
        largest_first = sorted(units, key=lambda name: -(folder / name).stat().st_size)
        commands = [[*compiled, "-c", name, "-o", f"{name}.o"] for name in largest_first]
        tell = _OBSERVER.get()
        tell(0, len(commands))
        running = [pool.submit(_run, command, folder, library.stem) for command in commands]
        try:
            for count, done in enumerate(as_completed(running), start=1):
                done.result()
                tell(count, len(commands))
        except BaseException:  # an interrupt, too, does not wait for what has not begun
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    _run([*linked, *(f"{name}.o" for name in units), *library_flags(flags)], folder, library.stem)


def _keep(folder: Path, library: Path) -> None:
    """Move a library from the folder in which it was built to its place, then its note: no process sees half of one."""
    built = folder / library.name
    built.chmod(0o700)
    note = note_of(built)
    note.write_text(describe(built.read_bytes()), "ascii")
    note.chmod(0o600)
    os.replace(built, library)
    os.replace(note, note_of(library))


def _run(arguments: Sequence[str], folder: Path, name: str) -> None:
    """Call the compiler in a folder."""
    command = [*find_compiler(), *arguments]
    surroundings = environment(cache_folder())
    done = subprocess.run(command, cwd=folder, env=surroundings, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = "\n".join(done.stderr.splitlines()[:12])
        raise CompilerError(f"{' '.join(command[:2])} … could not compile {name}:\n{lines}")
