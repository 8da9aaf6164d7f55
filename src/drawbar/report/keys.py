"""Every key of a configuration with unit, range, default and meaning, read from the declarations themselves."""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt, MinLen
from pydantic import AfterValidator, BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from drawbar.config import Configuration
from drawbar.declared_words import declared_words
from drawbar.settings import (
    FASTEST,
    HIGHEST,
    LATEST,
    LONGEST,
    Settings,
    mast_height,
    metres,
    metres_per_second,
    radians,
    seconds,
)

_UNIT = r"(?:1/)?(?:rad|m|s|kg|Nm|Hz)[²³]?(?:/(?:rad|m|s|g|\(m s\))[²³]?)?"
_WITHIN: dict[Any, str] = {
    radians: f"±{math.pi:.4g}",
    metres: f"±{LONGEST:g}",
    mast_height: f"±{HIGHEST:g}",
    metres_per_second: f"±{FASTEST:g}",
    seconds: f"±{LATEST:g}",
}
"""what the validators of numbers allow"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """One value of a configuration."""

    name: str
    """dotted"""
    unit: str
    """of measure; empty: none, or not one for all"""
    allowed: str
    default: str
    """TOML; empty: it has none and must be given"""
    meaning: str
    """one sentence or a few"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A section of a configuration, or one of the variants that it may be."""

    name: str
    """dotted; empty: the keys outside of all sections"""
    variant: str
    """`model = "…"` or `kind = "…"` that chooses it; empty: there is no choice"""
    meaning: str
    keys: Sequence[Key]


def sections(configuration: Configuration | None = None) -> list[Section]:
    """Return all sections with all their variants and defaults; of a configuration what it has, and its values."""
    return list(_sections(Configuration, "", "", configuration))


def events() -> list[Section]:
    """Return the kinds of events that may happen to the simulated machine."""
    found = {section.variant: section for section in sections() if section.name == "machine.events"}
    return list(found.values())


def _sections(kind: type[BaseModel], name: str, variant: str, value: BaseModel | None) -> Iterator[Section]:
    keys: list[Key] = []
    below: list[tuple[type[BaseModel], str, str, BaseModel | None]] = []
    words = declared_words(kind)
    for key, field in kind.model_fields.items():
        dotted = f"{name}.{key}" if name else key
        given: Any = getattr(value, key) if value is not None else PydanticUndefined
        models = _models(field.annotation)
        if not models or get_origin(field.annotation) is tuple or given is None:
            keys.append(_key(dotted, field, words.get(key, ""), given))
        chosen = [model for model in models if value is None or isinstance(given, model)]
        below += [(model, dotted, _variant(model), given if value is not None else None) for model in chosen]
    meaning = " ".join((kind.__doc__ or "").split())
    if keys:
        yield Section(name=name, variant=variant, meaning=meaning, keys=keys)
    for each in below:
        yield from _sections(*each)


def _models(annotation: Any) -> list[type[BaseModel]]:
    """Return the sections that a key may hold: one, several to choose from, or those of a list."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if get_origin(annotation) in (Union, UnionType, Annotated, tuple):
        return [model for each in get_args(annotation) for model in _models(each)]
    return []


def _variant(model: type[BaseModel]) -> str:
    for key in ("model", "kind"):
        if key in model.model_fields:
            return f'{key} = "{get_args(model.model_fields[key].annotation)[0]}"'
    return ""


def _key(name: str, field: FieldInfo, words: str, value: Any) -> Key:
    unit, meaning = _unit(words)
    default = field.get_default(call_default_factory=True) if value is PydanticUndefined else value
    return Key(
        name=name,
        unit=unit,
        allowed=_allowed(field.annotation, field.metadata),
        default="" if default is PydanticUndefined else _toml(default),
        meaning=meaning,
    )


def _unit(text: str) -> tuple[str, str]:
    """Return the unit that ends a description's first statement, or begins it, and the text without it."""
    if found := re.search(rf", ({_UNIT})(?=[:;.]|$)", text):
        return found[1], text[: found.start()] + text[found.end() :]
    if found := re.match(rf"({_UNIT})(?:[,;:] |$)", text):
        return found[1], text[found.end() :]
    return "", text


def _allowed(annotation: Any, metadata: Sequence[Any]) -> str:
    if get_origin(annotation) is Annotated:
        inner, *more = get_args(annotation)
        return _allowed(inner, [*more, *metadata])
    if get_origin(annotation) is Literal:
        return ", ".join(_toml(each) for each in get_args(annotation))
    if isinstance(annotation, type) and issubclass(annotation, Enum):
        return ", ".join(_toml(each.value) for each in annotation)
    if type(None) in get_args(annotation):
        return f"{_allowed(get_args(annotation)[0], metadata)}, or left out"
    if get_origin(annotation) is tuple:
        return f"list of {_allowed(get_args(annotation)[0], ())}" if not _models(annotation) else "list of events"
    if get_origin(annotation) is not None:
        return f"table of {_allowed(get_args(annotation)[1], ())}"
    limits = _limits(metadata)
    kind = {float: "number", int: "integer", str: "text", bool: "true, false"}.get(annotation, "section")
    return f"{kind} {limits}".strip()


def _limits(metadata: Sequence[Any]) -> str:
    """Return the limits of a number."""
    found = []
    for each in metadata:
        if isinstance(each, FieldInfo):
            found.append(_limits(each.metadata))
        elif isinstance(each, AfterValidator):
            found.append(_WITHIN.get(each.func, ""))
        elif isinstance(each, Gt | Ge | Lt | Le):
            sign, limit = {Gt: (">", "gt"), Ge: ("≥", "ge"), Lt: ("<", "lt"), Le: ("≤", "le")}[type(each)]
            found.append(f"{sign} {getattr(each, limit):.4g}")
        elif isinstance(each, MinLen):
            found.append(f"at least {each.min_length}")
    limits = ", ".join(dict.fromkeys(text for text in found if text)).split(", ")
    signs = {limit[:1] for limit in limits}
    if signs & {">", "≥"}:
        limits = [limit.replace("±", "≤ ") for limit in limits if limit[:1] != "±" or not signs & {"<", "≤"}]
    return ", ".join(_strictest(limits))


def _strictest(limits: list[str]) -> list[str]:
    """Return the limits without those that another one implies, the lower one first."""
    for signs, strictest in (("<≤", min), (">≥", max)):
        several = [limit for limit in limits if limit and limit[0] in signs]
        if several:
            kept = strictest(several, key=lambda limit: float(limit[1:]))
            limits = [kept, *(limit for limit in limits if limit not in several)]
    return limits


def _toml(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Enum | str):
        return f'"{value.value if isinstance(value, Enum) else value}"'
    if isinstance(value, float):
        return f"{value:.5g}" if value != round(value) else f"{value:.1f}"
    if isinstance(value, Settings):
        return f"{{{', '.join(f'{key} = {_toml(each)}' for key, each in value)}}}"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key} = {_toml(each)}' for key, each in value.items())}}}"
    if isinstance(value, tuple | list):
        return f"[{', '.join(_toml(each) for each in value)}]"
    return str(value)
