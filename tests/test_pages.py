"""The pages that are printed from declarations are what the declarations say now."""

import re
import runpy
from dataclasses import fields
from pathlib import Path

import pytest

from drawbar.signals import Command, Measurement

DOCS = Path(__file__).parents[1] / "docs"
PAGES = runpy.run_path(str(DOCS / "pages.py"))["PAGES"]


@pytest.mark.parametrize("page", list(PAGES))
def test_a_printed_page_is_up_to_date(page):
    written = (DOCS / page).read_text("utf-8")
    assert written == PAGES[page](), "run python docs/pages.py"


@pytest.mark.parametrize("page", list(PAGES))
def test_every_field_and_code_has_words(page):
    for line in PAGES[page]().split("\n"):
        assert not line.startswith("{"), line
        assert not line.startswith("    "), f"a block of code: {line}"
        assert not re.search(r"\| +(\(\w+\) +)?\|$", line), f"an empty cell: {line}"


def test_the_page_for_labview_has_every_function_and_cluster_of_the_headers():
    written, generated = (
        (DOCS / "labview.md").read_text("utf-8"),
        runpy.run_path(str(DOCS / "labview_page.py"))["page"](),
    )
    assert written == generated, "run python docs/labview_page.py"
    header = (DOCS.parent / "src/drawbar/step/public/drawbar.h").read_text("utf-8")
    functions = re.findall(r"(drawbar_\w+)\(", "".join(re.findall(r"^DRAWBAR_API .*", header, re.MULTILINE)))
    assert len(functions) > 12
    assert [name for name in functions if f"**{name}**" not in written] == []
    for kind, count in ((Measurement, 28), (Command, 4)):
        names = re.findall(
            r"(\w+) (?:DBL|I32)", written.split(f"**drawbar_{kind.__name__.lower()}**")[1].split("\n")[0]
        )
        assert names == [field.name for field in fields(kind)]
        assert len(names) == count
