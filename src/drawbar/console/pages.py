"""Pages: puts access control, login and pages into NiceGUI's application."""

import time
import traceback
from collections.abc import Mapping
from copy import copy
from pathlib import Path
from typing import Any, Protocol

from nicegui import app, core, ui
from nicegui.client import Client
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, RedirectResponse, Response

from drawbar.console.access_control import LOGIN, VISITOR, AccessControl
from drawbar.console.audit import Audit
from drawbar.console.drawing import Lines
from drawbar.console.drive_page import DrivePage
from drawbar.console.fields_page import FieldsPage
from drawbar.console.inside_page import InsidePage
from drawbar.console.language.words import Words, language_of
from drawbar.console.link import Link
from drawbar.console.login import Login
from drawbar.console.menu import ADDRESSES
from drawbar.console.next_drive import NextDrive
from drawbar.console.passwords import User
from drawbar.console.runs_page import MAP, REPORT, RunsPage, file_of
from drawbar.console.set_up_page import SetUpPage
from drawbar.console.visitors import Visitor, Visitors
from drawbar.driving.messaging.console_options import LOOPBACK, ConsoleOptions
from drawbar.realtime import say

_STATIC = Path(__file__).parent / "static"
_LANGUAGE = "drawbar-language"
_LEAVING = 5.0
"""within which a browser follows to the login, s; the page that it leaves is deleted then"""


class Page(Protocol):
    """A page that is open."""

    def refresh(self) -> None:
        """Show what is so now; called ten times a second."""


