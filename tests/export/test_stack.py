"""Object files are read rightly: frames and calls of a library that was made for it."""

import subprocess
import sys
from pathlib import Path

import pytest

from drawbar.errors import CompilerError
from drawbar.export.objects import ObjectFile, read_object
from drawbar.export.stack import CallGraph

FIRST = """
double sin(double);
double other(double *x);
static __attribute__((noinline)) double deep(double x) { double a[100]; a[3] = x; return other(a) + a[4]; }
static __attribute__((noinline)) double flat(double x) { double a[10]; a[3] = x; return other(a) + sin(x); }
double entry(double x) { return deep(x) + flat(x) + 1.0; }
const int table[5] = {1, 2, 3, 4, 5};
int counter[7];
"""
SECOND = """
static __attribute__((noinline)) double deep(double *x) { volatile double a[20]; a[3] = *x; return a[3]; }
double other(double *x) { return deep(x) + 1.0; }
"""


def compiled(folder: Path, name: str, source: str, target: str) -> ObjectFile:
    pytest.importorskip("ziglang")
    (folder / f"{name}.c").write_text(source, "utf-8")
    flags = ("-target", target, "-O1", "-g0", "-ffunction-sections", "-fstack-size-section", "-fno-stack-protector")
    command = [sys.executable, "-m", "ziglang", "cc", *flags, "-c", f"{name}.c", "-o", f"{name}.o"]
    subprocess.run(command, cwd=folder, check=True)
    return read_object(folder / f"{name}.o")


@pytest.mark.parametrize("target", ["x86_64-linux-gnu", "aarch64-linux-gnu", "thumb-freestanding-eabihf"])
def test_the_deepest_chain_goes_through_both_units(target: str, tmp_path: Path) -> None:
    first, second = (compiled(tmp_path, name, text, target) for name, text in (("a", FIRST), ("b", SECOND)))
    assert 800 <= first.stack["deep"] <= 900
    assert first.sizes[".bss"] == 28
    assert first.sizes[".rodata"] >= 20
    use = CallGraph([first, second]).worst("entry")
    assert use.chain == ("entry", "deep", "other", "deep")
    frames = (first.stack["entry"], first.stack["deep"], second.stack["other"], second.stack["deep"])
    assert use.size == sum(frames)
    assert [name for name in CallGraph([first, second]).outside() if not name.startswith("__")] == ["sin"]


def test_sizes_are_read_from_windows_objects_too(tmp_path: Path) -> None:
    sizes = compiled(tmp_path, "a", FIRST, "x86_64-windows-gnu").sizes
    assert 50 < sizes[".text"] < 400
    assert sizes[".bss"] == 28
    assert sizes[".rodata"] >= 20


def test_a_function_that_calls_itself_has_no_bound(tmp_path: Path) -> None:
    text = "int odd(int n);\nint even(int n) { return n ? odd(n - 1) + 2 : 1; }\n"
    units = [
        compiled(tmp_path, "even", text, "x86_64-linux-gnu"),
        compiled(
            tmp_path, "odd", text.replace("odd", "x").replace("even", "odd").replace("x", "even"), "x86_64-linux-gnu"
        ),
    ]
    with pytest.raises(CompilerError, match="calls itself"):
        CallGraph(units).worst("even")


def test_what_is_no_object_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.o").write_bytes(b"MZ" + bytes(100))
    with pytest.raises(CompilerError, match=r"a\.o"):
        read_object(tmp_path / "a.o")
