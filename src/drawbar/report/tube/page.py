"""Page of both tubes: tube.html, self-contained, and the picture of each as an SVG file beside it."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

import numpy as np

from drawbar.config import Configuration
from drawbar.control.tube.tube import SubsystemTube
from drawbar.errors import DrawbarError
from drawbar.report import style
from drawbar.report.tables import Row
from drawbar.report.tube.picture import WIDTH, render_tube
from drawbar.report.tube.recorded import Recording
from drawbar.report.tube.tables import (
    SET_COLUMNS,
    bound_columns,
    bound_rows,
    law_text,
    set_rows,
    unbounded_text,
    undeclared_text,
)

PAGE_NAME = "tube.html"
_LOOK = f"""body{{font:15px/1.45 {style.FONT};color:{style.INK}}}
body{{max-width:{WIDTH:.0f}px;margin:32px auto;padding:0 16px}}
h2{{margin-top:40px}} td,th{{padding:3px 14px 3px 0;text-align:right}} td:first-child,th:first-child{{text-align:left}}
table{{border-collapse:collapse;margin:12px 0}} tr{{border-bottom:1px solid {style.GRID}}} pre{{white-space:pre-wrap}}
svg{{max-width:100%;height:auto}} .empty{{color:#B00020;font-weight:600}} .wide{{overflow-x:auto}}
@media(max-width:600px){{svg{{max-width:none}} table{{font-size:13px}} td,th{{padding-right:8px}}}}
@media(max-width:600px){{td:not(:first-child){{white-space:nowrap}}}}"""
"""on a phone, pictures are as large as they are, and what is too wide scrolls by itself"""


_INTRODUCTION = """<p>A controller plans as if nothing disturbed the vehicle. What does disturb it, and errors of the
estimate, carry the vehicle away from the plan, and a simple feedback, the law K, brings it back. If every disturbance
stays within the bound that was declared for it, the distance between vehicle and plan stays within a set around the
plan: the tube. This page shows the tube of each body and what it costs: the feedback needs a part of the steering, so
that the plan may use only the rest.</p>
<ul><li>The picture: the tube seen along two quantities at a time. Dots, where a run was given, are recorded errors; one
that lies outside contradicts a declared bound.</li>
<li>The first table: how wide the tube is, to either side of the plan.</li>
<li>The second table: each limit of the machine, what every disturbance takes of it, and what is left for the plan.
"Nothing" means that this controller cannot promise to stay within the limit; what to change stands below the
table.</li></ul>"""
_SET_NOTE = """Seen error: of the estimate against the plan, which the law acts on. True error: of the vehicle itself.
Excess: by how much the computed set is larger than the smallest that there is."""
_BOUNDS_NOTE = "A row with – is what its source takes of the limit; sources have the names of the section [tube]."


def write_page(
    folder: Path,
    configuration: Configuration,
    tubes: Mapping[str, SubsystemTube],
    advice: Mapping[str, Sequence[str]],
    recorded: Mapping[str, Sequence[Recording]],
) -> Path:
    """Write the page and the pictures into the folder; return the page's file.

    Raises:
        DrawbarError: the folder cannot be written.
    """
    pictures = {name: _picture(tube, recorded[name]) for name, tube in tubes.items() if tube.invariant_set is not None}
    sections = "".join(_section(name, tube, advice[name], pictures.get(name, "")) for name, tube in tubes.items())
    heading = f"Tubes of {configuration.name}"
    page = (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f'<meta name="viewport" content="width=device-width,initial-scale=1"><title>{escape(heading)}</title>'
        f"<style>{_LOOK}</style></head><body><h1>{escape(heading)}</h1>"
        f"<p>Nominal state {escape(configuration.tube.nominal)}, set speed {configuration.speed:g} m/s.</p>"
        f"{_INTRODUCTION}{sections}</body></html>\n"
    )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, picture in pictures.items():
            (folder / f"tube-{name}.svg").write_text(picture, "utf-8")
        (folder / PAGE_NAME).write_text(page, "utf-8")
    except OSError as error:
        raise DrawbarError(f"{folder}: cannot be written ({error.strerror}); choose another --out folder.") from error
    return folder / PAGE_NAME


def _picture(tube: SubsystemTube, recorded: Sequence[Recording]) -> str:
    return render_tube(tube, np.vstack([np.zeros((0, len(tube.gain))), *(one.deviations for one in recorded)]))


def _section(name: str, tube: SubsystemTube, advice: Sequence[str], picture: str) -> str:
    parts = [f"<h2>{escape(name.capitalize())}</h2><pre>{escape(law_text(tube))}</pre>{_wide(picture)}"]
    if tube.invariant_set is not None:
        parts += [_table("Set", SET_COLUMNS, set_rows(tube)), f"<p>{_SET_NOTE}</p>"]
        parts += [_table("Bounds", bound_columns(tube), bound_rows(tube)), f"<p>{_BOUNDS_NOTE}</p>"]
    parts += [f'<p class="empty">{escape(text)}</p>' for text in advice]
    parts += [f"<p>{escape(note)}</p>" for note in (unbounded_text(tube), undeclared_text(tube)) if note]
    return "".join(parts)


def _table(head: str, columns: Sequence[str], rows: Sequence[Row]) -> str:
    lines = [_row("th", head, columns), *(_row("td", name, cells) for name, cells in rows)]
    return _wide(f"<table>{''.join(lines)}</table>")


def _wide(content: str) -> str:
    return f'<div class="wide">{content}</div>'


def _row(tag: str, name: str, cells: Sequence[str]) -> str:
    return f"<tr>{''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in (name, *cells))}</tr>"
