"""Every page of the documentation is linked from the index of its folder, and the glossary is in order."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]


def linked_from(page: Path) -> set[Path]:
    targets = re.findall(r"\]\(([^)#\s:]+)(?:#[^)]*)?\)", page.read_text("utf-8"))
    return {(page.parent / target).resolve() for target in targets}


def test_every_page_is_linked_from_the_index_of_its_folder() -> None:
    index, theory = (ROOT / folder / "README.md" for folder in ("docs", "docs/theory"))
    reached = linked_from(index) | linked_from(theory) | {index}
    pages = {page for page in (ROOT / "docs").rglob("*.md") if not page.name.endswith(".in.md")}
    pages |= {ROOT / "experiments" / name for name in ("README.md", "REPORT.md")}
    assert pages - reached == set()
    assert theory in linked_from(index)


def test_glossary_is_in_alphabetical_order_and_every_word_once() -> None:
    words = re.findall(r"^\*\*(.+?)\*\*:", (ROOT / "docs" / "glossary.md").read_text("utf-8"), re.MULTILINE)
    assert len(words) > 30
    assert words == sorted(words, key=str.lower)
    assert len(set(words)) == len(words)
