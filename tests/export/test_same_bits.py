"""Which compilers and flags give the same commands bit for bit, and how far apart those of others are."""

import csv
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from drawbar.codegen.cache import own_cache_folder
from drawbar.codegen.compiler import environment
from drawbar.geometry import Floats

CLANG = next(filter(shutil.which, ("clang-14", "clang")), "clang")
FLAGS = ("-std=c99", "-w", "-fno-math-errno", "-ffp-contract=off")
SAME = {
    "gcc -O0": ("gcc", "-O0"),
    "gcc -O3": ("gcc", "-O3", "-flto"),
    "gcc -Os": ("gcc", "-Os", "-fno-signed-zeros", "-fshort-enums", "-funsigned-char"),
    "gcc, one pack": ("gcc", "-O3", "-march=native", "-DPACK=1"),
    "gcc, one lane": ("gcc", "-O2", "-DLANES=1"),
    "clang -O0": (CLANG, "-O0"),
    "clang -O3": (CLANG, "-O3"),
    "clang, one pack": (CLANG, "-O2", "-march=native", "-DPACK=1"),
}
NEAR = {
    "wider rows": ("gcc", "-O2", "-march=native"),
    "fused": ("gcc", "-O2", "-march=native", "-DPACK=1", "-ffp-contract=fast"),
    "reciprocals": ("gcc", "-O2", "-freciprocal-math"),
}
MUSL = {
    "32 bits, the low byte first": ("arm-linux-musleabihf", (), "qemu-arm"),
    "64 bits, the high byte first": ("s390x-linux-musl", (), "qemu-s390x"),
}
"""machines with one C library, whose functions are the same C source: triple, flags and emulator"""


def replayed(
    folder: Path, program: Path, compiler: Sequence[str], runner: Sequence[str] = ()
) -> tuple[Floats, list[str]]:
    """Return commands and statuses of the example that is exported along with a library."""
    if shutil.which(compiler[0]) is None:
        pytest.skip(f"{compiler[0]} is not installed")
    sources = [str(file) for file in (*sorted(folder.glob("src/*.c")), folder / "example" / "main.c")]
    command = [*compiler, *FLAGS, f"-I{folder / 'include'}", *sources, "-lm", "-o", str(program)]
    subprocess.run(command, env=environment(own_cache_folder()), check=True)
    replay = [*runner, str(program), "measurements.csv", "path.csv"]
    done = subprocess.run(replay, cwd=folder / "example", capture_output=True, text=True, check=True)
    rows = list(csv.reader(done.stdout.splitlines()))[1:]
    assert len(rows) > 100
    return np.array([row[:4] for row in rows], dtype=float), [row[4] for row in rows]


@pytest.fixture(scope="module")
def plain(exported: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory) -> tuple[Floats, list[str]]:
    """Return what gcc's library commands, compiled for any x86-64."""
    return replayed(exported("articulated"), tmp_path_factory.mktemp("plain") / "example", ("gcc", "-O2"))


@pytest.mark.parametrize("case", SAME)
def test_commands_are_the_same_bit_for_bit(case: str, exported: Callable, plain: tuple, tmp_path: Path) -> None:
    commands, statuses = replayed(exported("articulated"), tmp_path / "example", SAME[case])
    assert statuses == plain[1]
    np.testing.assert_array_equal(commands, plain[0])


@pytest.mark.parametrize("case", NEAR)
def test_others_differ_in_their_last_digits(case: str, exported: Callable, plain: tuple, tmp_path: Path) -> None:
    commands, statuses = replayed(exported("articulated"), tmp_path / "example", NEAR[case])
    assert statuses == plain[1]
    np.testing.assert_allclose(commands, plain[0], rtol=0.0, atol=1e-12)


def test_numbers_that_are_flushed_to_zero_change_nothing(exported: Callable, plain: tuple, tmp_path: Path) -> None:
    """As they are in a process with a library of gcc's -ffast-math, and where a Cortex-M is told so."""
    if subprocess.run(["gcc", "-dumpmachine"], capture_output=True, text=True, check=False).stdout[:6] != "x86_64":
        pytest.skip("there is no gcc for x86-64")
    flush = tmp_path / "flush.c"
    flush.write_text(
        "#include <xmmintrin.h>\n"
        "__attribute__((constructor)) static void flush(void) { _mm_setcsr(_mm_getcsr() | 0x8040); }\n",
        "utf-8",
    )
    commands, statuses = replayed(exported("articulated"), tmp_path / "example", ("gcc", "-O2", str(flush)))
    assert statuses == plain[1]
    np.testing.assert_array_equal(commands, plain[0])


def test_neither_word_length_nor_byte_order_matters(exported: Callable, plain: tuple, tmp_path: Path) -> None:
    pytest.importorskip("ziglang")
    found = []
    for i, (triple, flags, emulator) in enumerate(MUSL.values()):
        if emulator and shutil.which(emulator) is None:
            pytest.skip(f"{emulator} is not installed")
        compiler = (sys.executable, "-m", "ziglang", "cc", "-target", triple, "-O2", "-static", *flags)
        found.append(replayed(exported("articulated"), tmp_path / str(i), compiler, (emulator,) if emulator else ()))
    assert found[0][1] == found[1][1] == plain[1]
    np.testing.assert_array_equal(found[0][0], found[1][0])
    np.testing.assert_allclose(found[0][0], plain[0], rtol=0.0, atol=1e-12)
