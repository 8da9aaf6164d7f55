"""The exported library as a CMake package, and `drawbar path`: what an embedded engineer does on the first day."""

import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from drawbar.codegen.compiler import find_compiler

USER = """
cmake_minimum_required(VERSION 3.14)
project(user C)
find_package(drawbar 0.1 REQUIRED)
add_executable(user main.c)
target_link_libraries(user PRIVATE drawbar::drawbar)
"""
MAIN = """
#include <stdio.h>
#include "drawbar.h"
#include "path.h"
static struct drawbar_state state;
int main(void)
{
    const int begun = drawbar_init(&state);
    printf("%d %d\\n", begun, drawbar_set_path(&state, drawbar_path, DRAWBAR_PATH_COUNT));
    return 0;
}
"""
CMAKE = shutil.which("cmake")


def ran(*command: object) -> str:
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.skipif(CMAKE is None or sys.platform == "win32", reason="no CMake, or no system compiler for it")
def test_installed_library_is_found_and_follows_a_path_that_drawbar_wrote(
    exported: Callable[..., Path], tmp_path: Path
) -> None:
    compiler = find_compiler()
    if len(compiler) > 1:
        pytest.skip("CMake wants a compiler of one word")
    library, build, prefix, user = exported("articulated"), tmp_path / "build", tmp_path / "prefix", tmp_path / "user"
    settings = (f"-DCMAKE_C_COMPILER={compiler[0]}", "-DCMAKE_C_FLAGS=-O0", "-DCMAKE_BUILD_TYPE=None")
    hasty = "-DCMAKE_C_FLAGS=-O0 -ffast-math"  # of a project around; the library takes it back, or would be refused
    ran("cmake", "-S", library, "-B", build, "-DBUILD_SHARED_LIBS=ON", *settings, hasty)
    ran("cmake", "--build", build)
    ran("cmake", "--install", build, "--prefix", prefix)
    user.mkdir()
    (user / "CMakeLists.txt").write_text(USER)
    (user / "main.c").write_text(MAIN)
    square = tmp_path / "line.csv"
    square.write_text("x,y\n0,0\n20,0\n40,1\n60,3\n")
    said = ran(*(sys.executable, "-m", "drawbar", "path", "articulated"), *("--path", square, "--out", user / "path.h"))
    assert "made drivable" in said
    ran("cmake", "-S", user, "-B", user / "build", f"-DCMAKE_PREFIX_PATH={prefix}", *settings)
    ran("cmake", "--build", user / "build")
    assert ran(user / "build" / "user") == "0 0\n"
    if sys.platform == "linux":
        shared = next(prefix.rglob("libdrawbar.so.*.*.*"))
        assert re.search(rb"libdrawbar\.so\.0\.1\0", shared.read_bytes())
        assert shared.with_name("libdrawbar.so.0.1").exists()


def test_a_path_as_csv_is_the_table_of_the_interface(tmp_path: Path) -> None:
    out = tmp_path / "path.csv"
    ran(sys.executable, "-m", "drawbar", "path", "articulated", "--out", out)
    rows = out.read_text().splitlines()
    assert rows[0] == "arc_length,x,y,yaw"
    assert rows[1].split(",")[0] == "0.0"
    done = subprocess.run([sys.executable, "-m", "drawbar", "path", "articulated", "--out", "path.txt"], check=False)
    assert done.returncode == 2
