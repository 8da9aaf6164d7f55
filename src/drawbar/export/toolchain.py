"""Toolchain: the ziglang wheel, which builds the library's units for one target and brings every target's C library."""

import importlib.util
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory

from drawbar.codegen.cache import own_cache_folder
from drawbar.codegen.compiler import environment
from drawbar.errors import CompilerError
from drawbar.export.objects import ObjectFile, read_object
from drawbar.export.targets import FLAGS, SMALL, Target
from drawbar.extras import install_command


@dataclass(frozen=True, slots=True, kw_only=True)
class Built:
    """What came out for one target."""

    target: Target
    compiler: str
    flags: tuple[str, ...]
    files: tuple[Path, ...]
    """the libraries"""
    units: tuple[ObjectFile, ...]
    """what they consist of"""


def build_target(target: Target, library: Path) -> Built:
    """Compile every source and join them in a static and, where the target has such, a shared library.

    Args:
        target: the machine.
        library: folder with the sources in `src` and the public headers in `include`; what is built goes to `lib`.

    Raises:
        CompilerError: the ziglang wheel is not installed, or it refused a unit (its first lines are quoted).
    """
    folder = library / "lib" / target.name
    folder.mkdir(parents=True, exist_ok=True)
    flags = ("-target", target.triple, *FLAGS, *target.flags)
    with TemporaryDirectory() as workshop:
        objects = _compile(target, flags, library, Path(workshop))
        units = tuple(read_object(file) for file in objects)
        _zig(["ar", "rcsD", target.static, *map(str, objects)], folder)
        if target.shared:
            _link(target, objects, folder, exports(library / "include"))
    return Built(
        target=target,
        compiler=f"zig cc (ziglang {version('ziglang')})",
        flags=flags,
        files=tuple(sorted(folder.iterdir())),
        units=units,
    )


def exports(include: Path) -> list[str]:
    """Return the functions that the public headers in a folder offer."""
    texts = [header.read_text("utf-8") for header in sorted(include.glob("*.h"))]
    return [name for text in texts for name in re.findall(r"^DRAWBAR_API [^;(]*?(\w+)\(", text, re.MULTILINE)]


def _compile(target: Target, flags: Sequence[str], library: Path, workshop: Path) -> list[Path]:
    """Return the object files, compiled in a workshop under relative names: no folder's name shows in what is built."""
    for name in ("include", "src"):
        shutil.copytree(library / name, workshop / name)
    bundled = _wheel() / "lib" / "libc" / "include"
    system = [f"-isystem{bundled / name}" for name in target.headers]
    sources = sorted((workshop / "src").glob("*.c"))
    for source in sources:
        small = [SMALL[source.name]] if source.name in SMALL else []
        command = ["cc", *flags, *small, *system, "-I../include", "-c", source.name, "-o", f"{source.stem}.o"]
        _zig(command, source.parent)
    return [source.with_suffix(".o") for source in sources]


def _wheel() -> Path:
    """Return the folder of the ziglang wheel."""
    found = importlib.util.find_spec("ziglang")
    if found is None or found.origin is None:
        raise CompilerError(
            f"The ziglang wheel, which builds the library, is not installed. Run: {install_command('zig')}"
        )
    return Path(found.origin).parent


def _zig(arguments: list[str], folder: Path) -> None:
    command = [sys.executable, "-m", "ziglang", *arguments]
    surroundings = environment(own_cache_folder())
    done = subprocess.run(command, cwd=folder, env=surroundings, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = "\n".join(done.stderr.splitlines()[:12])
        raise CompilerError(f"zig {' '.join(arguments[:3])} … failed:\n{lines}")


def _link(target: Target, objects: list[Path], folder: Path, exports: Sequence[str]) -> None:
    # without -O2 the wheel's compiler builds and links a runtime for debugging
    command = ["cc", "-target", target.triple, "-O2", "-shared", "-s", *map(str, objects)]
    if not target.imports:
        name = (
            f"-Wl,-install_name,@rpath/{target.shared}" if "macos" in target.triple else f"-Wl,-soname,{target.shared}"
        )
        _zig([*command, name, "-lm", "-o", target.shared], folder)
        return
    names = "".join(f"    {name}\n" for name in exports)
    (folder / "drawbar.def").write_text(f"LIBRARY {target.shared}\nEXPORTS\n{names}", "utf-8")
    # without start-up code and library of mingw, which the wheel would take a minute to build
    alone = ["-nostdlib", "-rtlib=compiler-rt", "-Wl,--no-entry", "-lapi-ms-win-crt-math-l1-1-0"]
    made = [f"-Wl,--out-implib,{target.imports}", "-o", target.shared]
    _zig([*command, "drawbar.def", *alone, "-Wl,-Brepro", *made], folder)  # -Brepro: no date in the file
