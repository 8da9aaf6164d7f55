"""Page about a run, report.html: self-contained, drawn by plotly.js without any network."""

from collections.abc import Iterable, Iterator, Sequence
from html import escape
from importlib import resources
from string import Template

import msgspec
from plotly.offline import get_plotlyjs  # type: ignore[import-untyped]

from drawbar.recording.drive_events import DriveEvent
from drawbar.recording.encoding import encode_special
from drawbar.recording.log import Columns
from drawbar.report import style
from drawbar.report.columns import along, leads_on, span_along, track
from drawbar.report.decimation import thinned
from drawbar.report.events import event_rows
from drawbar.report.metrics import Metrics
from drawbar.report.path_errors import Bodies, PathErrors
from drawbar.report.sections import Section, all_sections
from drawbar.report.shadow import Shadow, ShadowMetrics
from drawbar.report.tables import (
    ERROR_COLUMNS,
    TIME_COLUMNS,
    Row,
    body_rows,
    counted,
    error_name,
    error_rows,
    key_figures,
    origin,
    refusal_rows,
    shadow_texts,
    time_rows,
)


def _row(tag: str, name: str, cells: list[str]) -> str:
    inner = "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in [name, *cells])
    return f"<tr>{inner}</tr>"


def _table(groups: str, head: str, rows: list[Row], shown: str = "") -> str:
    """Return a table; `shown`: class of one that is not on every screen."""
    body = "".join(_row("td", name, cells) for name, cells in rows)
    return f'<div class="table {shown}"><table><thead>{groups}{head}</thead><tbody>{body}</tbody></table></div>'


def _body_heads(span: int, bodies: Iterable[str] = style.BODY_COLOURS) -> str:
    heads = [f'<th class="{body}" colspan="{span}">{body}</th>' for body in bodies]
    return f"<tr><th></th>{''.join(heads)}</tr>"


def _error_tables(metrics: Metrics) -> Iterator[str]:
    """Yield the errors of both bodies in one table, and, for a narrow screen, in one for each."""
    columns, rows, title = list(ERROR_COLUMNS), error_rows(metrics), f"{error_name(metrics).capitalize()}, cm"
    count = len(columns)
    yield _table(_body_heads(count), _row("th", title, [*columns, *columns]), rows, "wide")
    for place, body in enumerate(style.BODY_COLOURS):
        own = [(name, cells[place * count : (place + 1) * count]) for name, cells in rows]
        yield _table(_body_heads(count, [body]), _row("th", title, columns), own, "narrow")


def _tables(metrics: Metrics) -> str:
    of_bodies = [*_error_tables(metrics)] if error_rows(metrics) else []
    if rows := body_rows(metrics):
        of_bodies.append(_table(_body_heads(1), "", rows))
    of_solvers = _table("", _row("th", "Solver, µs", list(TIME_COLUMNS)), time_rows(metrics))
    return "".join(f"<div>{''.join(column)}</div>" for column in (of_bodies, [of_solvers]) if column)


def _section_html(section: Section) -> str:
    kind = "figure map" if section.name in ("map", "scene") else "figure"
    heading = f"<h2>{escape(section.title)}</h2><p>{escape(section.note)}</p>"
    return f'<section>{heading}<div class="{kind}" id="{section.name}"></div></section>'


def _page_data(log: Columns, sections: list[Section]) -> str:
    shown = thinned(log.steps)
    data = {
        "figures": {section.name: section.figure for section in sections},
        "along": [section.name for section in sections if section.along_path],
        "time": log.column("measurement.time")[shown].round(3),
        "progress": along(log, "tractor")[shown].round(2),
        "over": "distance" if leads_on(log) else "time",
        "span": span_along(log),
        "tracks": {body: track(log, body)[shown].round(3) for body in style.BODY_COLOURS},
    }
    text = msgspec.json.encode(data, enc_hook=encode_special)
    return text.replace(b"</", b"<\\/").decode()  # a closing tag inside a string would end the script


def _events(rows: list[Row]) -> str:
    """Return the section of what happened in a drive; a run in simulation has none."""
    if not rows:
        return ""
    table = _table("", _row("th", "Since the start", ["What", "What to do"]), rows, "events")
    return f'<section id="events"><h2>What happened</h2>{table}</section>'


def _shadow(shadow: ShadowMetrics | None) -> str:
    """Return the section of what would have been done; other runs have none."""
    if shadow is None:
        return ""
    told = "".join(f"<p>{escape(text[0].upper() + text[1:])}.</p>" for text in shadow_texts(shadow))
    rows = refusal_rows(shadow)
    table = _table("", _row("th", "For", ["What stood against engaging", "What to do"]), rows, "events") if rows else ""
    return f'<section id="shadow"><h2>What drawbar would have done</h2>{told}{table}</section>'


def render_page(
    log: Columns,
    metrics: Metrics,
    errors: Bodies[PathErrors],
    events: Sequence[DriveEvent] = (),
    shadow: Shadow | None = None,
) -> str:
    """Return the whole page as HTML; events: of a drive; shadow: of one at which drawbar only looked on."""
    sections = all_sections(log, errors, shadow)
    started = f"{log.header.started:%d %B %Y, %H:%M %Z}"
    template = Template(resources.files(__package__).joinpath("page.html").read_text(encoding="utf-8"))
    tiles = [f'<div class="tile"><b>{escape(v)}</b><span>{escape(k)}</span></div>' for k, v in key_figures(metrics)]
    ending = "Finished" if metrics.finished else "Stopped before the end"
    return template.substitute(
        kind="shadow drive"
        if shadow is not None
        else "drive"
        if events or (log.steps and metrics.error_estimated)
        else "run",
        title=escape(f"{log.header.path_name}, {metrics.config}"),
        facts=escape(f"{started} · configuration {origin(metrics, ' · ')} · {counted(log.steps, 'step')}"),
        note=escape(log.header.path_note),
        state="" if metrics.finished else "stopped",
        outcome=escape("; ".join([f"{ending}: {metrics.outcome}", *metrics.losses])),
        tiles="".join(tiles),
        tables=_tables(metrics),
        events=_shadow(metrics.shadow) + _events(event_rows(events)),
        sections="\n".join(_section_html(section) for section in sections),
        configuration=escape(log.header.configuration),
        plotly=get_plotlyjs(),
        data=_page_data(log, sections),
        font=style.FONT,
        tractor=style.TRACTOR,
        trailer=style.TRAILER,
    )
