"""Wrong values: what pydantic finds in a configuration, shown by key, value and what is allowed."""

import reprlib
from typing import Any

from pydantic import ValidationError

_REASONS = {
    "missing": "is missing; add it",
    "union_tag_not_found": "{discriminator} is missing; add it",
    "union_tag_invalid": "{discriminator} = {tag!r} is not one of {expected_tags}",
    "model_type": "must be a section with keys",
    "model_attributes_type": "must be a section with keys",
    "tuple_type": "must be a list",
    "too_short": "must hold {min_length} or more values",
    "string_pattern_mismatch": "must be one character long or more, without slashes and control characters",
}
"""where pydantic's own words would be those of a programmer"""
_NO_TOML = "{reason}, and this is none in TOML: close its brackets, put texts in quotes, write decimal points"


def explained(error: ValidationError, data: dict[str, Any], origin: str, *, root: str = "configuration") -> str:
    """Return how many values are wrong, then a line for each: key, what was given, what is allowed.

    Args:
        error: that pydantic raised.
        data: in which the values are.
        origin: file, or what else the data come from.
        root: what the data are as a whole.
    """
    lines = [_line(problem, data, root) for problem in error.errors() if not _is_long_enough(problem)]
    head = f"{origin}: 1 wrong value." if len(lines) == 1 else f"{origin}: {len(lines)} wrong values."
    return "\n".join([head, *lines])


def _is_long_enough(problem: Any) -> bool:
    """Whether a list is called too short only because pydantic leaves its wrong entries out of the count."""
    return bool(problem["type"] == "too_short" and len(problem["input"]) >= problem["ctx"]["min_length"])


def _line(problem: Any, data: dict[str, Any], root: str) -> str:
    kind, context, key = problem["type"], problem.get("ctx", {}), _key(problem, data)
    message = problem["msg"].removeprefix("Value error, ").replace("Input should be", "must be")
    if "discriminator" in context:  # pydantic names the key, or the function that finds it
        context["discriminator"] = repr(context["discriminator"].strip("'_()"))
        if "expected_tags" in context:  # "external" is what a class of one's own becomes
            context["expected_tags"] = context["expected_tags"].replace("'external'", "MODULE:CLASS of your own")
    reason = _REASONS[kind].format(**context) if kind in _REASONS else message
    if reason.startswith(("must be a list", "must be a section")) and _looks_like_toml(problem["input"]):
        reason = _NO_TOML.format(reason=reason)
    # a whole section is not shown: its message names what is wrong in it
    whole = isinstance(problem["input"], dict) and kind in (*_REASONS, "value_error")
    given = "" if whole else f" = {reprlib.repr(problem['input'])}"
    return f"  {key or root}{given}: {reason.removesuffix('.')}."


def _looks_like_toml(given: Any) -> bool:
    """Whether a text was meant to be a list or a table, as of --set."""
    return isinstance(given, str) and given.lstrip().startswith(("[", "{"))


def _key(problem: Any, data: Any) -> str:
    """Return the dotted key of a problem in the data, without the names of models that pydantic puts between.

    For `loc` ("estimator", "articulated", "window") and data {"estimator": {"window": 1}} this is "estimator.window".
    """
    parts = []
    for part in problem["loc"]:
        if (isinstance(data, dict) and part in data) or _is_place(part, data):
            data = data[part]
            parts.append(part)
    if problem["type"] == "missing":
        parts.append(problem["loc"][-1])
    return ".".join(map(str, parts))


def _is_place(part: Any, data: Any) -> bool:
    """Whether a list has something at this place; where an entry is missing, it has not."""
    return isinstance(data, list) and isinstance(part, int) and part < len(data)
