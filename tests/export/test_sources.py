"""What is written: C99 without a warning, nothing that is not needed, and the same again the next time."""

import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from drawbar.codegen.compiler import find_compiler
from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.export.export import export_library

WARNINGS = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")
ZIG = (sys.executable, "-m", "ziglang", "cc")
DEAD_TIME = "vehicle.dead_time=0.3"
OTHERS = {
    "filter": ("articulated-ekf",),
    "whole vehicle": ("articulated-centralised",),
    "tricycle": ("paper", DEAD_TIME),
    "whole tricycle": ("paper-centralised",),
    "closed form": ("lqr-pi",),
    "pure pursuit": ("pure-pursuit-pi",),
    "dead time": ("articulated", DEAD_TIME),
}


def said(command: tuple[str, ...], folder: Path, *names: str) -> str:
    """Return what a compiler says of the sources."""
    sources = [str(file) for name in names for file in sorted(folder.glob(name))]
    assert sources

    def compile_one(source: str) -> str:
        arguments = [*command, *WARNINGS, f"-I{folder / 'include'}", "-c", source, "-o", "/dev/null"]
        return subprocess.run(arguments, capture_output=True, text=True, check=False).stderr

    with ThreadPoolExecutor(2) as pool:
        return "".join(pool.map(compile_one, sources))


@pytest.mark.parametrize("compiler", [("gcc", "-O1"), (*ZIG, "-O1")], ids=["gcc", "zig"])
def test_compiles_without_a_warning(exported, compiler: tuple[str, ...]) -> None:
    if shutil.which(compiler[0]) is None:
        pytest.skip(f"{compiler[0]} is not installed")
    if "ziglang" in compiler:
        pytest.importorskip("ziglang")
    assert said(compiler, exported("articulated"), "src/*.c", "example/*.c") == ""


def test_one_lane_at_a_time_compiles_too(exported) -> None:
    assert said((*find_compiler(), "-O0", "-DLANES=1"), exported("articulated"), "src/*.c") == ""


@pytest.mark.parametrize("case", OTHERS)
def test_other_configurations_compile_too(exported, case: str) -> None:
    assert said((*find_compiler(), "-O0"), exported(*OTHERS[case]), "src/*.c") == ""


def test_every_header_is_included_by_something(exported) -> None:
    folder = exported("articulated")
    files = [*folder.glob("src/*"), *folder.glob("include/*")]
    included = {name for file in files for name in re.findall(r'#include "([^"]+)"', file.read_text("utf-8"))}
    assert included == {file.name for file in files if file.suffix == ".h"}


def test_the_same_again_the_next_time(exported, tmp_path: Path) -> None:
    first = exported("articulated")
    export_library(load_configuration("articulated"), tmp_path)
    written = sorted(file.relative_to(tmp_path) for file in tmp_path.rglob("*") if file.is_file())
    assert len(written) > 50
    for file in written:
        assert (tmp_path / file).read_bytes() == (first / file).read_bytes(), file


def test_no_path_of_this_machine_is_written(exported) -> None:
    folder = exported("articulated")
    for file in folder.glob("**/*.[ch]"):
        assert str(folder) not in file.read_text("utf-8")


def test_what_exists_in_simulation_only_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"IdealEstimator, exists in simulation only"):
        export_library(load_configuration("articulated-ideal"), tmp_path)
    assert not any(tmp_path.iterdir())


def test_the_example_replays_what_goes_with_it(exported, tmp_path: Path) -> None:
    folder = exported("articulated")
    sources = [*map(str, folder.glob("src/*.c")), str(folder / "example" / "main.c")]
    program = tmp_path / "example"
    command = [*find_compiler(), "-O0", f"-I{folder / 'include'}", *sources, "-lm", "-o", str(program)]
    subprocess.run(command, check=True)
    done = subprocess.run(
        [str(program), "measurements.csv"], cwd=folder / "example", capture_output=True, text=True, check=True
    )
    names, *rows = [line.split(",") for line in done.stdout.splitlines()]
    assert names == ["time", "tractor_steering", "trailer_steering", "speed", "status", "meaning"]
    assert len(rows) == 150
    assert {row[4] for row in rows} == {"0"}
    assert {float(row[3]) for row in rows} == {1.0}
