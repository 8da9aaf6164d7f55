"""The library built for other machines, and what the manifest says of it."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.export.export import export_library
from drawbar.export.targets import TARGETS, Precision, find_target
from drawbar.export.toolchain import exports

C_LIBRARY = {
    "atan",
    "atan2",
    "ceil",
    "copysign",
    "cos",
    "exp",
    "expm1",
    "fabs",
    "floor",
    "fmax",
    "fmin",
    "fmod",
    "hypot",
    "log",
    "sin",
    "sqrt",
    "tan",
}
COMPARISONS = ("dcmpeq", "dcmpge", "dcmpgt", "dcmple", "dcmplt", "dcmpun")
DOUBLES = re.compile(r"__aeabi_(d\w+|\w+2d)")
"""arithmetic of doubles, by the run-time ABI for the Arm architecture"""
MOST_CODE = {"cortex-m7": 256, "cortex-m4": 448, "windows-x86_64": 373}
"""KiB"""
MEMORY = {"memcpy", "memmove", "memset", "__aeabi_memclr8", "__aeabi_memcpy8", "__aeabi_memcpy", "__aeabi_memclr"}


@pytest.fixture(scope="module")
def manifest(for_targets):
    return json.loads((for_targets / "manifest.json").read_text("utf-8"))


@pytest.fixture(scope="module")
def targets(manifest):
    return manifest["targets"]


def test_a_microcontroller_gets_mathematics_and_memory_from_its_c_library_and_nothing_else(targets) -> None:
    assert set(targets["cortex-m7"]["needs"]) <= C_LIBRARY | MEMORY


def test_without_a_unit_for_doubles_they_are_the_compilers_own_functions(targets) -> None:
    more = set(targets["cortex-m4"]["needs"]) - C_LIBRARY - MEMORY
    assert {"__aeabi_dadd", "__aeabi_dmul", "__aeabi_ddiv"} <= more
    assert all(DOUBLES.fullmatch(name) for name in more)


def members(archive: bytes) -> Iterator[bytes]:
    """Return the files in an archive."""
    place = len("!<arch>\n")
    while place < len(archive):
        size = int(archive[place + 48 : place + 58])
        yield archive[place + 60 : place + 60 + size]
        place += 60 + size + size % 2


def test_in_single_precision_only_time_stamps_and_recorded_lines_are_doubles(exported) -> None:
    pytest.importorskip("ziglang")
    folder = exported("articulated", precision=Precision.SINGLE, targets=("cortex-m4",))
    manifest = json.loads((folder / "manifest.json").read_text("utf-8"))
    built = manifest["targets"]["cortex-m4"]
    library = (folder / "lib" / "cortex-m4" / "libdrawbar.a").read_bytes()
    control_step = b"".join(each for each in members(library) if b"drawbar_line_path" not in each)
    needs = {name.decode() for name in re.findall(rb"__aeabi_\w+", control_step) if DOUBLES.fullmatch(name.decode())}
    assert (
        {"__aeabi_d2f", "__aeabi_dsub"}
        <= needs
        <= {f"__aeabi_{name}" for name in ("d2f", "f2d", "dadd", "dsub", *COMPARISONS)}
    )
    assert {name.removesuffix("f") for name in built["needs"]} & C_LIBRARY
    assert not C_LIBRARY & set(built["needs"])
    assert manifest["precision"] == "single"
    assert manifest["state_bytes"] < 64 * 1024
    assert max(built["stack_bytes"].values()) < 8 * 1024


def test_nothing_is_kept_outside_the_state(targets) -> None:
    for target in targets.values():
        assert target["sections_bytes"][".data"] == target["sections_bytes"][".bss"] == 0


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_the_product_fits_a_microcontroller(manifest, target) -> None:
    stated = manifest["targets"][target.name]
    sections = stated["sections_bytes"]
    assert 50_000 < sections[".text"] + sections[".rodata"] < MOST_CODE.get(target.name, 384) * 1024
    assert 50_000 < manifest["state_bytes"] + sections[".data"] + sections[".bss"] < 128 * 1024
    if target.stack_known:
        assert 1000 < max(stated["stack_bytes"].values()) < 16 * 1024


def test_windows_finds_every_function_under_its_own_name(for_targets: Path) -> None:
    library = (for_targets / "lib" / "windows-x86_64" / "drawbar.dll").read_bytes()
    names = exports(for_targets / "include")
    assert {"drawbar_init", "drawbar_step", "drawbar_version", "drawbar_actuate"} <= set(names)
    for name in names:
        assert b"\0" + name.encode() + b"\0" in library


@pytest.mark.parametrize("precision", Precision)
def test_windows_needs_nothing_that_it_does_not_bring(precision, for_targets: Path, tmp_path: Path) -> None:
    folder = for_targets
    if precision is Precision.SINGLE:
        folder = tmp_path
        export_library(load_configuration("articulated"), folder, [find_target("windows-x86_64")], precision)
    library = (folder / "lib" / "windows-x86_64" / "drawbar.dll").read_bytes()
    assert set(re.findall(rb"[\w-]+\.dll", library)) == {b"drawbar.dll", b"api-ms-win-crt-math-l1-1-0.dll"}


def test_a_library_is_the_same_when_it_is_built_again(targets, tmp_path: Path) -> None:
    export_library(load_configuration("articulated"), tmp_path, [find_target("windows-x86_64")])
    again = json.loads((tmp_path / "manifest.json").read_text("utf-8"))["targets"]["windows-x86_64"]
    assert again == targets["windows-x86_64"]


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_targets_are_found_by_name_and_by_triple(target) -> None:
    assert find_target(target.name) is target
    if sum(target.triple == other.triple for other in TARGETS) == 1:
        assert find_target(target.triple) is target


def test_a_triple_of_several_targets_is_refused_with_their_names() -> None:
    with pytest.raises(ConfigurationError, match=r"several targets; .* cortex-m7 .* cortex-m4"):
        find_target("thumb-freestanding-eabihf")


def test_the_nearest_target_is_suggested() -> None:
    with pytest.raises(ConfigurationError, match=r"no such target \(did you mean windows-x86_64\?\); there are"):
        find_target("windows-x86-64")


def test_an_unknown_target_is_refused_with_the_list() -> None:
    with pytest.raises(ConfigurationError, match=r"'sparc'.* linux-x86_64 \(x86_64-linux-gnu\).* cortex-m7"):
        find_target("sparc")
