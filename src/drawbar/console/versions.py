"""Versions of the configuration: NAME-0001.toml, NAME-0002.toml, … in one folder; none is ever changed."""

import re
import time
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drawbar.config import Configuration, load_configuration
from drawbar.errors import StorageError

_NAME = re.compile(r"(?P<name>.+)-(?P<number>\d{4,})\.(?P<kind>toml|geojson)")
"""of a version, or of the line that the version of this number drives"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Version:
    """One file."""

    file: Path
    number: int
    time: float
    """of writing, s since the epoch"""

    @property
    def written(self) -> str:
        """When, for people."""
        return time.strftime("%Y-%m-%d %H:%M", time.localtime(self.time))


class Versions:
    """The versions that the console has saved."""

    def __init__(self, folder: Path) -> None:
        """Take the folder; it is made when the first version is saved."""
        self.folder = folder

    def all(self) -> list[Version]:
        """Return all of them, the newest first."""
        versions = [
            Version(file=file, number=number, time=file.stat().st_mtime) for file, number in self._numbered("toml")
        ]
        return sorted(versions, key=lambda version: version.number, reverse=True)

    def _numbered(self, kind: str) -> list[tuple[Path, int]]:
        """Return the files of a kind, with their numbers."""
        found = [(each, _NAME.fullmatch(each.name)) for each in self.folder.glob(f"*.{kind}")]
        return [(file, int(match["number"])) for file, match in found if match]

    def next_file(self, name: str, suffix: str = ".toml") -> Path:
        """Return the file of the next version of a name, or of its line, which is written first."""
        newest, line = (max((number for _, number in self._numbered(kind)), default=0) for kind in ("toml", "geojson"))
        number = max(newest + 1, line + (suffix == ".geojson"))  # a line whose version was not written keeps its number
        return self.folder.absolute() / f"{name}-{number:04d}{suffix}"

    def save(self, configuration: Configuration) -> Path:
        """Keep a configuration as the next version; return its file. Raises StorageError."""
        file = self.next_file(configuration.name)
        self.write(file, configuration.to_toml().encode())
        return file

    def write(self, file: Path, content: bytes) -> None:
        """Write a new file of the folder; raises StorageError where that cannot be, or it is there already."""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with file.open("xb") as opened:
                try:
                    opened.write(content)
                    opened.flush()
                except OSError:  # no half version stays
                    file.unlink()
                    raise
        except OSError as error:
            raise StorageError(f"{file}: cannot be written ({error.strerror}); nothing was changed") from error


def changes_between(before: Configuration, after: Configuration) -> list[tuple[str, str, str]]:
    """Return the keys whose values differ, with the value before and after, as TOML has them; empty: not there."""
    old, new = (dict(_flat(tomllib.loads(each.to_toml()), "")) for each in (before, after))
    keys = [key for key in {**old, **new} if old.get(key) != new.get(key)]
    return [(key, _text(old.get(key)), _text(new.get(key))) for key in keys]


def read_version(version: Version) -> Configuration:
    """Return the configuration of a version; raises ConfigurationError."""
    return load_configuration(str(version.file))


def _flat(section: Mapping[str, Any], before: str) -> Iterator[tuple[str, Any]]:
    for key, value in section.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{before}{key}.")
        else:
            yield f"{before}{key}", value


def _text(value: Any) -> str:
    return "" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
