"""The library of one step, and a caller of it."""

import ctypes
import subprocess

import pytest
from step_bench import UNITS, WARNINGS, Driver

from drawbar.codegen.cache import runtime_sources
from drawbar.codegen.compiler import find_compiler


@pytest.fixture(scope="session")
def library(tmp_path_factory):
    """Return the step, compiled with strict warnings."""
    folder = tmp_path_factory.mktemp("step")
    for name, text in {**runtime_sources(), **UNITS}.items():
        (folder / name).write_text(text)
    built = folder / "step.so"
    sources = [str(folder / name) for name in UNITS if name.endswith(".c")]
    flags = ("-std=c99", "-O1", "-fPIC", "-shared", *WARNINGS)
    subprocess.run([*find_compiler(), *flags, "-o", str(built), *sources, "-lm"], check=True)
    loaded = ctypes.CDLL(str(built))
    loaded.drawbar_status_text.restype = loaded.drawbar_version.restype = ctypes.c_char_p
    return loaded


@pytest.fixture
def driver(library):
    """Return a caller with a state of its own."""
    return Driver(library)
