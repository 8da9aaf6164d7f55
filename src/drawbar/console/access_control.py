"""Access control in front of every page and socket of the console. Who may ask, from where, how much and how often.

Host and Origin are checked against the names under which the console is known (DNS rebinding, pages of other sites);
a socket belongs to the visitor whose page opened it; floods and oversized messages end their connection.
"""

import re
import time
from collections.abc import Awaitable, Callable, Collection, MutableMapping
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs, urlsplit

from drawbar.console.token_bucket import TokenBucket, TokenBuckets
from drawbar.console.visitors import COOKIE, Rank, Visitor, Visitors

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
Application = Callable[[Scope, Receive, Send], Awaitable[None]]

SOCKETS = 16
"""pages that may be open at a time"""
LARGEST = 1 << 16
"""bytes of a request or a message"""
LARGEST_UPLOAD = 1 << 23
"""bytes of a file that is handed over"""
RATE, BURST = 40.0, 100.0
"""messages of a socket, 1/s and at once; a page acknowledges ten pictures a second"""
PAGE_RATE, PAGE_BURST = 1.0, 20.0
"""pages that one address may open, 1/s and at once; each takes some hundredths of a second to build"""
PAUSE = 10.0
"""for which a visitor whose socket was ended for a flood is not served, s"""
VISITOR = "drawbar.visitor"
"""key of the visitor in a scope"""
LOGIN = "/login"
_SOCKET_PATH = "/_nicegui_ws"
_FILES = ("/_nicegui", "/drawbar/")
"""paths of what is only read and sent"""
_UPLOAD = re.compile(r"/_nicegui/client/(?P<page>[\w-]+)/upload/\d+")
_HEADERS = {
    # NiceGUI needs inline scripts and Vue's compiler; nothing may come from, or go to, another host.
    "content-security-policy": "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data:; font-src 'self' data:; connect-src 'self'; "
    "frame-ancestors 'none'; form-action 'self'; base-uri 'self'; object-src 'none'",
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "same-origin",
}


