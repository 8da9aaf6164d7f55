"""Fields page: choose a line and a pass on the map, see what was smoothed of it, and take it for the next drive."""

import asyncio
import json
import math
import shlex
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from nicegui import background_tasks, ui

from drawbar.console.audit import Audit
from drawbar.console.exchange_card import ExchangeCard
from drawbar.console.field_map import FieldMap
from drawbar.console.language.words import Words
from drawbar.console.link import Link
from drawbar.console.new_line_card import NewLineCard
from drawbar.console.next_drive import NextDrive
from drawbar.console.page_head import PageHead, tell
from drawbar.console.thinning import kept_points
from drawbar.console.visitors import Visitor
from drawbar.console.widgets import button, card
from drawbar.errors import DrawbarError, PathError
from drawbar.fields.field import Field, FieldLine
from drawbar.fields.formats import geojson
from drawbar.fields.lines import on_earth, on_plane
from drawbar.fields.planning import PlannedPass, plan_pass
from drawbar.geometry import Floats
from drawbar.simulation import build_path

_TOLERANCE, _POINTS = 0.005, 8000
"""m by which what is driven may be drawn off its place, as long as it takes no more points"""
_OTHERS_TOLERANCE, _OTHERS_POINTS = 0.1, 60_000
"""the same of the lines that may be chosen, all together"""
_NEAR = 5000.0
"""from its first point, within which a new line belongs to a field, m"""
_FAR = 2000.0
"""from the tractor, from which on the distance of a line is shown, m"""
_TEXTS = ("field_map", "zoom_in", "zoom_out", "whole")


