"""Export: from a configuration to a folder with its controller as a C library."""

import hashlib
import json
import os
import re
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import astuple
from pathlib import Path
from typing import Any

from drawbar import __version__
from drawbar.codegen import Component
from drawbar.config import Configuration
from drawbar.errors import ConfigurationError, DrawbarError
from drawbar.estimation.settings import IdealEstimatorSettings
from drawbar.export import sources
from drawbar.export.initialise import literal
from drawbar.export.manifest import configuration_hash, manifest
from drawbar.export.memory import Memory
from drawbar.export.precision import LONGEST_WINDOW, single, single_memory, single_text
from drawbar.export.recording import measurement_table, path_table, record
from drawbar.export.targets import Precision, Target
from drawbar.export.toolchain import build_target
from drawbar.file_lock import is_locked
from drawbar.guidance.path import PATH_UNIT
from drawbar.simulation import Simulation
from drawbar.step.build import step_settings, units_of
from drawbar.step.library import StepSettings
from drawbar.termination import termination_as_exit

_FOLDERS = ("include", "src", "example", "lib")
_UNFINISHED = ".unfinished"
"""folder beside them in which an export grows; that of one that was killed is thrown away"""
_SEED = 0
"""of the simulated run whose measurements go with the example"""


def export_library(
    configuration: Configuration,
    folder: Path,
    targets: Sequence[Target] = (),
    precision: Precision = Precision.DOUBLE,
) -> None:
    """Write the library's sources, its example and its manifest, and build it for each target.

    The folder is new, empty, or that of an earlier export, recognised by its manifest, and which is replaced once all
    is built.

    Raises:
        ConfigurationError: a component of the configuration exists in simulation only, or the estimator's window is too
            long for single precision.
        PathError, HardwareError: the configuration's own run, which goes with the example, cannot begin.
        CompilerError: a target cannot be built.
        DrawbarError: the folder holds other files, another export is on there, or it cannot be written.
    """
    with _own(folder):
        _require_room(folder)
        _require_exportable(configuration)
        _require_precise(configuration, precision)
        simulation = Simulation(configuration, _SEED)
        components = list(simulation.autopilot.library.components.values())
        sourced, memory = _source_files(configuration, components, precision)
        files = {
            "config.toml": configuration.to_toml(),
            **sourced,
            "example/path.csv": path_table(simulation.path),
            "example/measurements.csv": measurement_table(record(simulation)),
        }
        with _replaced_once_whole(folder) as unfinished:
            _write(unfinished, files)
            builds = [build_target(target, unfinished) for target in targets]
            _write_manifest(unfinished, manifest(configuration, precision, components, memory, builds))


@contextmanager
def _own(folder: Path) -> Iterator[None]:
    """Keep other exports out of a folder, which is made where it is not there, and removed again where it stays empty.

    Raises:
        DrawbarError: another export is on there, or the folder cannot be made.
    """
    new = [each for each in (folder, *folder.parents) if not each.exists()]
    with termination_as_exit(), ExitStack() as stack:
        with _writing(folder):
            folder.mkdir(parents=True, exist_ok=True)
            if os.name == "posix":  # Windows opens no folders
                opened = os.open(folder, os.O_RDONLY)
                stack.callback(os.close, opened)
                if is_locked(opened):
                    raise DrawbarError(
                        f"{folder}: another export is on there; wait until it has ended, or choose another --out "
                        "folder."
                    )
        try:
            yield
        finally:
            with suppress(OSError):  # they are not empty: the export is whole
                for each in new:
                    each.rmdir()


@contextmanager
def _replaced_once_whole(folder: Path) -> Iterator[Path]:
    """Give a folder in which an export grows, and put it in the place of an earlier one; nothing stays where it fails.

    Raises:
        DrawbarError: the folder cannot be written.
    """
    unfinished = folder / _UNFINISHED
    try:
        with _writing(folder):
            shutil.rmtree(unfinished, ignore_errors=True)
            yield unfinished
            _replace(folder, unfinished)
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)


