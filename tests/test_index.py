"""Every page of the documentation is reachable from its one index, and the glossary is in order."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]


def linked_from(page: Path) -> set[Path]:
    targets = re.findall(r"\]\(([^)#\s:]+)(?:#[^)]*)?\)", page.read_text("utf-8"))
    return {(page.parent / target).resolve() for target in targets}


def test_index_links_every_page() -> None:
    reached = linked_from(ROOT / "docs" / "README.md") | {(ROOT / "docs" / "README.md").resolve()}
    pages = {page.resolve() for page in (ROOT / "docs").rglob("*.md") if not page.name.endswith(".in.md")}
    pages |= {(ROOT / "experiments" / name).resolve() for name in ("README.md", "REPORT.md")}
    assert {page.relative_to(ROOT) for page in pages - reached} == set()


def test_glossary_is_in_alphabetical_order_and_every_word_once() -> None:
    words = re.findall(r"^\*\*(.+?)\*\*:", (ROOT / "docs" / "glossary.md").read_text("utf-8"), re.MULTILINE)
    assert len(words) > 30
    assert words == sorted(words, key=str.lower)
    assert len(set(words)) == len(words)
