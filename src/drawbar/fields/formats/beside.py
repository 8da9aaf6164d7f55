"""Beside: files that lie beside another one and belong to it."""

from pathlib import Path


def beside(path: Path, name: str) -> Path | None:
    """Return the file of this name, in whatever case, in the folder of another; None: there is none."""
    return next((each for each in path.parent.iterdir() if each.name.lower() == name.lower()), None)
