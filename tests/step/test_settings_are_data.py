"""Another number in a configuration compiles nothing: only structure does."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from drawbar.codegen import cache
from drawbar.config import Configuration, load_configuration
from drawbar.simulation import Simulation

Build = Callable[..., Simulation]

STRUCTURE = ("controller.horizon", "estimator.window")
"""numbers that are structure: the sizes of the problems. So is whether there is a dead time at all (and beyond 16
samples, how many), and of the words: models, methods, the controller's structure, the guidance's mode, and whether the
tube's nominal state is optimised."""
TOGETHER = {"sample_time": 0.231, "machine.step": 0.011}
"""settings that must fit each other: 21 steps make a sample instead of 20"""
ZERO = ("vehicle.dead_time", "tube.tractor", "tube.trailer")
"""what stays zero where it is: no dead time at all, gains on states that the model may not have"""
NOWHERE_ELSE = ("bounded_errors.estimate", "path.file", "path.track")
"""what needs another estimator or a file"""
PREVIEWED = "vehicle.tracked"
"""what needs guidance by a preview"""
CASES = {
    "product": ("articulated",),
    "product, dead time": ("articulated", "vehicle.dead_time=0.33", "machine.actuators.dead_time=0.33"),
    "product, dead time found": ("articulated", "actuation.identify=true"),
    "product, centralised": ("articulated-centralised",),
    "product, extended Kalman filter": ("articulated-ekf",),
    "paper": ("paper",),
    "paper, centralised": ("paper-centralised",),
    "linear quadratic regulator": ("lqr-pi",),
    "pure pursuit": ("pure-pursuit-pi",),
}


def leaves(data: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the dotted keys of all settings and their values, lists whole."""
    if isinstance(data, dict):
        for name, value in data.items():
            yield from leaves(value, f"{key}.{name}" if key else name)
    else:
        yield key, data


def others(key: str, value: Any) -> list[Any]:
    """Return values near a setting's own, of which at least one should be allowed; none for what is no number."""
    if isinstance(value, bool | str) or key in STRUCTURE or key.startswith(NOWHERE_ELSE):
        return []
    if key in TOGETHER:
        return [TOGETHER[key]]
    if key == "vehicle.joint_sign":
        return [-value]
    if key == "machine.actuators.dead_time":
        return [TOGETHER["machine.step"] * round(1.1 * value / TOGETHER["machine.step"])]
    if not value and key.startswith(ZERO):
        return []
    if isinstance(value, int):
        return [value + 1]
    if isinstance(value, list):
        return [[factor * each for each in value] for factor in (1.01, 0.99)]
    return [1.01 * value, 0.99 * value] if value else [1e-3]


def changed(data: dict[str, Any], key: str, value: Any) -> dict[str, Any]:
    """Return the settings with another value of one key."""
    name, _, rest = key.partition(".")
    return data | {name: changed(data[name], rest, value) if rest else value}


def all_changed(configuration: Configuration) -> tuple[Configuration, set[str]]:
    """Return the configuration with another value of every number, and which settings kept theirs."""
    data, same = configuration.model_dump(mode="json"), set()
    for key, value in leaves(data):
        for other in others(key, value):
            try:
                Configuration.model_validate(changed(data, key, other))
            except ValueError:
                continue
            data = changed(data, key, other)
            break
        else:
            same.add(key)
    return Configuration.model_validate(data), same


@pytest.mark.parametrize("case", CASES)
def test_another_value_of_every_number_compiles_nothing(
    case: str, build: Build, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    name, *changes = CASES[case]
    next(build(name, *changes).steps())
    configuration, same = all_changed(load_configuration(name, changes))
    for key, value in leaves(configuration.model_dump(mode="json")):
        if key in same and isinstance(value, int | float) and not isinstance(value, bool):
            kept = key in STRUCTURE or key.startswith(NOWHERE_ELSE) or (not value and key.startswith(ZERO))
            kept |= key.startswith(PREVIEWED) and configuration.guidance.mode != "preview"
            assert kept, f"{key} was not changed"
    file = tmp_path / "changed.toml"
    file.write_text(configuration.to_toml())

    def refuse(files: Any, flags: tuple[str, ...], library: Path) -> None:
        pytest.fail(f"{library.stem} would be compiled")

    monkeypatch.setattr(cache, "_compile", refuse)
    next(build(str(file)).steps())
