"""Find a C compiler on this machine: $CC, cc, gcc, clang, else the ziglang wheel."""

import importlib.util
import os
import shlex
import shutil
import sys
from functools import cache
from importlib.metadata import version

from drawbar.errors import CompilerError

FLAGS = (
    "-std=c99",
    "-O3",
    "-march=native",
    "-ffp-contract=fast",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-fPIC",
    "-shared",
)
"""Optimised for this machine, with IEEE semantics kept: never -ffast-math."""


@cache
def find_compiler() -> tuple[str, ...]:
    """Return the command that compiles C, as arguments.

    Raises:
        CompilerError: nothing was found; says how to install a compiler with pip.
    """
    chosen = os.environ.get("CC", "").strip()
    if chosen:
        command = shlex.split(chosen)
        if shutil.which(command[0]) is None:
            raise CompilerError(f"CC={chosen!r} names no program on this machine; unset CC or name a C compiler.")
        return tuple(command)
    for name in ("cc", "gcc", "clang"):
        if path := shutil.which(name):
            return (path,)
    if importlib.util.find_spec("ziglang"):
        return (sys.executable, "-m", "ziglang", "cc")
    raise CompilerError(
        'No C compiler found: looked at $CC, cc, gcc, clang and the ziglang wheel. Try: pip install "drawbar[zig]"'
    )


@cache
def compiler_identity() -> str:
    """Return what changes when the compiler on this machine does; part of the cache key."""
    command = find_compiler()
    if "ziglang" in command:
        return f"zig {version('ziglang')}"
    path = os.path.realpath(shutil.which(command[0]) or command[0])
    return f"{' '.join(command)} {path} {os.stat(path).st_mtime_ns}"
