"""Login: a plain form; the only page that a visitor without a password sees."""

import asyncio
import html
import time
from urllib.parse import parse_qs

from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response

from drawbar.console.access_control import LOGIN, set_cookie
from drawbar.console.audit import Audit
from drawbar.console.language.words import Words
from drawbar.console.passwords import User, verify
from drawbar.console.token_bucket import TokenBuckets
from drawbar.console.visitors import COOKIE, Visitors

ATTEMPTS, AGAIN = 5.0, 60.0
"""attempts from one address at once, and the time that gives as many new ones, s"""
_PAGE = """<!doctype html><html lang="{language}"><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1"><title>drawbar</title>
<style>:root{{color-scheme:light dark}}body{{font:18px system-ui,sans-serif;max-width:22rem;margin:12vh auto;
padding:0 1rem}}
label{{display:block;margin:1rem 0 .3rem;font-weight:650}}input,button{{font:inherit;width:100%;min-height:52px;
box-sizing:border-box;padding:0 .8rem}}button{{margin-top:1.5rem;font-weight:750}}p{{font-weight:650}}</style>
<h1>drawbar</h1><form method="post" action="/login">{flaw}
<label for="name">{name}</label><input id="name" name="name" autocomplete="username" autofocus required>
<label for="password">{password}</label>
<input id="password" name="password" type="password" autocomplete="current-password" required>
<button>{login}</button></form></html>"""


class Login:
    """Shows the form, and admits those who know a password."""

    def __init__(self, users: dict[str, User], visitors: Visitors, audit: Audit, *, secure: bool) -> None:
        """Take who may log in; secure: cookies go over TLS only."""
        self._users, self._visitors, self._audit, self._secure = users, visitors, audit, secure
        self._buckets = TokenBuckets(ATTEMPTS / AGAIN, ATTEMPTS)

    def form(self, words: Words, flaw: str = "", status: int = 200) -> Response:
        """Return the page."""
        texts = {key: html.escape(words(key)) for key in ("name", "password", "login")}
        shown = f'<p role="alert">⚠ {html.escape(words(flaw))}</p>' if flaw else ""
        return HTMLResponse(_PAGE.format(language=words.language, flaw=shown, **texts), status)

    async def attempt(self, request: Request, words: Words) -> Response:
        """Answer a form that was sent."""
        address = request.client.host if request.client else ""
        if not self._buckets.take(address, time.monotonic()):
            self._audit.write(None, "LOGIN_TOO_OFTEN", address=address)
            return self.form(words, "login_wait", 429)
        fields = parse_qs((await request.body()).decode("utf-8", "replace"))
        name, password = (fields.get(key, [""])[0] for key in ("name", "password"))
        user = await asyncio.to_thread(verify, self._users, name, password)
        if user is None:
            self._audit.write(None, "LOGIN_FAILED", address=address)
            return self.form(words, "login_failed", 403)
        visitor = self._visitors.admit(user.name, user.rank, time.monotonic())
        self._audit.write(visitor, "LOGIN", address=address)
        answer = RedirectResponse("/", 303)
        answer.headers["set-cookie"] = set_cookie(visitor.token, secure=self._secure).decode()
        return answer

    def logout(self, request: Request) -> Response:
        """Forget a visitor."""
        self._visitors.dismiss(request.cookies.get(COOKIE, ""))
        answer = RedirectResponse(LOGIN, 303)
        answer.headers["set-cookie"] = set_cookie("", secure=self._secure).decode()
        return answer
