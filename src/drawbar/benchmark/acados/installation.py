"""Installation of acados in a folder of its own: libraries, headers and `acados_template`."""

import ctypes
import importlib
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from importlib.metadata import distributions
from pathlib import Path
from typing import Any

from drawbar.errors import DrawbarError

PACKAGE = "comma-deps-acados"
"""wheel of acados on PyPI; it brings a CasADi of its own, so it must lie in a folder by itself"""
_LIBRARIES = ("blasfeo", "hpipm", "qpOASES_e")
"""that its own needs; loaded first, since the system's loader does not look where they are"""
INSTALL = f"pip install --no-deps --target FOLDER {PACKAGE}"


def installed_version(folder: Path) -> str:
    """Return the version of the wheel in a folder."""
    found = distributions(name=PACKAGE, path=[str(folder)])
    return next((each.version for each in found), "of unknown version")


@contextmanager
def silent() -> Iterator[None]:
    """Keep what C libraries print to standard output to themselves."""
    sys.stdout.flush()
    shown, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(shown, 1)
        os.close(shown)
        os.close(nowhere)


@contextmanager
def quiet(folder: Path) -> Iterator[None]:
    """Work in a folder, and keep what acados prints to itself."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        with redirect_stdout(io.StringIO()):
            yield
    finally:
        os.chdir(before)


def template(folder: Path) -> Any:
    """Return the module `acados_template` of an installation.

    Args:
        folder: in which INSTALL has put the wheel.

    Raises:
        DrawbarError: there is none, or it cannot be imported.
    """
    root = folder.resolve() / "acados"
    if not (root / "acados_template").is_dir():
        raise DrawbarError(f"{folder} holds no acados; install it there: {INSTALL.replace('FOLDER', str(folder))}")
    os.environ["ACADOS_SOURCE_DIR"] = str(root / "install")
    os.environ["ACADOS_PYTHON_INTERFACE_PATH"] = str(root / "acados_template")
    os.environ["TERA_PATH"] = str(root / "install" / "bin" / "t_renderer")
    sys.path.insert(0, str(root))
    try:
        for name in _LIBRARIES:
            ctypes.CDLL(str(next((root / "install" / "lib").glob(f"lib{name}.*"))))
        return importlib.import_module("acados_template")
    except (ImportError, OSError, StopIteration) as error:
        raise DrawbarError(f"acados in {folder} cannot be imported: {error}") from error
    finally:
        sys.path.remove(str(root))