class FieldsPage:
    """The page of one browser."""

    def __init__(
        self, next_drive: NextDrive, link: Link, visitor: Visitor, words: Words, audit: Audit, *, login: bool
    ) -> None:
        """Build the page."""
        self._next_drive, self._link, self._visitor, self._words, self._audit = next_drive, link, visitor, words, audit
        self._field: Field | None = None
        self._planned: PlannedPass | None = None
        self._wanted, self._plans, self._loads = 0, False, False
        self._line_wanted = ""
        self._tracked = 0  # points of the recorded curve that are drawn
        self._head = PageHead(link, visitor, words, words("fields"), login=login)
        with ui.element("div").classes("page wide"), ui.element("div").classes("columns"):
            with ui.element("div").classes("left"):
                self._map = FieldMap({key: words(key) for key in _TEXTS}, self._choose)
            with ui.element("div"):
                self._build_choice()
                if visitor.may_drive:
                    self._new_line = NewLineCard(link, words, self._keep_line)
                    ExchangeCard(next_drive, words, lambda: self._field, self._take_in)
        names = next_drive.fields.names()
        self._show_field(names[0] if names else None)

    def refresh(self) -> None:
        """Show where the tractor is, and what is being recorded."""
        self._head.refresh()
        self._take.set_enabled(self._may_take())
        if self._visitor.may_drive:
            self._new_line.refresh()
        if self._map.may_draw:
            self._show_place()

    def _show_place(self) -> None:
        """Draw where the tractor is, and the curve that is being recorded as far as it is new."""
        place, track = self._link.surveyor.place, self._link.surveyor.track
        at = self._moved([place[:2]])[0].tolist() if place is not None else None
        yaw = place[2] if place is not None and math.isfinite(place[2]) else None
        points = track.points if track is not None else []
        fresh = None
        if len(points) != self._tracked:
            self._tracked = len(points)
            moved = self._moved(points)
            fresh = _rounded(moved, _TOLERANCE, _POINTS)
        self._map.place([*at, yaw] if at is not None else None, fresh)

    def _moved(self, points: Sequence[tuple[float, float]]) -> Floats:
        """Return points of the drive's frame, m, in the field's, (n, 2) m."""
        field = self._field
        frame = self._next_drive.frame if field is None or field.is_empty else field.frame()
        return on_plane(on_earth(np.reshape(points, (-1, 2)), self._next_drive.frame), frame)

    def _build_choice(self) -> None:
        words = self._words
        with card(words("line_to_drive")):
            with ui.element("div").classes("line-up"):
                self._fields = ui.select([], label=words("field"), on_change=self._field_chosen).props("outlined")
                self._lines = ui.select([], label=words("line"), on_change=self._replan).props("outlined")
            with ui.element("div").classes("line-up"):
                self._number = self._figure("pass_number", 0, "", "%.0f")
                self._width = self._figure("working_width", 3.0, "m", "%.2f")
                self._offset = self._figure("offset", 0, "cm", "%.0f")
            ui.label(words("pass_help")).classes("note")
            self._summary = ui.label().classes("note")
            self._flaw = ui.label().classes("flaw").props("role=alert")
            self._take = button(words("take_line"), self._take_line, "action main")

    def _figure(self, key: str, value: float, unit: str, shape: str) -> ui.number:
        return ui.number(
            self._words(key), value=value, suffix=unit or None, format=shape, on_change=self._replan
        ).props("outlined debounce=300")

    def _show_field(self, name: str | None, line: str = "") -> None:
        self._line_wanted = line
        self._fields.set_options(self._next_drive.fields.names(), value=name)
        self._field_chosen()

    def _field_chosen(self) -> None:
        self._loads = True
        self._replan()

    async def _load_field(self) -> None:
        """Read the field that is chosen now, and show it and its lines."""
        self._loads, name, store = False, self._fields.value, self._next_drive.fields
        try:
            self._field = await asyncio.to_thread(store.load, name) if name else None
        except DrawbarError as error:
            self._field = None
            with self._map.client:
                tell(self._words.message(error))
        self._tracked = -1  # in the frame of another field
        self._map.show_field(await asyncio.to_thread(_drawn_field, self._field))
        lines = [line.name for line in self._field.lines] if self._field is not None else []
        first = lines[0] if lines else None
        self._lines.set_options(lines, value=self._line_wanted if self._line_wanted in lines else first)
        self._line_wanted = ""

    def _choose(self, name: str) -> None:
        if self._field is not None and any(line.name == name for line in self._field.lines):
            self._lines.set_value(name)

    def _replan(self) -> None:
        """Plan the chosen pass, and draw it, as soon as that is computed."""
        self._wanted += 1
        self._planned = None
        self._take.set_enabled(False)
        if not self._plans:
            self._plans = True
            background_tasks.create(self._plan_newest())

    async def _plan_newest(self) -> None:
        """Plan in a thread, which must not hold up the pictures of those who drive, until nothing newer is wanted."""
        try:
            while True:
                self._summary.set_text(self._words("planning"))
                if self._loads:
                    await self._load_field()
                wanted, planned, drawn, flaw = self._wanted, None, _drawn_plan(None), ""
                try:
                    if self._field is not None and self._lines.value:
                        planned = await asyncio.to_thread(self._plan(self._field, self._lines.value))
                        drawn = await asyncio.to_thread(_drawn_plan, planned)
                except DrawbarError as error:
                    flaw = self._words.message(error)
                if wanted == self._wanted:
                    break
        finally:
            self._plans = False
        self._planned = planned
        self._flaw.set_text(flaw)
        self._summary.set_text(self._said())
        self._take.set_enabled(self._may_take())
        self._map.show_plan(drawn)

    def _plan(self, field: Field, line: str) -> Callable[[], PlannedPass]:
        """Return what plans the pass that is chosen now; raises PathError."""
        numbers = [each.value for each in (self._number, self._width, self._offset)]
        if any(each is None for each in numbers):
            raise PathError(self._words("number_missing"))
        configuration = self._next_drive.configuration
        return partial(
            plan_pass,
            field,
            line,
            round(numbers[0]),
            configuration.guidance.line_limits(configuration.vehicle.curvature_limit),
            width=float(numbers[1]),
            offset=float(numbers[2]) / 100.0,
        )

    def _said(self) -> str:
        if self._planned is None:
            return self._words("no_field") if self._field is None else ""
        length = f"{self._planned.drivable.path.length:.0f}"
        centimetres = self._words.number(100.0 * self._planned.largest, 0)
        limit = self._words.number(100.0 * self._next_drive.configuration.guidance.path_tolerance, 0)
        key = "smoothed_marked" if self._planned.deviating else "smoothed"
        return f"{self._words(key, length=length, most=centimetres, limit=limit)} {self._distance()}".strip()

    def _distance(self) -> str:
        """Show how far away the tractor is where that is surprising: another field's line is easily chosen."""
        place = self._link.surveyor.place
        if place is None or self._field is None or self._planned is None:
            return ""
        here = on_plane(on_earth(np.array([place[:2]]), self._next_drive.frame), self._field.frame())
        metres = float(np.hypot(*(self._planned.drivable.recorded - here).T).min())
        return self._words("far_away", km=f"{metres / 1e3:.0f}") if metres > _FAR else ""

    def _may_take(self) -> bool:
        return self._planned is not None and self._visitor.may_drive and not self._link.is_engaged

    async def _take_line(self) -> None:
        """Save the chosen pass, and a configuration that drives it, for the next drive."""
        if self._planned is None or self._field is None or not self._visitor.may_drive:
            return
        next_drive, line = self._next_drive, self._planned.line
        points = on_earth(np.column_stack([line.x, line.y]), self._field.frame())
        file = next_drive.versions.next_file(next_drive.configuration.name, ".geojson")
        taken = FieldLine(name=line.name, points=points)
        field = Field(name=self._field.name, lines=(taken,), boundary=self._field.boundary)
        content = await asyncio.to_thread(geojson.write, field)
        changes = {"path.file": str(file), "path.track": line.name, "path.working_width": float(self._width.value)}
        try:
            changed = next_drive.changed([f"{key}={json.dumps(value)}" for key, value in changes.items()])
            next_drive.versions.write(file, content)
            try:
                await asyncio.to_thread(build_path, changed)
                saved = next_drive.save(changed, engaged=lambda: self._link.is_engaged)
            except DrawbarError:
                file.unlink()
                raise
        except DrawbarError as error:
            self._flaw.set_text(self._words.message(error))
            return
        self._audit.write(self._visitor, "TAKE_LINE", file=str(saved), line=line.name)
        tell(self._words("saved_for_next", file=shlex.quote(str(saved))), good=True)

    def _keep_line(self, name: str, points: Floats) -> None:
        """Keep a new line, (n, 2) m of the drive's frame, in the field that is shown; in a new one if that is far."""
        next_drive = self._next_drive
        degrees = on_earth(points, next_drive.frame)
        if self._field is None or not _is_near(self._field, degrees):
            kept = next_drive.fields.add(Field(name=self._words("new_field"), lines=()))
            self._field = Field(name=kept)
        line = next_drive.fields.add_line(self._field.name, FieldLine(name=name, points=degrees))
        self._audit.write(self._visitor, "NEW_LINE", field=self._field.name, line=line)
        tell(self._words("line_kept", line=line, field=self._field.name), good=True)
        self._show_field(self._field.name, line)

    async def _take_in(self, fields: tuple[Field, ...]) -> None:
        """Keep imported fields, and show the first."""
        names = [await asyncio.to_thread(self._next_drive.fields.add, field) for field in fields]
        self._audit.write(self._visitor, "IMPORT", fields=names)
        self._show_field(names[0])


