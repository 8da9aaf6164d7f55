"""Write docs/configuration.md from the declarations of the settings: python docs/configuration_page.py."""

import re
from pathlib import Path

from drawbar.report.keys import Key, Section, sections

PAGE = Path(__file__).with_name("configuration.md")
_HEAD = """\
# Configuration: every key

One TOML file describes a run. A file may begin with `extends = "articulated"` (a shipped name or a file beside it) and
give only what differs; `--set KEY=VALUE` changes single values. `drawbar config NAME` prints the keys with the values
of a configuration, `drawbar config NAME --toml` the whole file, `drawbar events` what may be put into
`machine.events`.

Every number is 0, or of a magnitude from 1e-12 to 1e9, whatever else is allowed.

This page is made from the code by `python docs/configuration_page.py`; "list of number" means a TOML list, "table of
number" a TOML table with names of your own.
"""


def page() -> str:
    """Return the page, Markdown; a table that stands above already is not repeated."""
    text, first = _HEAD, dict[str, Section]()
    for section in sections():
        body = _body(section)
        above = first.setdefault(body, section)
        text += f"\n## {_title(section)}\n\n" + (body if above is section else f"As {_link(above)}.\n")
    return text


def _title(section: Section) -> str:
    title = f"`[{section.name}]`" if section.name else "Outside of all sections"
    return title + (f" with `{section.variant}`" if section.variant else "")


def _link(section: Section) -> str:
    """Return a link to a section's heading, of which GitHub keeps letters, digits, spaces, - and _."""
    title = _title(section)
    place = re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")
    return f"[{title}](#{place})"


def _body(section: Section) -> str:
    rows = "".join(map(_row, section.keys))
    return f"{section.meaning}\n\n| key | default | unit | allowed | meaning |\n|---|---|---|---|---|\n{rows}"


def _row(key: Key) -> str:
    name = key.name.rpartition(".")[2]
    default = f"`{key.default}`" if key.default else "must be given"
    cells = (f"`{name}`", default, key.unit, key.allowed, key.meaning)
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |\n"


if __name__ == "__main__":
    PAGE.write_text(page(), "utf-8")
