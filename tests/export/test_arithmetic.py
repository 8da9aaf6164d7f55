"""A library whose compiler does not tell that its arithmetic is not IEEE's refuses to begin, and stops the vehicle."""

import ctypes
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from drawbar.export.targets import Precision
from drawbar.machine.low_level.low_level import ActuateStatus
from drawbar.signals import Status

REFUSALS = re.compile(r"^#if defined\(__FAST_MATH__\).*?(?=^/\* Whether)", re.MULTILINE | re.DOTALL)
"""in ieee.h: what a compiler of which no macro is known passes"""
CLANG = next(filter(shutil.which, ("clang-14", "clang")), "clang")
CASES = {
    "sums in any order": ("gcc", "-funsafe-math-optimizations", (Status.ARITHMETIC, ActuateStatus.SETTINGS)),
    "neither NaN nor infinity": ("gcc", "-ffinite-math-only", (Status.ARITHMETIC, ActuateStatus.ARITHMETIC)),
    "no NaN": (CLANG, "-fno-honor-nans", (Status.ARITHMETIC, ActuateStatus.ARITHMETIC)),
    "nothing of that": ("gcc", "-fno-signed-zeros", (Status.OK, ActuateStatus.SETTINGS)),
}
COMMAND_SIZE = {Precision.DOUBLE: 32, Precision.SINGLE: 24}
"""bytes"""
ALWAYS = ("-std=c99", "-w", "-O1", "-fPIC", "-fno-math-errno")


def built(compiler: str, flag: str, exported: Path, folder: Path) -> ctypes.CDLL:
    """Return the library, of sources that refuse nothing.

    It is linked without the flag, as gcc's start-up code for it would change the arithmetic of this process.
    """
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    shutil.copytree(exported, folder)
    header = folder / "src" / "ieee.h"
    text, found = REFUSALS.subn("", header.read_text("utf-8"))
    assert found == 1
    header.write_text(text, "utf-8")
    sources = [file.name for file in sorted((folder / "src").glob("*.c"))]
    subprocess.run([compiler, *ALWAYS, flag, "-I../include", "-c", *sources], cwd=folder / "src", check=True)
    objects = [file.name for file in sorted((folder / "src").glob("*.o"))]
    subprocess.run([compiler, "-shared", *objects, "-lm", "-o", "library.so"], cwd=folder / "src", check=True)
    return ctypes.CDLL(str(folder / "src" / "library.so"))


@pytest.mark.parametrize("precision", Precision)
@pytest.mark.parametrize("case", CASES)
def test_arithmetic_is_tried_out_before_anything_begins(
    case: str, precision: Precision, exported: Callable[..., Path], tmp_path: Path
) -> None:
    """Without NaN the vehicle went at full speed with its wheels at their bound, and no estimate was a number."""
    compiler, flag, expected = CASES[case]
    library = built(compiler, flag, exported("articulated", precision=precision), tmp_path / "library")
    state = (ctypes.c_double * (library.drawbar_state_size() // 8))()
    nothing, command = (ctypes.c_double * 64)(), (ctypes.c_double * 8)(1.0)
    assert library.drawbar_init(state) == expected[0]
    assert library.drawbar_actuate_init((ctypes.c_double * 256)(), (ctypes.c_double * 1024)()) == expected[1]
    begun = library.drawbar_step(state, nothing, command)
    assert begun == (Status.NO_PATH if expected[0] is Status.OK else Status.NOT_INITIALISED)
    assert not any(bytes(command)[: COMMAND_SIZE[precision]])


def test_python_takes_no_such_compiler_either(tmp_path: Path) -> None:
    if shutil.which(CLANG) is None:
        pytest.skip("clang is not installed")
    command = [sys.executable, "-m", "drawbar", "run", "articulated", "--out", str(tmp_path / "run")]
    surroundings = os.environ | {"CC": f"{CLANG} -fno-honor-nans", "COLUMNS": "400"}
    ended = subprocess.run(command, env=surroundings, capture_output=True, text=True, check=False)
    assert ended.returncode == 2
    assert "-fno-honor-nans: wrong build" in ended.stderr
    assert "unset CC or name another compiler" in ended.stderr
