"""Write docs/configuration.md from the declarations of the settings: python docs/configuration_page.py."""

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
    """Return the page, Markdown."""
    return _HEAD + "".join(_section(section) for section in sections())


def _section(section: Section) -> str:
    title = f"`[{section.name}]`" if section.name else "Outside of all sections"
    variant = f" with `{section.variant}`" if section.variant else ""
    rows = "".join(_row(key) for key in section.keys)
    return (
        f"\n## {title}{variant}\n\n{section.meaning}\n\n"
        f"| key | default | unit | allowed | meaning |\n|---|---|---|---|---|\n{rows}"
    )


def _row(key: Key) -> str:
    name = key.name.rpartition(".")[2]
    default = f"`{key.default}`" if key.default else "must be given"
    cells = (f"`{name}`", default, key.unit, key.allowed, key.meaning)
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |\n"


if __name__ == "__main__":
    PAGE.write_text(page(), "utf-8")
