"""Compiler for C on this machine: $CC, cc, gcc, clang, else the ziglang wheel."""

import importlib.util
import os
import platform
import shlex
import shutil
import sys
from functools import cache
from importlib.metadata import version
from pathlib import Path

from drawbar.errors import CompilerError
from drawbar.extras import install_command

FLAGS = (
    "-std=c99",
    "-O3",
    "-march=native",
    "-ffp-contract=fast",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-fno-tree-vrp",  # which takes gcc a third of its time, and finds no ranges in doubles; clang only warns
    "-fPIC",
    "-shared",
)
"""Optimised for this machine, with IEEE semantics kept: never -ffast-math."""


@cache
def find_compiler() -> tuple[str, ...]:
    """Return the command that compiles C, as arguments.

    Raises:
        CompilerError: nothing was found; explains how to install a compiler with pip.
    """
    chosen = os.environ.get("CC", "").strip()
    if chosen:
        command = _split(chosen)
        if not command or shutil.which(command[0]) is None:
            raise CompilerError(f"CC={chosen!r} names no program on this machine; unset CC or name a C compiler.")
        return tuple(command)
    for name in ("cc", "gcc", "clang"):
        if path := shutil.which(name):
            return (path,)
    if importlib.util.find_spec("ziglang"):
        return (sys.executable, "-m", "ziglang", "cc")
    raise CompilerError(
        f"No C compiler found: looked at $CC, cc, gcc, clang and the ziglang wheel. Try: {install_command('zig')}"
    )


def _split(chosen: str) -> list[str]:
    try:
        return shlex.split(chosen)
    except ValueError as error:
        raise CompilerError(f"CC={chosen!r} is no command ({error}); unset CC or name a C compiler.") from error


def environment(cache: Path) -> dict[str, str]:
    """Return the environment in which a compiler is called: the wheel's keeps what it needs in our cache folder."""
    own = str((cache / "zig").absolute())
    return {**os.environ, "ZIG_GLOBAL_CACHE_DIR": own, "ZIG_LOCAL_CACHE_DIR": own}


def library_flags(flags: tuple[str, ...]) -> tuple[str, ...]:
    """Return what ends a command that links: the wheel's compiler need not build its runtime first, which takes 4 s.

    Nothing of that runtime is called in code of FLAGS, optimised for processors that divide 64-bit integers and have
    the doubles' arithmetic. Without optimisation the compiler adds checks that call it.
    """
    able = sys.platform == "linux" and platform.machine() in ("x86_64", "aarch64")
    return ("-lm", "-rtlib=none") if able and flags == FLAGS and "ziglang" in find_compiler() else ("-lm",)


@cache
def compiler_identity() -> str:
    """Return what changes when the compiler on this machine does; part of the cache key."""
    command = find_compiler()
    if "ziglang" in command:
        return f"zig {version('ziglang')}"
    path = os.path.realpath(shutil.which(command[0]) or command[0])
    return f"{' '.join(command)} {path} {os.stat(path).st_mtime_ns}"
