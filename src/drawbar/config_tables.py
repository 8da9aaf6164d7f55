"""Configuration tables: TOML files with all that they extend, and changes KEY=VALUE, before anything is validated."""

import math
import os
import re
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from drawbar.configurations import shipped_names, shipped_text
from drawbar.errors import ConfigurationError
from drawbar.misspelt import meant

_TAGS = ("model", "kind")
"""keys that select which one of several a section describes"""
_LARGEST = 1_000_000
"""characters that a configuration file has at most"""


def resolved_table(source: str, extending: tuple[str, ...] = ()) -> tuple[dict[str, Any], str]:
    """Return a file's keys on top of those of the configuration that it extends, and where they came from.

    Args:
        source: path of a TOML file, or a shipped name.
        extending: real paths of the files that extend this one.

    Raises:
        ConfigurationError: unreadable, not TOML, or extends none that there is; names which and why.
    """
    text, origin = _read(source)
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # also digits without end, brackets without end
        reason = str(error).replace("Cannot overwrite a value", "a key is given twice")
        reason += _backslash(text, error)
        raise ConfigurationError(f"{origin}: is not valid TOML: {reason}.") from error
    _anchor(data, Path(source).parent)
    if "extends" not in data:
        return data, origin
    base = data.pop("extends")
    beside = str(Path(source).parent / base) if isinstance(base, str) else ""
    extending = (*extending, os.path.realpath(source))
    is_file = os.path.isfile(beside)
    if not isinstance(base, str) or (is_file and os.path.realpath(beside) in extending):
        raise ConfigurationError(
            f"{origin}: extends = {base!r} is not allowed; give the name of a shipped configuration "
            f"({', '.join(shipped_names())}) or of a file in the same folder, but none that extends this one."
        )
    if not is_file and base not in shipped_names():
        raise _unknown(f"{origin}: extends = {base!r}", base)
    basis, _ = resolved_table(beside if is_file else base, extending)
    return _merged(basis, data), origin


def _anchor(data: dict[str, Any], folder: str | Path) -> None:
    """Make path.file absolute in place; a relative one is in the folder, which is relative to the working directory."""
    section = data.get("path")
    if isinstance(section, dict) and isinstance(file := section.get("file"), str) and file:
        section["file"] = str(Path(folder, file).absolute())


def _merged(basis: dict[str, Any], data: dict[str, Any]) -> dict[str, Any]:
    """Return the basis with data on top; a section of another model replaces the basis's."""
    merged = dict(basis)
    for key, value in data.items():
        merged[key] = _merged(basis[key], value) if _goes_on(basis.get(key), value) else value
    return merged


def _goes_on(old: Any, new: Any) -> bool:
    """Return whether both are sections of the same model and the new one holds anything."""
    both = isinstance(old, dict) and isinstance(new, dict) and new
    return bool(both) and all(new.get(tag) in (None, old.get(tag)) for tag in _TAGS)


def _backslash(text: str, error: Exception) -> str:
    """Return what to do where a path of Windows stands in double quotes, at the line of an error; else nothing."""
    place = re.search(r"at line (\d+)", str(error))
    line = text.splitlines()[int(place[1]) - 1 :][:1] if place else []
    if not any("\\" in each for each in line):
        return ""
    return "; a backslash in double quotes begins an escape: write the path with / or in single quotes"


def _read(source: str) -> tuple[str, str]:
    if source in shipped_names():
        return shipped_text(source), source
    if not os.path.exists(source):
        raise _unknown(source, source)
    try:
        with open(source, encoding="utf-8-sig") as file:
            text = file.read(_LARGEST + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, UnicodeDecodeError):
            raise ConfigurationError(
                f"{source}: byte {error.start} is not UTF-8 text; save the file as UTF-8."
            ) from error
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise ConfigurationError(
            f"{source}: cannot be read as a configuration ({reason}); "
            f"give a TOML file or one of: {', '.join(shipped_names())}."
        ) from error
    if len(text) > _LARGEST:
        raise ConfigurationError(
            f"{source}: is longer than a million characters, so it is no configuration; give a TOML file."
        )
    return text, source


def _unknown(place: str, source: str) -> ConfigurationError:
    """Return the error that nothing has this name; the place is where it was given."""
    return ConfigurationError(
        f"{place}: is neither a file nor a shipped configuration{meant(source, shipped_names())}; "
        f"give a TOML file or one of: {', '.join(shipped_names())}."
    )


def changed_table(data: dict[str, Any], changes: Sequence[str]) -> dict[str, Any]:
    """Return a complete table, changed in place by KEY=VALUE; a relative path.file is in the working directory.

    Raises ConfigurationError where a change is no KEY=VALUE, or sets a key of a value.
    """
    for change in sorted(changes, key=_turn):
        _apply(data, change)
    _anchor(data, "")
    return data


def _turn(change: str) -> float:
    """Return a change's place among others: one of a section's model or kind takes back what the section held."""
    sections = change.partition("=")[0].strip().split(".")
    return len(sections) if sections[-1] in _TAGS else math.inf


def _apply(data: dict[str, Any], change: str) -> None:
    """Set one dotted key in place."""
    key, separator, text = change.partition("=")
    if not separator or not key.strip():
        raise ConfigurationError(f"--set {change!r}: give KEY=VALUE, for example --set vehicle.wheelbase=1.5.")
    *sections, last = key.strip().split(".")
    for section in sections:
        if isinstance(data, dict):
            if data.get(section) is None:  # one that is left out, such as devices
                data[section] = {}
            data = data[section]
    if not isinstance(data, dict):
        raise ConfigurationError(
            f"--set {change!r}: {'.'.join(sections)} is a value, not a section with keys; set it as a whole."
        )
    value = _value(text)
    if last in _TAGS and data.get(last) != value:
        data.clear()  # another model or machine has other keys: they start at their defaults
    data[last] = value


def _value(text: str) -> Any:
    """Return a value written in TOML; what is none is a string."""
    try:
        (value,) = tomllib.loads(f"value = {text}").values()
    except (ValueError, RecursionError):
        return text
    return value