@contextmanager
def _writing(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise DrawbarError(f"{folder}: cannot be written ({error.strerror}); choose another --out folder.") from error


def _write(folder: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, "utf-8", newline="\n")


def _require_room(folder: Path) -> None:
    """Refuse a folder in which something lies that no earlier export wrote, and that would be lost or built in."""
    if not folder.is_dir():
        return
    try:
        earlier = json.loads((folder / "manifest.json").read_text("utf-8"))
        written = set(earlier["files"]) if isinstance(earlier, dict) and "drawbar" in earlier else set()
    except (OSError, ValueError, KeyError, TypeError):
        written = set()
    places = [folder / name for name in _FOLDERS] if written else [folder]
    found = (file.relative_to(folder) for place in places for file in place.rglob("*") if not file.is_dir())
    foreign = (file for file in found if file.as_posix() not in written and file.parts[0] != _UNFINISHED)
    other = next((file.as_posix() for file in foreign), None)
    if other is not None:
        raise DrawbarError(
            f"{folder}: holds files that no earlier export wrote ({other}); choose another --out folder, or empty it."
        )


def _replace(folder: Path, finished: Path) -> None:
    """Put a finished export in the place of an earlier one."""
    for name in _FOLDERS:
        shutil.rmtree(folder / name, ignore_errors=True)
    for made in finished.iterdir():
        made.replace(folder / made.name)


def _write_manifest(folder: Path, content: dict[str, Any]) -> None:
    """Write the manifest, with the names of the files that are in the export's folders."""
    found = (file for name in _FOLDERS for file in (folder / name).rglob("*") if file.is_file())
    files = sorted(file.relative_to(folder).as_posix() for file in found)
    text = json.dumps(content | {"files": files}, indent=2)
    (folder / "manifest.json").write_text(text + "\n", "utf-8", newline="\n")


def _require_exportable(configuration: Configuration) -> None:
    """Refuse a configuration with a component that exists in simulation only."""
    for unit in units_of(configuration):
        if unit.simulation_only:
            raise ConfigurationError(
                f"The {unit.name} of this configuration exists in simulation only and cannot be exported; "
                f'set {unit.name}.model to another, for example "articulated".'
            )


def _require_precise(configuration: Configuration, precision: Precision) -> None:
    """Refuse a window that single precision does not suffice for."""
    estimator = configuration.estimator
    if precision is Precision.DOUBLE or isinstance(estimator, IdealEstimatorSettings):
        return
    if estimator.method == "moving_horizon" and estimator.window > LONGEST_WINDOW:
        raise ConfigurationError(
            f"estimator.window = {estimator.window}: in single precision at most {LONGEST_WINDOW} samples are allowed; "
            f"lower it, or export with --precision double."
        )


def _source_files(
    configuration: Configuration, components: Sequence[Component], precision: Precision
) -> tuple[dict[str, str], Memory]:
    """Return all that is the same for every target, by its place in the folder, and what its state takes."""
    configuration_mark = configuration_hash(configuration)[:16]
    version = f"drawbar {__version__} {configuration_mark} {precision}"
    constants = _constants(configuration, components, version)
    texts = {f"{component.name}.c": sources.component_text(component) for component in components}
    texts["path.c"] = PATH_UNIT
    texts["step.c"] = '/* The control step. */\n#include "step.h"\n'
    texts["actuate.c"] = '/* The low level: valves, motors, pedal. */\n#include "actuate.h"\n'
    texts["line.c"] = '/* Recorded lines as paths. */\n#include "line_path.h"\n#include "line_table.h"\n'
    main = sources.filled("main.c", {})
    every, memory = {**texts, **sources.headers(texts.values())}, Memory.of(components)
    sizes = _sizes(memory, configuration, version, constants)
    if precision is Precision.SINGLE:
        every, main = single(every), single_text(main)
        memory = single_memory(components, {**every, **single(sizes)})
        sizes = single(_sizes(memory, configuration, version, constants))
    every |= sizes
    number = re.match(r"\d+(?:\.\d+){0,3}", __version__)
    marks = {
        "NAME": configuration.name,
        "VERSION": __version__,
        "NUMBER": number[0] if number else "0",
        "HASH": configuration_mark,
        "SOURCES": " ".join(f"src/{name}" for name in sorted(texts)),
    }
    files = {
        **{f"{'include' if name in sources.PUBLIC else 'src'}/{name}": text for name, text in sorted(every.items())},
        "CMakeLists.txt": sources.filled("CMakeLists.txt", marks),
        "README.md": sources.filled("README.md", marks),
        "example/main.c": main,
    }
    return files, memory


def _constants(configuration: Configuration, components: Sequence[Component], version: str) -> dict[str, str]:
    """Return what the step is compiled with besides sizes, by the name of its macro."""
    names = {component.name for component in components}
    return {
        **({"DRAWBAR_CENTRALISED": ""} if "controller" in names else {}),
        **({"DRAWBAR_IDENTIFIED": ""} if "actuation" in names else {}),
        **({"DRAWBAR_DEAD_TIME": ""} if "predictor" in names else {}),
        "DRAWBAR_STEP_SETTINGS": _initialiser(step_settings(configuration)),
        "DRAWBAR_MARK": f"0x{hashlib.sha256(version.encode()).hexdigest()[:8]}u",
    }


def _sizes(memory: Memory, configuration: Configuration, version: str, constants: Mapping[str, str]) -> dict[str, str]:
    """Return the headers with numbers of this very configuration."""
    return {
        "drawbar_size.h": sources.size_header(memory, configuration.sample_time, version),
        "drawbar_components.h": sources.components_header(memory, constants),
    }


def _initialiser(settings: StepSettings) -> str:
    """Return the initialiser of struct step_settings."""
    return f"{{{', '.join(map(literal, astuple(settings)))}}}"
