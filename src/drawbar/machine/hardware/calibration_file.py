"""The result of a calibration as a section of a TOML file: date, numbers, deviations, residuals."""

import re
import tomllib
from collections.abc import Mapping
from datetime import date
from typing import Any

import tomli_w

from drawbar.errors import ConfigurationError
from drawbar.machine.hardware.calibrated import Calibrated
from drawbar.protocols.sensors import InductiveSensor, Potentiometer

_NAME = re.compile(r"[a-z][a-z0-9_]*")


def calibration_section(
    name: str,
    on: date,
    values: Mapping[str, Calibrated],
    sensor: Potentiometer | InductiveSensor | None = None,
) -> dict[str, Any]:
    """Return what is written under [calibration.NAME].

    Args:
        name: of the device, such as "front_wheels" or "joint".
        on: the day.
        values: what was found, by name.
        sensor: how its counts become angles, if that was calibrated.

    Raises:
        ConfigurationError: the name is none, or a value is refused; says which and why.
    """
    if not _NAME.fullmatch(name):
        raise ConfigurationError(
            f"calibration of {name!r}: give a name of small letters, digits and _, front_wheels say."
        )
    refused = [f"{key}: {reason}" for key, value in values.items() for reason in value.refusals]
    if refused:
        raise ConfigurationError(f"the calibration of {name} is not written: {'; '.join(refused)}.")
    section: dict[str, Any] = {"date": on}
    if sensor is not None:
        section["sensor"] = _sensor(sensor)
    return section | {key: _value(value) for key, value in values.items()}


def _sensor(sensor: Potentiometer | InductiveSensor) -> dict[str, Any]:
    if isinstance(sensor, Potentiometer):
        return {"counts": [*sensor.counts], "angles": [*sensor.angles], "deviation": sensor.deviation}
    return {
        "coefficients": [*sensor.coefficients],
        "lowest": sensor.lowest,
        "highest": sensor.highest,
        "deviation": sensor.deviation,
    }


def _value(value: Calibrated) -> dict[str, Any]:
    return {
        "value": value.value,
        "deviation": value.deviation,
        "residual": value.residual,
        "samples": value.samples,
        "unit": value.unit,
        "residual_unit": value.residual_unit,
    }


def read_sensor(section: Mapping[str, Any]) -> Potentiometer | InductiveSensor:
    """Return the sensor of a section.

    Raises:
        ConfigurationError: there is none, or it cannot be one.
    """
    match section.get("sensor"):
        case {"counts": [*counts], "angles": [*angles], "deviation": float(deviation)}:
            return Potentiometer(counts=tuple(counts), angles=tuple(angles), deviation=deviation)
        case {
            "coefficients": [c0, c1, c2, c3],
            "lowest": float(lowest),
            "highest": float(highest),
            "deviation": float(deviation),
        }:
            return InductiveSensor(coefficients=(c0, c1, c2, c3), lowest=lowest, highest=highest, deviation=deviation)
        case given:
            raise ConfigurationError(f"a calibration's sensor is {given!r}; calibrate the sensor (drawbar calibrate).")


def updated(text: str, name: str, section: Mapping[str, Any]) -> str:
    """Return a TOML file's text with [calibration.NAME] replaced or added, all else byte for byte as it was.

    Raises:
        ConfigurationError: the text is not TOML before or would not be after, or says the section in a way that is not
            a header of its own, such as an inline table.
    """
    before = _parsed(text)
    lines = text.splitlines(keepends=True)
    own = [i for i, line in enumerate(lines) if _header(line, name)]
    kept = [line for i, line in enumerate(lines) if not _below(lines, i, own)]
    head = "".join(kept)
    if name in _parsed(head).get("calibration", {}):
        raise ConfigurationError(f"calibration.{name} is a value in the file; make it a section [calibration.{name}].")
    gap = "" if not head or head.endswith("\n\n") else "\n" if head.endswith("\n") else "\n\n"
    after = head + gap + tomli_w.dumps({"calibration": {name: dict(section)}})
    expected = {**before, "calibration": {**before.get("calibration", {}), name: dict(section)}}
    if _parsed(after) != expected:
        raise ConfigurationError(
            f"[calibration.{name}] cannot be put into this file; give its sections their own headers."
        )
    return after


def _header(line: str, name: str) -> bool:
    return re.match(rf"\s*\[calibration\.{name}(\.\w+)*\]\s*(#.*)?$", line) is not None


def _below(lines: list[str], i: int, own: list[int]) -> bool:
    """Return whether a line belongs to one of the section's own headers."""
    headers = [k for k in range(i + 1) if re.match(r"\s*\[", lines[k])]
    return bool(headers) and headers[-1] in own


def _parsed(text: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigurationError(f"the file with the calibrations is not valid TOML: {error}.") from error