class Pages:
    """All pages of the console, and who has them open."""

    def __init__(
        self,
        options: ConsoleOptions,
        link: Link,
        next_drive: NextDrive,
        standing: Mapping[str, Any],
        lines: Lines,
        users: dict[str, User] | None,
        audit: Audit,
    ) -> None:
        """Take what they show; users: None: no password is asked for."""
        self._options, self._link, self._next_drive, self._audit = options, link, next_drive, audit
        self._standing, self._lines = dict(standing), lines
        self._login = users is not None
        self._visitors = Visitors()
        self._open: dict[str, tuple[Visitor, Page]] = {}
        secure = options.certificate is not None
        self._login_form = Login(users or {}, self._visitors, audit, secure=secure)
        self._access = {
            "names": {options.host.strip("[]"), *options.names, *(LOOPBACK if options.is_local else ())},
            "visitors": self._visitors,
            "asks_for_password": self._login,
            "secure": secure,
            "owns": self._owns,
        }

    def install(self) -> None:
        """Put everything into the application; to be called once, before it runs."""
        core.app.config.socket_io_js_transports = ["websocket"]
        app.add_middleware(AccessControl, **self._access)  # type: ignore[arg-type]
        app.add_exception_handler(404, _lead_back)
        app.add_static_files("/drawbar", str(_STATIC), max_cache_age=0)
        app.add_api_route("/login", self._form, methods=["GET"])
        app.add_api_route("/login", self._attempt, methods=["POST"])
        app.add_api_route("/logout", self._login_form.logout, methods=["GET"])
        app.add_api_route("/language/{language}", _choose_language, methods=["GET"])
        app.add_api_route("/report/{name}", self._report, methods=["GET"])
        app.add_api_route("/map/{name}", self._map, methods=["GET"])
        ui.page(ADDRESSES["drive"])(self._drive_page)
        ui.page(ADDRESSES["fields"])(self._fields_page)
        ui.page(ADDRESSES["setup"])(self._set_up_page)
        ui.page(ADDRESSES["runs"])(self._runs_page)
        ui.page(ADDRESSES["inside"])(self._inside_page)
        app.on_delete(lambda client: self._open.pop(client.id, None))

    def refresh(self) -> None:
        """Show on all open pages what is so now."""
        for client_id, (visitor, page) in list(self._open.items()):
            client = Client.instances.get(client_id)
            if client is None or not client.has_socket_connection:
                continue
            try:
                with client:
                    if self._visitors.find(visitor.token, time.monotonic()) is None:
                        self._send_away(client, page)
                    page.refresh()
            except Exception:  # one page that cannot be shown must not end the others
                say(traceback.format_exc())

    def _send_away(self, client: Client, page: Page) -> None:
        """Show the login to somebody who is not known any more; while the vehicle is steered, a drive page can stop."""
        if isinstance(page, DrivePage) and self._link.is_engaged:
            return
        del self._open[client.id]
        ui.navigate.to(LOGIN if self._login else "/")
        ui.timer(_LEAVING, client.delete, once=True)

    def _owns(self, client_id: str, visitor: Visitor) -> bool:
        found = self._open.get(client_id)
        return found is not None and found[0].token == visitor.token

    def _words(self, request: Request) -> Words:
        chosen = request.cookies.get(_LANGUAGE) or request.headers.get("accept-language", "")
        return Words(language_of(chosen, self._options.language))

    def _drive_page(self, request: Request) -> None:
        visitor, words = self._begin(request, "drive")
        self._opened(visitor, DrivePage(self._link, visitor, words, self._standing, self._lines, login=self._login))

    def _fields_page(self, request: Request) -> None:
        visitor, words = self._begin(request, "fields")
        self._opened(visitor, FieldsPage(self._next_drive, self._link, visitor, words, self._audit, login=self._login))

    def _set_up_page(self, request: Request) -> None:
        visitor, words = self._begin(request, "setup")
        page = SetUpPage(self._next_drive, self._link, visitor, words, self._audit, login=self._login)
        self._opened(visitor, page)

    def _runs_page(self, request: Request) -> None:
        visitor, words = self._begin(request, "runs")
        folder, current = Path(self._options.runs), Path(self._options.configuration).parent
        page = RunsPage(folder, current, self._link, visitor, words, self._audit, login=self._login)
        self._opened(visitor, page)

    def _inside_page(self, request: Request) -> None:
        visitor, words = self._begin(request, "inside")
        self._opened(visitor, InsidePage(self._link, visitor, words, login=self._login))

    def _opened(self, visitor: Visitor, page: Page) -> None:
        self._open[ui.context.client.id] = (visitor, page)

    def _begin(self, request: Request, name: str) -> tuple[Visitor, Words]:
        visitor: Visitor = request.scope[VISITOR]
        words = self._words(request)
        ui.page_title(f"{words(name)} · drawbar")
        ui.add_head_html('<link rel="stylesheet" href="/drawbar/console.css"><script src="/drawbar/menu.js"></script>')
        client = ui.context.client
        client.page = copy(client.page)  # the page of this browser alone
        client.page.language = "de" if words.language == "de" else "en-US"
        return visitor, words

    async def _form(self, request: Request) -> Response:
        return self._login_form.form(self._words(request))

    async def _attempt(self, request: Request) -> Response:
        return await self._login_form.attempt(request, self._words(request))

    def _report(self, name: str) -> Response:
        return self._file_of_run(name, REPORT)

    def _map(self, name: str) -> Response:
        return self._file_of_run(name, MAP)

    def _file_of_run(self, name: str, file: str) -> Response:
        path = file_of(Path(self._options.runs), name, file)
        return FileResponse(path) if path is not None else RedirectResponse(ADDRESSES["runs"], 303)


def _lead_back(request: Request, error: Exception) -> Response:
    """Lead a browser that asks for a page that does not exist to the drive page, which can stop the vehicle."""
    if "text/html" in request.headers.get("accept", ""):
        return RedirectResponse(ADDRESSES["drive"], 303)
    return PlainTextResponse("there is nothing here", 404)


def _choose_language(language: str, page: str = "") -> Response:
    answer = RedirectResponse(page if page in ADDRESSES.values() else ADDRESSES["drive"], 303)
    answer.set_cookie(_LANGUAGE, "de" if language == "de" else "en", max_age=365 * 86400, samesite="strict")
    return answer
