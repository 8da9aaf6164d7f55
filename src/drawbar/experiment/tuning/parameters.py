"""Parameters of a search: numbers of a configuration, each within a range."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import tomli_w

from drawbar.config import Configuration, load_configuration
from drawbar.errors import ConfigurationError
from drawbar.misspelt import meant

_NUMBER = r"[-+]?(?:\d+(?:\.\d+)?|\.\d+)(?:[eE][-+]?\d+)?"
_RANGE = re.compile(rf"(?P<key>[^=\s]+)=(?P<low>{_NUMBER})\.\.(?P<high>{_NUMBER})(?P<log>:log)?")

Values = Mapping[str, float]
"""a value for every parameter, by key"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One number of a configuration, searched from low to high, both included; in the key's own unit."""

    key: str
    """dotted"""
    low: float
    high: float
    log: bool
    """searched on a logarithmic scale"""
    own: float
    """the configuration's own value; an int where only whole numbers are allowed"""

    @property
    def whole(self) -> bool:
        """Whether only whole numbers are allowed."""
        return isinstance(self.own, int)

    def __str__(self) -> str:
        return f"{self.key}={self.low:g}..{self.high:g}{':log' if self.log else ''}"


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSpace:
    """A configuration and the numbers of it that are searched."""

    source: str
    """path of a TOML file, or a shipped name"""
    changes: Sequence[str]
    """texts KEY=VALUE on top of it"""
    configuration: Configuration
    parameters: Sequence[Parameter]

    @property
    def own(self) -> dict[str, float]:
        """The configuration's own values."""
        return {parameter.key: parameter.own for parameter in self.parameters}

    def with_values(self, values: Values) -> Configuration:
        """Return the configuration with these values. Raises ConfigurationError when it does not allow them."""
        return load_configuration(self.source, [*self.changes, *_changes(values)])


def read_space(source: str, changes: Sequence[str], ranges: Sequence[str]) -> SearchSpace:
    """Read a configuration and the ranges of its parameters.

    Args:
        source: path of a TOML file, or a shipped name.
        changes: texts KEY=VALUE on top of it.
        ranges: texts KEY=LOW..HIGH, or KEY=LOW..HIGH:log; several may stand in one text, blanks between them.

    Raises:
        ConfigurationError: no range, an unreadable one, a key that is unknown, no number or given twice, limits in the
            wrong order or refused by the configuration, its own value outside.
    """
    configuration = load_configuration(source, changes)
    data = configuration.model_dump(mode="json")
    parameters = [_parameter(text, data) for given in ranges for text in given.split()]
    if not parameters:
        raise ConfigurationError(
            "--parameters: nothing to search; give KEY=LOW..HIGH, e.g. guidance.look_ahead=0.4..3.0."
        )
    keys = [parameter.key for parameter in parameters]
    if twice := sorted({key for key in keys if keys.count(key) > 1}):
        raise ConfigurationError(f"--parameters: {', '.join(twice)} given twice; leave one out.")
    space = SearchSpace(source=source, changes=changes, configuration=configuration, parameters=parameters)
    for parameter in parameters:
        for limit in (parameter.low, parameter.high):
            _check_limit(space, parameter, limit)
    return space


def to_toml(values: Values) -> str:
    """Return the values as the sections of a configuration file."""
    sections: dict[str, Any] = {}
    for key, value in values.items():
        *parents, last = key.split(".")
        section = sections
        for parent in parents:
            section = section.setdefault(parent, {})
        section[last] = value
    return tomli_w.dumps(sections)


def _changes(values: Values) -> list[str]:
    return [f"{key}={value!r}" for key, value in values.items()]


def _parameter(text: str, data: Mapping[str, Any]) -> Parameter:
    """Return the parameter that a text names, of the configuration with this content."""
    match = _RANGE.fullmatch(text)
    if not match:
        raise ConfigurationError(
            f"--parameters {text}: give KEY=LOW..HIGH, or KEY=LOW..HIGH:log for a logarithmic scale, "
            "e.g. controller.tractor.lateral=5..200:log."
        )
    key, log = match["key"], match["log"] is not None
    own = _own_value(key, data)
    low, high = (_limit(text, match[name], own) for name in ("low", "high"))
    if not low < high:
        raise ConfigurationError(f"--parameters {text}: {low:g} is not below {high:g}; give the smaller limit first.")
    if log and not low > 0.0:
        raise ConfigurationError(f"--parameters {text}: a logarithmic scale needs limits above 0; leave out :log.")
    if not low <= own <= high:
        raise ConfigurationError(
            f"--parameters {text}: the configuration's own value, {own:g}, is outside; widen the range, "
            "or change the value with --set."
        )
    return Parameter(key=key, low=low, high=high, log=log, own=own)


def _own_value(key: str, data: Any) -> float:
    """Return the number under a dotted key."""
    sections = key.split(".")
    for depth, name in enumerate(sections):
        if not isinstance(data, Mapping) or name not in data:
            where = ".".join(sections[:depth])
            there = f"its keys are: {', '.join(data)}" if isinstance(data, Mapping) else "it is a value"
            near = meant(name, data) if isinstance(data, Mapping) else ""
            raise ConfigurationError(
                f"--parameters {key}: {where or 'the configuration'} has no key {name}{near}; {there}."
            )
        data = data[name]
    if isinstance(data, bool) or not isinstance(data, int | float):
        raise ConfigurationError(f"--parameters {key}: is {data!r}, and no number; only numbers can be searched.")
    return data


def _limit(text: str, number: str, own: float) -> float:
    if not isinstance(own, int):
        return float(number)
    if not float(number).is_integer():
        raise ConfigurationError(f"--parameters {text}: {number} is no whole number, and the key allows no other.")
    return int(float(number))


def _check_limit(space: SearchSpace, parameter: Parameter, limit: float) -> None:
    try:
        space.with_values({parameter.key: limit})
    except ConfigurationError as error:
        raise ConfigurationError(
            f"--parameters {parameter}: the configuration does not allow {limit:g}.\n{error}"
        ) from error