def _is_near(field: Field, degrees: Floats) -> bool:
    return field.is_empty or float(np.abs(on_plane(degrees[:1], field.frame())).max()) <= _NEAR


def _drawn_field(field: Field | None) -> dict[str, Any]:
    """Return what is drawn of a field, m of its own frame."""
    if field is None or field.is_empty:
        return {"boundary": [], "lines": []}
    frame, most = field.frame(), max(_OTHERS_POINTS // max(len(field.lines), 1), 2)
    lines = [
        {"name": line.name, "points": _rounded(on_plane(line.points, frame), _OTHERS_TOLERANCE, most)}
        for line in field.lines
    ]
    ring = on_plane(field.boundary, frame) if field.boundary is not None else np.empty((0, 2))
    return {"boundary": _rounded(ring, _TOLERANCE, _POINTS), "lines": lines}


def _drawn_plan(planned: PlannedPass | None) -> dict[str, Any]:
    """Return what is drawn of the chosen pass: as it was recorded, as it will be driven, and where these deviate."""
    if planned is None:
        return {"chosen": [], "driven": [], "deviating": []}
    drivable = planned.drivable
    return {
        "chosen": _rounded(drivable.recorded, _TOLERANCE, _POINTS),
        "driven": _rounded(drivable.path.nodes[:, 1:3], _TOLERANCE, _POINTS),
        "deviating": [_rounded(piece, _TOLERANCE, _POINTS) for piece in planned.deviating],
    }


def _rounded(points: Floats, tolerance: float, most: int) -> list[Any]:
    rounded: list[Any] = np.round(points[kept_points(points, tolerance, most)], 3).tolist()
    return rounded
