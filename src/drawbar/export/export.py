"""From a configuration to a folder with its controller as a C library."""

import json
import math
import shutil
from collections.abc import Sequence
from pathlib import Path

from drawbar import __version__
from drawbar.config import Configuration
from drawbar.errors import DrawbarError
from drawbar.export import sources
from drawbar.export.manifest import configuration_hash, manifest
from drawbar.export.recording import measurement_table, path_table, record
from drawbar.export.targets import Target
from drawbar.export.toolchain import build_target
from drawbar.export.unit import Unit
from drawbar.export.units import units_of
from drawbar.safety.gate import PATIENCE
from drawbar.step.build import build_autopilot, build_machine, build_path, planned_speed

_FOLDERS = ("include", "src", "example", "lib")
_SEED = 0
"""of the simulated run whose measurements go with the example"""


def export_library(configuration: Configuration, folder: Path, targets: Sequence[Target] = ()) -> None:
    """Write the library's sources, its example and its manifest, and build it for each target.

    The folder is new, empty, or that of an earlier export, which is replaced.

    Raises:
        ConfigurationError: a component of the configuration exists in simulation only.
        PathError, HardwareError: the configuration's own run, which goes with the example, cannot begin.
        CompilerError: a target cannot be built.
        DrawbarError: the folder holds other files, or cannot be written.
    """
    _require_room(folder)
    path, _ = build_path(configuration)
    autopilot = build_autopilot(configuration, path, build_machine(configuration, path, _SEED), _SEED)
    units = units_of(autopilot)
    files = {
        "config.toml": configuration.to_toml(),
        **_source_files(configuration, units),
        "example/path.csv": path_table(path),
        "example/measurements.csv": measurement_table(record(autopilot, configuration.sample_time)),
    }
    try:
        for name in _FOLDERS:
            shutil.rmtree(folder / name, ignore_errors=True)
        for name, text in files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, "utf-8", newline="\n")
        builds = [build_target(target, folder) for target in targets]
        content = manifest(configuration, __version__, units, builds)
        (folder / "manifest.json").write_text(json.dumps(content, indent=2) + "\n", "utf-8", newline="\n")
    except OSError as error:
        raise DrawbarError(f"{folder}: cannot be written ({error.strerror}); choose another --out folder.") from error


def _require_room(folder: Path) -> None:
    """Refuse a folder in which something else lies: it would be lost."""
    earlier = (folder / "include" / "drawbar.h").is_file()
    if folder.is_dir() and any(folder.iterdir()) and not earlier:
        raise DrawbarError(
            f"{folder}: holds files that no earlier export wrote; choose another --out folder, or empty it."
        )


def _source_files(configuration: Configuration, units: Sequence[Unit]) -> dict[str, str]:
    """Return all that is the same for every target, by its place in the folder."""
    names = {unit.name for unit in units}
    version = f"{__version__} {configuration_hash(configuration)[:16]}"
    planned = planned_speed(configuration)
    constants = {
        **({"DRAWBAR_CENTRALISED": ""} if "controller" in names else {}),
        **({"DRAWBAR_DEAD_TIME": ""} if "predictor" in names else {}),
        "DRAWBAR_SPEED": repr(configuration.speed),
        **({"DRAWBAR_PLANNED_SPEED": repr(planned)} if math.isfinite(planned) else {}),
        "DRAWBAR_PATIENCE": repr(PATIENCE),
        "DRAWBAR_VERSION": f'"drawbar {version}"',
    }
    texts = {f"{unit.name}.c": sources.unit_text(unit) for unit in units}
    texts["step.c"] = '/* The control step. */\n#include "step.h"\n'
    every = {
        **texts,
        **sources.headers(texts.values()),
        "drawbar_size.h": sources.size_header(units, configuration.sample_time),
        "drawbar_components.h": sources.parts_header(units, constants),
    }
    listed = " ".join(f"src/{name}" for name in sorted(texts))
    marks = {"NAME": configuration.name, "VERSION": __version__, "HASH": version.split()[1], "SOURCES": listed}
    return {
        **{f"{'include' if name in sources.PUBLIC else 'src'}/{name}": text for name, text in sorted(every.items())},
        "CMakeLists.txt": sources.filled("CMakeLists.txt", marks),
        "README.md": sources.filled("README.md", marks),
        "example/main.c": sources.filled("main.c", {}),
    }
