"""The library built for other machines, and what the manifest says of it."""

import json
from pathlib import Path

import pytest

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.export.export import export_library
from drawbar.export.targets import TARGETS, find_target
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
    "nearbyint",
    "sin",
    "sqrt",
    "tan",
}
MEMORY = {"memcpy", "memmove", "memset", "__aeabi_memclr8", "__aeabi_memcpy8", "__aeabi_memcpy", "__aeabi_memclr"}


@pytest.fixture(scope="module")
def manifest(for_targets):
    return json.loads((for_targets / "manifest.json").read_text("utf-8"))


@pytest.fixture(scope="module")
def targets(manifest):
    return manifest["targets"]


def test_a_microcontroller_gets_mathematics_and_memory_from_its_c_library_and_nothing_else(targets) -> None:
    assert set(targets["cortex-m7"]["needs"]) <= C_LIBRARY | MEMORY


def test_nothing_is_kept_outside_the_state(targets) -> None:
    for target in targets.values():
        assert target["sections_bytes"][".data"] == target["sections_bytes"][".bss"] == 0


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_the_product_fits_a_microcontroller(manifest, target) -> None:
    stated = manifest["targets"][target.name]
    sections = stated["sections_bytes"]
    assert 50_000 < sections[".text"] + sections[".rodata"] < (320 if target.name == "cortex-m7" else 384) * 1024
    assert 50_000 < manifest["state_bytes"] + sections[".data"] + sections[".bss"] < 128 * 1024
    if target.stack_known:
        assert 1000 < max(stated["stack_bytes"].values()) < 16 * 1024


def test_windows_finds_every_function_under_its_own_name(for_targets: Path) -> None:
    library = (for_targets / "lib" / "windows-x86_64" / "drawbar.dll").read_bytes()
    names = exports(for_targets / "include")
    assert {"drawbar_init", "drawbar_step", "drawbar_version", "drawbar_actuate"} <= set(names)
    for name in names:
        assert b"\0" + name.encode() + b"\0" in library


def test_a_library_is_the_same_when_it_is_built_again(targets, tmp_path: Path) -> None:
    export_library(load_configuration("articulated"), tmp_path, [find_target("windows-x86_64")])
    again = json.loads((tmp_path / "manifest.json").read_text("utf-8"))["targets"]["windows-x86_64"]
    assert again == targets["windows-x86_64"]


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_targets_are_found_by_name_and_by_triple(target) -> None:
    assert find_target(target.name) is find_target(target.triple) is target


def test_an_unknown_target_is_refused_with_the_list() -> None:
    with pytest.raises(ConfigurationError, match=r"'sparc'.* linux-x86_64 \(x86_64-linux-gnu\).* cortex-m7"):
        find_target("sparc")
