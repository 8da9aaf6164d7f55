"""Build the API reference from the docstrings: python docs/reference.py [FOLDER], by default build/reference.

Needs pdoc (pip install '.[dev]'). A warning of pdoc, such as an annotation that cannot be resolved, is an error.
"""

import pkgutil
import sys
import warnings
from pathlib import Path

import matplotlib.font_manager  # noqa: F401  (its first import on a machine runs fc-list, which pdoc forbids while it imports)
import pdoc

import drawbar


def main(folder: Path) -> None:
    """Write a page for every module into the folder."""
    for category in (UserWarning, RuntimeWarning):
        warnings.simplefilter("error", category)
    # one by one, since pdoc follows `__all__` of the package, which lists classes and functions
    names = {module.name for module in pkgutil.iter_modules(drawbar.__path__)} - {"__main__", *drawbar.__all__}
    pdoc.render.configure(docformat="google")
    pdoc.pdoc("drawbar", *(f"drawbar.{name}" for name in sorted(names)), output_directory=folder)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "build/reference"))