class AccessControl:
    """ASGI middleware."""

    def __init__(
        self,
        app: Application,
        *,
        names: Collection[str],
        visitors: Visitors,
        asks_for_password: bool,
        secure: bool,
        owns: Callable[[str, Visitor], bool],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Take what stands behind it.

        Args:
            app: the application.
            names: host names, without ports, under which it may be asked for.
            visitors: who is known.
            asks_for_password: visitors must have logged in; otherwise each browser is admitted as maintainer.
            secure: cookies go over TLS only.
            owns: whether a page (its client's id) was opened by a visitor.
            clock: s.
        """
        self._app, self._names, self._visitors = app, frozenset(name.lower() for name in names), visitors
        self._asks_for_password, self._secure, self._owns = asks_for_password, secure, owns
        self._clock = clock
        self._sockets = 0
        self._pages = TokenBuckets(PAGE_RATE, PAGE_BURST)
        self._flooded: dict[str, float] = {}  # until when they are not served, by visitors' tokens
        self.refused = 0
        """requests and sockets that were refused, and sockets that were ended"""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request or a socket through, or refuse it."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = {key.decode("latin-1").lower(): value.decode("latin-1") for key, value in scope["headers"]}
        visitor = self._visitors.find(_cookie(headers.get("cookie", "")), self._clock())
        flaw = self._flaw(scope, headers, visitor)
        if flaw is not None:
            await self._refuse(scope, receive, send, *flaw)
        elif scope["type"] == "websocket":
            await self._socket(scope, receive, send, visitor)
        else:
            await self._page(scope, receive, send, visitor)

    def _flaw(self, scope: Scope, headers: dict[str, str], visitor: Visitor | None) -> tuple[int, str] | None:
        """Return status and reason for which a request is refused."""
        host = headers.get("host", "")
        if (urlsplit(f"//{host}").hostname or "").lower() not in self._names:
            return 403, "This is not the console's name; see --name in docs/console-installation.md."
        origin = headers.get("origin")
        if origin is not None and urlsplit(origin).netloc.lower() != host.lower():
            return 403, "Another site's page may not use the console."
        length = headers.get("content-length", "0")
        if not (length.isdigit() and int(length) <= _largest(scope)):
            return 413, "This is too much."
        upload = _UPLOAD.fullmatch(scope["path"])
        if upload and not (visitor is not None and visitor.may_drive and self._owns(upload["page"], visitor)):
            return 403, "Files are taken from pages of operators only."
        if scope["type"] == "http" and scope["path"].startswith(_SOCKET_PATH):
            return 403, "Only web sockets are served here."
        now, (address, _) = self._clock(), scope.get("client") or ("", 0)
        if visitor is not None and now < self._flooded.get(visitor.token, now):
            return 429, "This browser has sent too much; wait ten seconds."
        asks = scope["type"] == "http" and not scope["path"].startswith(_FILES)
        if asks and not self._pages.take(address, now):
            return 429, "Too many pages are asked for; wait a moment."
        return None

    async def _page(self, scope: Scope, receive: Receive, send: Send, visitor: Visitor | None) -> None:
        cookie = b""
        if visitor is None and not self._asks_for_password:
            visitor = self._visitors.admit("", Rank.MAINTAINER, self._clock())
            cookie = set_cookie(visitor.token, secure=self._secure)
        if visitor is None and scope["path"] != LOGIN:
            head = [(b"location", LOGIN.encode()), (b"content-length", b"0")]
            await send({"type": "http.response.start", "status": 303, "headers": head})
            await send({"type": "http.response.body", "body": b""})
            return
        scope[VISITOR] = visitor

        async def checked_send(message: Message) -> None:
            if message["type"] == "http.response.start":
                extra = [(key.encode(), value.encode()) for key, value in _HEADERS.items()]
                extra += [(b"set-cookie", cookie)] if cookie else []
                message = {**message, "headers": [*message.get("headers", []), *extra]}
            await send(message)

        left = _largest(scope)

        async def checked_receive() -> Message:
            nonlocal left
            message = await receive()
            left -= len(message.get("body") or b"")
            if left < 0:  # a body without a length, in pieces without end
                self.refused += 1
                return {"type": "http.disconnect"}
            return message

        await self._app(scope, checked_receive, checked_send)

    async def _socket(self, scope: Scope, receive: Receive, send: Send, visitor: Visitor | None) -> None:
        page = parse_qs(scope.get("query_string", b"").decode("latin-1")).get("client_id", [""])[0]
        if visitor is None or not self._owns(page, visitor) or self._sockets >= SOCKETS:
            await self._refuse(scope, receive, send, 403, "")
            return
        scope[VISITOR] = visitor
        bucket = TokenBucket(RATE, BURST)
        over = False

        async def checked_receive() -> Message:
            nonlocal over
            message = await receive()
            self._visitors.find(visitor.token, self._clock())  # whose words on the socket keep it known
            size = len(message.get("text") or "") + len(message.get("bytes") or b"")
            if message["type"] == "websocket.receive" and not (size <= LARGEST and bucket.take(self._clock())):
                over = True
                self._pause(visitor)
            if over and message["type"] == "websocket.receive":
                self.refused += 1  # without a closing frame, after which uvicorn would take in the flood for 10 s more
                return {"type": "websocket.disconnect", "code": 1008}
            return message

        async def checked_send(message: Message) -> None:
            if not over:
                await send(message)

        self._sockets += 1
        try:
            await self._app(scope, checked_receive, checked_send)
        finally:
            self._sockets -= 1

    def _pause(self, visitor: Visitor) -> None:
        """Serve a visitor not for a while: each page and each socket of it would cost again."""
        now = self._clock()
        self._flooded = {each: until for each, until in self._flooded.items() if until > now}
        self._flooded[visitor.token] = now + PAUSE

    async def _refuse(self, scope: Scope, receive: Receive, send: Send, status: int, reason: str) -> None:
        self.refused += 1
        if scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})
            return
        body = reason.encode()
        head = [(b"content-type", b"text/plain; charset=utf-8"), (b"content-length", str(len(body)).encode())]
        await send({"type": "http.response.start", "status": status, "headers": head})
        await send({"type": "http.response.body", "body": body})


def _largest(scope: Scope) -> int:
    """Return how many bytes the body of a request may have."""
    return LARGEST_UPLOAD if _UPLOAD.fullmatch(scope["path"]) else LARGEST


def set_cookie(token: str, *, secure: bool) -> bytes:
    """Return the header's value that gives a browser its cookie; an empty token takes it away."""
    words = [f"{COOKIE}={token}", "Path=/", "HttpOnly", "SameSite=Strict"]
    words += ["Secure"] if secure else []
    words += [] if token else ["Max-Age=0"]
    return "; ".join(words).encode()


def _cookie(header: str) -> str:
    try:
        found = SimpleCookie(header[:4096]).get(COOKIE)
    except CookieError:
        return ""
    return found.value if found is not None else ""
