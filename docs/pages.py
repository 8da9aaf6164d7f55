"""Print the pages that are made of declarations: python docs/pages.py writes docs/messages.md and docs/safety.md anew.

What stands in them besides tables is docs/safety.in.md, in which a line such as `{causes}` is replaced.
"""

import inspect
import math
from dataclasses import is_dataclass
from enum import Enum
from pathlib import Path
from typing import get_type_hints

from pydantic import BaseModel

from drawbar import messages
from drawbar.declared_words import declared_words
from drawbar.messages import KINDS, Message, records
from drawbar.messages.records import LAYOUTS, MARK, VERSION, Flaw
from drawbar.safety.causes import Cause, Response
from drawbar.safety.engagement import TABLE
from drawbar.safety.settings import SafetySettings

DOCS = Path(__file__).parent
TYPES = {"B": ("u8", 1), "H": ("u16", 2), "I": ("u32", 4), "i": ("i32", 4), "Q": ("u64", 8), "d": ("f64", 8)}
TYPES["8H"] = ("u16 × 8", 16)
CHANNELS = """\
The controller's channel is a pair of Unix sockets that keep records apart (SOCK_SEQPACKET): commands and states of the
controller one way, states of the gate the other. Front ends and the recorder send to the gate's Unix datagram socket,
which only its user may write to: `gate` in the folder `drawbar-…` that each drive makes in the temporary folder (TMPDIR,
else /tmp). A front end binds a path of its own first, and whoever has sent an operator's message from there is sent every
state of the gate (16 at most). A record that is refused is counted, and why is one of:"""
ANSWERS = {
    Response.NONE: "",
    Response.NOTIFY: "notify, and drive on",
    Response.DEGRADE: "drive slower",
    Response.STOP: "stop, then release",
    Response.RELEASE: "release at once",
}


def record_table(kind: messages.Kind, cls: type[Message]) -> list[str]:
    """Return the table of one kind of record."""
    layout, words = LAYOUTS[kind], field_words(cls)
    lines = [
        f"## {kind.value}: {cls.__name__}",
        "",
        inspect.cleandoc(cls.__doc__ or ""),
        "",
        "| offset | type | field | meaning |",
    ]
    lines += ["|---|---|---|---|", f"| 0 | u16 | mark | {MARK:#06x} |", f"| 2 | u8 | version | {VERSION} |"]
    lines.append(f"| 3 | u8 | kind | {kind.value} |")
    offset = 4
    for name, cell, enumeration in layout.cells:
        kind_of, size = TYPES[cell.code]
        meaning = words[name] + (f" ({enumeration.__name__})" if enumeration else "")
        lines.append(f"| {offset} | {kind_of} | {name} | {meaning}{'; may be NaN' if cell.may_miss else ''} |")
        offset += size
    return [*lines, f"| {offset} | u32 | crc | CRC-32 of all before |", "", f"{layout.size} bytes."]


def field_words(cls: type) -> dict[str, str]:
    """Return what each field of a message means, of a part's as `part.field`."""
    words = declared_words(cls)
    parts = {name: hint for name, hint in get_type_hints(cls).items() if is_dataclass(hint)}
    return words | {f"{part}.{name}": text for part, hint in parts.items() for name, text in field_words(hint).items()}


def enumeration_table(cls: type[Enum]) -> list[str]:
    """Return the table of an enumeration."""
    words = declared_words(cls)
    lines = [
        f"### {cls.__name__}",
        "",
        inspect.cleandoc(cls.__doc__ or ""),
        "",
        "| value | name | meaning |",
        "|---|---|---|",
    ]
    return lines + [f"| {each.value} | {each.name} | {words[each.name]} |" for each in cls]


def messages_page() -> str:
    """Return docs/messages.md."""
    lines = ["# Messages between the processes of `drawbar drive`"]
    for module in (records, messages):
        lines += ["", *(inspect.getdoc(module) or "").split("\n")[2:]]
    lines += ["", *CHANNELS.split("\n"), ""]
    lines += [f"- `{flaw.name}`: {flaw.value}" for flaw in Flaw]
    for kind, cls in KINDS.items():
        lines += ["", *record_table(kind, cls)]
    lines += ["", "## Enumerations"]
    for enumeration in (messages.Mode, messages.SupervisorState, messages.Action, messages.Role):
        lines += ["", *enumeration_table(enumeration)]
    return "\n".join(lines) + "\n"


def causes_table() -> list[str]:
    """Return the table of all codes."""
    lines = [
        "| code | name | what is so | refuses to engage | while driving | what to do |",
        "|---|---|---|---|---|---|",
    ]
    for cause in Cause:
        refuses = "yes" if cause.refuses else ""
        answer = ANSWERS[cause.response]
        lines.append(f"| {cause.value} | {cause.name} | {cause.sentence} | {refuses} | {answer} | {cause.advice} |")
    return lines


def states_table() -> list[str]:
    """Return the table of states and events."""
    lines = ["| state | event → state |", "|---|---|"]
    for state, events in TABLE.items():
        ways = ", ".join(f"{event.name} → {after.name}" for event, after in events.items() if after is not state)
        lines.append(f"| {state.name} | {ways} |")
    return lines


def settings_table(model: type[BaseModel], before: str = "") -> list[str]:
    """Return the rows of all settings with their defaults."""
    rows, words = [], declared_words(model)
    for name, field in model.model_fields.items():
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            rows += settings_table(field.annotation, f"{before}{name}.")
            continue
        meaning, value = words.get(name, ""), field.default
        angle = isinstance(value, float) and (
            meaning.endswith("rad") or meaning.endswith("rad/s") or ", rad" in meaning
        )
        shown = f"{value:.4g} ({math.degrees(value):.3g}°)" if angle else str(value)
        rows.append(f"| `{before}{name}` | {shown} | {meaning} |")
    return rows


def safety_page() -> str:
    """Return docs/safety.md."""
    tables = {
        "{states}": states_table(),
        "{causes}": causes_table(),
        "{settings}": ["| setting | default | meaning |", "|---|---|---|", *settings_table(SafetySettings)],
    }
    lines: list[str] = []
    for line in (DOCS / "safety.in.md").read_text("utf-8").split("\n"):
        lines += tables.get(line, [line])
    return "\n".join(lines)


PAGES = {"messages.md": messages_page, "safety.md": safety_page}

if __name__ == "__main__":
    for page, text in PAGES.items():
        (DOCS / page).write_text(text(), "utf-8")
