"""Numbers of the configuration in the names and units of the set-up page: what is changed, and what is wrong. Pure."""

import math
import re

from drawbar.config import Configuration
from drawbar.console.language.words import Words
from drawbar.console.set_up_values import GROUPS, RADIUS, SetUpValue
from drawbar.console.versions import changes_between
from drawbar.settings import FASTEST, LONGEST

_LINE = re.compile(r"  (?P<key>[\w.]+) = \S+: (?P<reason>.*)\.")
_BOUND = re.compile(r"must be (greater than or equal to|greater than|less than or equal to|less than) (\S+)")
_TEXTS = {
    "greater than or equal to": "flaw_least",
    "greater than": "flaw_greater",
    "less than or equal to": "flaw_most",
    "less than": "flaw_less",
}
_TOO_LARGE = re.compile(r"\S+ is not an? (length|angle|speed) .*")
_MOST = {"length": LONGEST, "angle": math.pi, "speed": FASTEST}
_VALUES = {value.key: value for _, values in GROUPS for value in values}


def flaws(error: str, words: Words) -> str:
    """Return what is wrong, a line each, of the error by which a configuration refuses it."""
    head, *lines = error.split("\n")
    return "\n".join(_flaw(line, words) for line in lines) or words.message(head)


def changes(before: Configuration, after: Configuration, words: Words) -> str:
    """Return what is changed, a line each; empty: nothing is."""
    lines = []
    for key, old, new in changes_between(before, after):
        if value := _VALUES.get(key):
            old, new = (shown_number(value, value.found(each), words) for each in (before, after))
        lines.append(f"{shown_name(value, words) if value else key}: {old} → {new}")
    return "\n".join(lines)


def shown_name(value: SetUpValue, words: Words) -> str:
    """Return how the page calls a number."""
    return f"{value.letter}  {words(value.text)}".strip()


def shown_number(value: SetUpValue, number: float, words: Words) -> str:
    """Return a number of the configuration as the page shows it, with its unit."""
    text = words.number(value.unit.from_si(number), value.unit.decimals)
    decimals = text.rstrip("0").rstrip(".,") if re.search("[.,]", text) else text
    return f"{decimals} {value.unit.name}"


def _flaw(line: str, words: Words) -> str:
    found = _LINE.fullmatch(line)
    value = _VALUES.get(found["key"]) if found else None
    if found is None or value is None:
        return words.message(line).strip()
    name, reason = shown_name(value, words), found["reason"]
    if value.unit is RADIUS:  # of a curvature, whose bounds are those of no radius
        return words("flaw_greater", name=name, bound=f"0 {RADIUS.name}")
    if bound := _BOUND.fullmatch(reason):
        return words(_TEXTS[bound[1]], name=name, bound=shown_number(value, float(bound[2]), words))
    if large := _TOO_LARGE.fullmatch(reason):
        return words("flaw_most", name=name, bound=shown_number(value, _MOST[large[1]], words))
    if reason == "must be a finite number":
        return words("flaw_number", name=name)
    return f"{name}: {words.message(reason)}"
