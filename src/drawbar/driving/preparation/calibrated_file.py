"""Calibrated file: a configuration beside the user's own, which extends it by what calibrations have found."""

import tomllib
from collections.abc import Sequence
from datetime import date
from pathlib import Path
from typing import Any

import tomli_w

from drawbar.driving.preparation.hand_calibration import CalibrationResult
from drawbar.errors import ConfigurationError

SUFFIX = ".calibrated.toml"
_HEAD = (
    "# Written by drawbar calibrate or drawbar drive --remember; drive with this file. What it extends stays yours.\n"
    "# It is written again each time: other keys that you write here are kept, comments are not.\n"
)


def calibrated_file(configuration: Path) -> Path:
    """Return where the calibrations of a configuration's file belong: beside it, or itself if it is such a file."""
    if configuration.name.endswith(SUFFIX):
        return configuration
    return configuration.with_name(configuration.name.removesuffix(".toml") + SUFFIX)


def calibrated_text(configuration: Path, found: Sequence[CalibrationResult], on: date, log: str) -> str:
    """Return the new content of the calibrated file of a configuration.

    Args:
        configuration: the user's file, or the calibrated one.
        found: of this time; what is refused changes nothing.
        on: the day.
        log: from which it comes.

    Raises:
        ConfigurationError: the calibrated file that is there cannot be read.
    """
    file = calibrated_file(configuration)
    content: dict[str, Any] = {"extends": configuration.name}
    if file.exists():
        try:
            content = tomllib.loads(file.read_text("utf-8"))
        except (OSError, ValueError) as error:
            raise ConfigurationError(f"{file}: cannot be read ({error}); repair it, or move it away") from error
    lines = [f"# {on.isoformat()}, {log}:\n"]
    for each in found:
        if each.sets:
            value = each.value
            lines.append(f"#   {each.name}: {value.text} {value.unit}\n")
        for key, number in each.sets.items():
            _set(content, key.split("."), number)
    return _HEAD + "".join(lines) + "\n" + tomli_w.dumps(content)


def _set(content: dict[str, Any], keys: Sequence[str], value: Any) -> None:
    for key in keys[:-1]:
        content = content.setdefault(key, {})
    content[keys[-1]] = value
