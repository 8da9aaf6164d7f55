"""The report on a phone, in a real browser."""

import pytest
from chromium import LONGEST, open_chromium

from drawbar.report.metrics import compute_metrics
from drawbar.report.page import render_page
from drawbar.report.path_errors import true_path_errors
from drawbar.report.tables import error_rows

PHONE = {"width": 360, "height": 740}
ALL_DRAWN = "document.querySelectorAll('.figure .xtitle').length === document.querySelectorAll('.figure').length"
OVERLAPS = """Array.from(document.querySelectorAll('.figure'), figure => {
  const [title, legend] = ['.xtitle', '.legend'].map(part => figure.querySelector(part)?.getBoundingClientRect());
  return legend && legend.top < title.bottom && title.top < legend.bottom ? figure.id : null;
}).filter(Boolean)"""

LEGENDS_BELOW = """Array.from(document.querySelectorAll('.figure'), figure => {
  const [title, legend] = ['.xtitle', '.legend'].map(part => figure.querySelector(part).getBoundingClientRect());
  return legend.top > title.top;
}).filter(Boolean).length"""

COVERED = """Array.from(document.querySelectorAll('.figure'), figure => {
  const buttons = figure.querySelector('.modebar')?.getBoundingClientRect();
  return buttons && Array.from(figure.querySelectorAll('.annotation'), label => label.getBoundingClientRect())
    .some(label => label.top < buttons.bottom && buttons.left < label.right) ? figure.id : null;
}).filter(Boolean)"""

GAPS = """Array.from(document.querySelectorAll('.table tr'), row => {
  const texts = Array.from(row.cells).filter(cell => cell.offsetParent && cell.textContent).map(cell => {
    const range = document.createRange();
    range.selectNodeContents(cell);
    return range.getBoundingClientRect();
  });
  return texts.slice(1).map((text, place) => text.left - texts[place].right);
}).flat()"""


@pytest.fixture(scope="module")
def phone(run, tmp_path_factory):
    errors = true_path_errors(run)
    report = tmp_path_factory.mktemp("report") / "report.html"
    report.write_text(render_page(run, compute_metrics(run, errors), errors), "utf-8")
    with open_chromium() as browser:
        page = browser.new_page(viewport=PHONE)
        page.goto(report.as_uri(), timeout=1e3 * LONGEST)
        page.wait_for_function(ALL_DRAWN, timeout=1e3 * LONGEST)
        yield page


def test_no_column_is_cut_off(phone):
    widths = phone.evaluate("Array.from(document.querySelectorAll('.table'), t => [t.scrollWidth, t.clientWidth])")
    assert widths
    assert all(needed <= shown for needed, shown in widths)
    assert phone.evaluate("document.documentElement.scrollWidth") == PHONE["width"]


def test_columns_stand_apart(phone):
    gaps = phone.evaluate(GAPS)
    assert len(gaps) > 50
    assert min(gaps) >= 7.0


def test_every_error_is_shown_once(phone, run):
    metrics = compute_metrics(run, true_path_errors(run))
    shown = phone.evaluate("Array.from(document.querySelectorAll('.table'), table => table.innerText).join('\\n')")
    rows = [line.split("\t") for line in shown.splitlines()]
    for name, cells in error_rows(metrics):
        assert [row[1:] for row in rows if row[0] == name] == [cells[:5], cells[5:]]


def test_legends_lie_beside_the_title_of_the_axis(phone):
    assert phone.evaluate(OVERLAPS) == []


def test_buttons_cover_no_label_of_a_curve(phone):
    assert phone.evaluate("document.querySelectorAll('.figure .modebar').length") > 5
    assert phone.evaluate("document.querySelectorAll('.figure .annotation').length") > 5
    assert phone.evaluate(COVERED) == []


def test_legends_stay_beside_when_the_phone_is_turned(phone):
    for size, below in (({"width": 740, "height": 360}, 0), (PHONE, phone.locator(".figure").count())):
        phone.set_viewport_size(size)
        phone.wait_for_function(f"{LEGENDS_BELOW} === {below}", timeout=1e3 * LONGEST)
        assert phone.evaluate(OVERLAPS) == []
