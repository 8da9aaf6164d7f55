"""How much the console's access control lets through: sockets and their owners, floods, pages, bodies."""

import asyncio

import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import HOST
from waiting import FakeClock

from drawbar.console.access_control import BURST, LARGEST, PAGE_BURST, PAGE_RATE, PAUSE, SOCKETS, AccessControl
from drawbar.console.visitors import COOKIE, MOST, Rank, Visitors


class Line:
    """A web socket from outside: what is sent to it, and what it answers."""

    def __init__(self, visitor, page, origin=f"http://{HOST}", messages=()):
        cookie = f"{COOKIE}={visitor.token}".encode() if visitor else b""
        headers = [(b"host", HOST.encode()), (b"cookie", cookie)] + [(b"origin", origin.encode())] * bool(origin)
        query = f"client_id={page}".encode()
        self.scope = {"type": "websocket", "path": "/_nicegui_ws/x", "headers": headers, "query_string": query}
        self._messages = [{"type": "websocket.connect"}, *messages]
        self.answers = []

    async def receive(self):
        return self._messages.pop(0) if self._messages else {"type": "websocket.disconnect"}

    async def send(self, message):
        self.answers.append(message["type"])


class Inner:
    """An application behind it that accepts, and counts what it is given."""

    def __init__(self):
        self.received, self.waits = 0, None

    async def __call__(self, scope, receive, send):
        await receive()
        await send({"type": "websocket.accept"})
        if self.waits is not None:
            await self.waits.wait()
        while (await receive())["type"] == "websocket.receive":
            self.received += 1


@pytest.fixture
def controlled():
    visitors, inner = Visitors(), Inner()
    one, other = (visitors.admit("", Rank.MAINTAINER, 0.0) for _ in range(2))
    visitors.find = lambda token, time: {one.token: one, other.token: other}.get(token)
    access = AccessControl(
        inner,
        names={HOST},
        visitors=visitors,
        asks_for_password=False,
        secure=False,
        owns=lambda page, visitor: (page, visitor) == ("page", one),
        clock=FakeClock(),
    )
    return access, inner, one, other


def served(access, line):
    asyncio.run(access(line.scope, line.receive, line.send))
    return line.answers


def test_a_socket_is_its_pages_owners_only(controlled):
    access, _, one, other = controlled
    assert served(access, Line(one, "page")) == ["websocket.accept"]
    for line in (
        Line(other, "page"),
        Line(None, "page"),
        Line(one, "another"),
        Line(one, ""),
        Line(one, "page", origin="http://attacker.example"),
    ):
        assert served(access, line) == ["websocket.close"]


def test_whoever_speaks_on_a_socket_stays_known(controlled):
    access, inner, _, _ = controlled
    visitors = access._visitors = Visitors()
    speaker = visitors.admit("", Rank.MAINTAINER, 0.0)
    access._owns = lambda page, visitor: True

    async def receive_while_others_come():
        inner.waits = asyncio.Event()
        line = Line(speaker, "page", messages=[{"type": "websocket.receive", "text": "x"}] * 3)
        speaks = asyncio.create_task(access(line.scope, line.receive, line.send))
        await asyncio.sleep(0)
        for _ in range(MOST - 1):
            visitors.admit("", Rank.MAINTAINER, 0.0)
        inner.waits.set()
        await speaks
        visitors.admit("", Rank.MAINTAINER, 0.0)

    asyncio.run(receive_while_others_come())
    assert speaker.is_known


def test_a_flood_and_what_is_too_large_end_their_socket(controlled):
    access, inner, one, _ = controlled
    flood = [{"type": "websocket.receive", "text": "x"}] * 10_000
    assert served(access, Line(one, "page", messages=flood)) == ["websocket.accept"]
    assert 0 < inner.received <= BURST + 1
    inner.received = 0
    access._clock.now += PAUSE
    large = [{"type": "websocket.receive", "bytes": bytes(LARGEST + 1)}]
    assert served(access, Line(one, "page", messages=large)) == ["websocket.accept"]
    assert inner.received == 0


def test_whoever_flooded_is_not_served_for_a_while_and_others_are(controlled):
    access, _, one, other = controlled
    access._owns = lambda page, visitor: True
    flood = [{"type": "websocket.receive", "text": "x"}] * 1000
    assert served(access, Line(one, "page", messages=flood)) == ["websocket.accept"]
    assert served(access, Line(one, "page")) == ["websocket.close"]
    assert asked(access, one) == [429]
    assert served(access, Line(other, "page")) == ["websocket.accept"]
    assert asked(access, other) == [200]
    access._clock.now += PAUSE
    assert served(access, Line(one, "page")) == ["websocket.accept"]


def test_pages_are_built_so_often_for_an_address(controlled):
    access, _, one, _ = controlled
    burst = int(PAGE_BURST)
    assert asked(access, one, burst + 1) == [200] * burst + [429]
    assert asked(access, one, address="192.168.5.11") == [200]
    assert asked(access, one, path="/drawbar/console.css") == [200]
    access._clock.now += 1.0 / PAGE_RATE
    assert asked(access, one, 2) == [200, 429]


def asked(access, visitor, times=1, path="/", address="192.168.5.10"):
    """Return with what pages are answered that a visitor asks for."""
    headers = [(b"host", HOST.encode()), (b"cookie", f"{COOKIE}={visitor.token}".encode())]
    scope = {"type": "http", "method": "GET", "path": path, "headers": headers, "query_string": b""}
    statuses = []

    async def inner(scope, receive, send):
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def send(message):
        if message["type"] == "http.response.start":
            statuses.append(message["status"])

    async def whole():
        for _ in range(times):
            await access({**scope, "client": (address, 1)}, None, send)

    sockets, access._app = access._app, inner
    asyncio.run(whole())
    access._app = sockets
    return statuses


def test_only_so_many_sockets_are_open(controlled):
    access, inner, one, _ = controlled

    async def whole():
        inner.waits = asyncio.Event()
        lines = [Line(one, "page") for _ in range(SOCKETS + 1)]
        tasks = [asyncio.create_task(access(line.scope, line.receive, line.send)) for line in lines]
        await asyncio.sleep(0)
        inner.waits.set()
        await asyncio.gather(*tasks)
        return [line.answers for line in lines]

    assert sorted(asyncio.run(whole())) == sorted([["websocket.accept"]] * SOCKETS + [["websocket.close"]])


def test_a_body_in_pieces_without_end_is_cut_off(controlled):
    access, _, one, _ = controlled
    received = []

    async def inner(scope, receive, send):
        while (message := await receive())["type"] == "http.request":
            received.append(len(message["body"]))

    async def receive():
        return {"type": "http.request", "body": bytes(1 << 12), "more_body": True}

    async def send(message):
        pass

    access._app = inner
    headers = [(b"host", HOST.encode()), (b"cookie", f"{COOKIE}={one.token}".encode())]
    scope = {"type": "http", "method": "POST", "path": "/login", "headers": headers, "query_string": b""}
    asyncio.run(access(scope, receive, send))
    assert sum(received) == LARGEST
    assert access.refused == 1
