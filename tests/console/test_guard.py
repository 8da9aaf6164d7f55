"""Who may reach the console: hosts, origins, cookies, roles, sockets, floods; and the audit log."""

import asyncio
import json
import stat

import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import HOST, Stage, client_id, console
from nicegui import core, ui
from waiting import FakeClock

from drawbar.console.guard import BURST, LARGEST, PAGE_BURST, PAGE_RATE, PAUSE, SOCKETS, Guard
from drawbar.console.passwords import load_users, save_user, verify
from drawbar.console.visitors import COOKIE, LIFE, Rank, Visitors
from drawbar.driving.console_orders import ConsoleOrders
from drawbar.errors import ConfigurationError
from drawbar.messages import Action, SupervisorState

PASSWORD = "correct horse battery"


@pytest.fixture
def users(tmp_path):
    path = tmp_path / "users"
    for name, rank in (("anna", Rank.OPERATOR), ("ben", Rank.VIEWER)):
        save_user(path, name, rank, PASSWORD)
    return path


def get(http, path="/", **headers):
    return http.get(path, headers=headers)


def asking(test, users=None, audit=None):
    """Run an asynchronous test with a stage and what opens browsers."""

    async def whole():
        stage = Stage(audit)
        async with console(stage, load_users(users) if users else None) as browser:
            return await test(stage, browser)

    return asyncio.run(whole())


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 200),
        ({"host": "localhost:8080"}, 200),
        ({"host": "127.0.0.1"}, 200),
        ({"origin": f"http://{HOST}"}, 200),
        ({"host": "attacker.example"}, 403),  # DNS rebinding
        ({"host": "attacker.example:8080"}, 403),
        ({"host": ""}, 403),
        ({"origin": "http://attacker.example"}, 403),
        ({"origin": f"http://{HOST}:81"}, 403),
        ({"origin": "null"}, 403),
        ({"content-length": str(LARGEST + 1)}, 413),
        ({"content-length": "-1"}, 413),
        ({"cookie": "drawbar=" + "x" * 9000}, 200),
    ],
)
def test_only_known_hosts_and_own_pages_are_answered(headers, status):
    async def test(stage, browser):
        return (await get(browser().user.http_client, **headers)).status_code

    assert asking(test) == status


def test_answers_forbid_frames_and_other_hosts_and_the_cookie_is_strict():
    async def test(stage, browser):
        return (await get(browser().user.http_client)).headers

    headers = asking(test)
    assert "default-src 'self'" in headers["content-security-policy"]
    assert "http" not in headers["content-security-policy"]
    assert headers["x-frame-options"] == "DENY"
    own = next(each for each in headers.get_list("set-cookie") if each.startswith(f"{COOKIE}="))
    assert {"HttpOnly", "SameSite=Strict"} <= set(own.split("; "))


@pytest.mark.parametrize(("page", "back"), [("/fields", "/fields"), ("", "/"), ("//attacker.example", "/")])
def test_another_language_is_chosen_on_the_same_page_of_the_console_alone(page, back):
    async def test(stage, browser):
        http = browser().user.http_client
        answer = await get(http, f"/language/de?page={page}")
        return answer.headers["location"], (await get(http, "/fields")).text

    address, text = asking(test)
    assert address == back
    assert "<title>Felder und Linien · drawbar</title>" in text


def test_long_polling_is_refused():
    async def test(stage, browser):
        return (await get(browser().user.http_client, "/_nicegui_ws/socket.io/?transport=polling")).status_code

    assert asking(test) == 403


def test_without_login_nothing_is_shown(users):
    async def test(stage, browser):
        http = browser().user.http_client
        return [(await get(http, path)) for path in ("/", "/runs", "/report/x", "/drawbar/console.css", "/login")]

    *others, login = asking(test, users)
    assert all(each.status_code == 303 and each.headers["location"] == "/login" for each in others)
    assert login.status_code == 200
    assert "password" in login.text


async def log_in(watcher, name, password=PASSWORD):
    return await watcher.user.http_client.post("/login", data={"name": name, "password": password})


def test_roles_a_viewer_looks_and_stops_an_operator_drives(users):
    async def test(stage, browser):
        anna, ben = browser(), browser()
        assert (await log_in(anna, "anna")).status_code == 303
        await log_in(ben, "ben")
        await anna.open()
        await ben.open()
        stage.run(4.0, anna, ben)
        assert anna.enabled("1 Prepare")
        assert not ben.enabled("1 Prepare")
        assert "You may look and stop" in ben.text()
        before = len(stage.sent)
        stage.link.ask(ben.page._visitor, Action.ARM)  # a forged event of a button that cannot be pressed
        assert [each.action for each in stage.sent[before:]] == []
        ben.press("STOP")
        assert stage.sent[-1].action is Action.STOP

    asking(test, users)


def test_a_viewer_is_not_the_operator_that_has_to_be_there(users):
    async def test(stage, browser):
        ben = browser()
        await log_in(ben, "ben")
        await ben.open()
        stage.run(4.0, ben)
        return "No operator has been heard" in ben.text()

    assert asking(test, users)


def test_wrong_passwords_are_refused_and_many_are_not_even_looked_at(users):
    async def test(stage, browser):
        one = browser()
        codes = [(await log_in(one, name, "wrong password")).status_code for name in ("anna", "nobody", "", "x" * 5000)]
        codes += [(await log_in(one, "anna", "wrong password")).status_code for _ in range(3)]
        return codes, one.user.http_client.cookies.get(COOKIE)

    codes, cookie = asking(test, users)
    assert codes == [403] * 5 + [429] * 2
    assert cookie is None


def test_after_logging_out_the_cookie_is_worth_nothing(users):
    async def test(stage, browser):
        one = browser()
        await log_in(one, "anna")
        token = one.user.http_client.cookies[COOKIE]
        await get(one.user.http_client, "/logout")
        answer = await get(browser().user.http_client, cookie=f"{COOKIE}={token}")
        return answer.status_code

    assert asking(test, users) == 303


def test_whoever_logs_out_while_steering_keeps_the_stop_and_loses_the_rest(users):
    async def test(stage, browser):
        anna = browser()
        await log_in(anna, "anna")
        await anna.open()
        stage.run(4.0, anna)
        for text in ("1 Prepare", "2 Engage"):
            anna.press(text)
            stage.run(1.0, anna)
        assert stage.link.is_engaged
        await get(anna.user.http_client, "/logout")  # in another tab
        before = len(stage.sent)
        stage.run(1.0, anna)
        with anna.user.client:
            anna.page._send(Action.SET_SPEED, 0.5)  # a forged event
        assert [each.action for each in stage.sent[before:]] == []
        assert "You may look and stop" in anna.text()
        assert shown(anna) == []  # the stop stays within reach
        stage.run(1.5, anna)
        assert stage.engagement.state is SupervisorState.STOPPING
        anna.press("STOP")
        assert stage.sent[-1].action is Action.STOP
        stage.standing = True
        stage.run(3.0, anna)
        assert [shown(anna), shown(anna)] == [["/login"], []]

    asking(test, users)


def test_whoever_logs_out_sees_no_other_page_either(users):
    async def test(stage, browser):
        anna = browser()
        await log_in(anna, "anna")
        await anna.open("/fields")
        await get(anna.user.http_client, "/logout")
        assert shown(anna) == ["/login"]

    asking(test, users)


def shown(watcher):
    """Show all pages what is so now, as the console's process does; return where the browser is led."""
    led = []
    watcher.user.client.tab_id = "tab"
    ui.navigate.to = led.append
    watcher.pages.refresh()
    return led


def test_visitors_are_forgotten_after_half_a_day():
    visitors = Visitors()
    visitor = visitors.admit("anna", Rank.OPERATOR, 0.0)
    assert visitors.find(visitor.token, LIFE) is visitor
    assert visitors.find(visitor.token, 2.0 * LIFE + 1.0) is None
    assert visitors.find("", 0.0) is None


def test_the_audit_log_says_who_asked_for_what_and_no_secret(users, tmp_path):
    log = tmp_path / "audit"

    async def test(stage, browser):
        anna = browser()
        await log_in(anna, "anna", "wrong password")
        await log_in(anna, "anna")
        await anna.open()
        stage.run(4.0, anna)
        anna.press("1 Prepare")
        anna.press("STOP")
        visitor = anna.page._visitor
        return visitor.token, str(visitor.number)

    secrets = asking(test, users, log)
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    assert [line["event"] for line in lines] == ["LOGIN_FAILED", "LOGIN", "ARM", "STOP"]
    assert lines[2]["name"] == "anna"
    assert not any(secret in log.read_text() for secret in (*secrets, PASSWORD, "wrong password"))


def test_passwords_are_salted_hashes_in_a_file_of_the_owner(users):
    assert stat.S_IMODE(users.stat().st_mode) == 0o600
    assert PASSWORD not in users.read_text()
    known = load_users(users)
    assert known["anna"].digest != known["ben"].digest
    assert verify(known, "anna", PASSWORD) is known["anna"]
    assert verify(known, "anna", PASSWORD + "x") is None
    assert verify(known, "nobody", PASSWORD) is None
    users.chmod(0o640)
    with pytest.raises(ConfigurationError, match="chmod 600"):
        load_users(users)


@pytest.mark.parametrize(("name", "password"), [("a b", PASSWORD), ("", PASSWORD), ("anna", "short")])
def test_bad_names_and_short_passwords_are_not_saved(tmp_path, name, password):
    with pytest.raises(ConfigurationError):
        save_user(tmp_path / "users", name, Rank.VIEWER, password)
    assert not (tmp_path / "users").exists()


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.5.10"])
def test_others_reach_it_only_with_tls_and_passwords(tmp_path, host):
    given = {}
    for name in ("certificate", "key", "passwords"):
        with pytest.raises(ConfigurationError, match=name):
            ConsoleOrders(folder="", configuration="", host=host, **given).check()
        (tmp_path / name).touch()
        given[name] = str(tmp_path / name)
    ConsoleOrders(folder="", configuration="", host=host, **given).check()
    assert ConsoleOrders(folder="", configuration="").host == "127.0.0.1"


class Line:
    """A web socket from outside: what is sent to the guard, and what it answers."""

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
    """An application behind the guard that accepts, and counts what it is given."""

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
def guarded():
    visitors, inner = Visitors(), Inner()
    one, other = (visitors.admit("", Rank.MAINTAINER, 0.0) for _ in range(2))
    visitors.find = lambda token, time: {one.token: one, other.token: other}.get(token)
    guard = Guard(
        inner,
        names={HOST},
        visitors=visitors,
        asks_for_password=False,
        secure=False,
        owns=lambda page, visitor: (page, visitor) == ("page", one),
        clock=FakeClock(),
    )
    return guard, inner, one, other


def served(guard, line):
    asyncio.run(guard(line.scope, line.receive, line.send))
    return line.answers


def test_a_socket_is_its_pages_owners_only(guarded):
    guard, _, one, other = guarded
    assert served(guard, Line(one, "page")) == ["websocket.accept"]
    for line in (
        Line(other, "page"),
        Line(None, "page"),
        Line(one, "another"),
        Line(one, ""),
        Line(one, "page", origin="http://attacker.example"),
    ):
        assert served(guard, line) == ["websocket.close"]


def test_a_flood_and_what_is_too_large_end_their_socket(guarded):
    guard, inner, one, _ = guarded
    flood = [{"type": "websocket.receive", "text": "x"}] * 10_000
    assert served(guard, Line(one, "page", messages=flood)) == ["websocket.accept"]
    assert 0 < inner.received <= BURST + 1
    inner.received = 0
    guard._clock.now += PAUSE
    large = [{"type": "websocket.receive", "bytes": bytes(LARGEST + 1)}]
    assert served(guard, Line(one, "page", messages=large)) == ["websocket.accept"]
    assert inner.received == 0


def test_whoever_flooded_is_not_served_for_a_while_and_others_are(guarded):
    guard, _, one, other = guarded
    guard._owns = lambda page, visitor: True
    flood = [{"type": "websocket.receive", "text": "x"}] * 1000
    assert served(guard, Line(one, "page", messages=flood)) == ["websocket.accept"]
    assert served(guard, Line(one, "page")) == ["websocket.close"]
    assert asked(guard, one) == [429]
    assert served(guard, Line(other, "page")) == ["websocket.accept"]
    assert asked(guard, other) == [200]
    guard._clock.now += PAUSE
    assert served(guard, Line(one, "page")) == ["websocket.accept"]


def test_pages_are_built_so_often_for_an_address(guarded):
    guard, _, one, _ = guarded
    burst = int(PAGE_BURST)
    assert asked(guard, one, burst + 1) == [200] * burst + [429]
    assert asked(guard, one, address="192.168.5.11") == [200]
    assert asked(guard, one, path="/drawbar/console.css") == [200]
    guard._clock.now += 1.0 / PAGE_RATE
    assert asked(guard, one, 2) == [200, 429]


def asked(guard, visitor, times=1, path="/", address="192.168.5.10"):
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
            await guard({**scope, "client": (address, 1)}, None, send)

    sockets, guard._app = guard._app, inner
    asyncio.run(whole())
    guard._app = sockets
    return statuses


def test_only_so_many_sockets_are_open(guarded):
    guard, inner, one, _ = guarded

    async def whole():
        inner.waits = asyncio.Event()
        lines = [Line(one, "page") for _ in range(SOCKETS + 1)]
        tasks = [asyncio.create_task(guard(line.scope, line.receive, line.send)) for line in lines]
        await asyncio.sleep(0)
        inner.waits.set()
        await asyncio.gather(*tasks)
        return [line.answers for line in lines]

    assert sorted(asyncio.run(whole())) == sorted([["websocket.accept"]] * SOCKETS + [["websocket.close"]])


def test_each_page_belongs_to_the_browser_that_opened_it():
    async def test(stage, browser):
        one, other = browser(), browser()
        page = client_id((await get(one.user.http_client)).text)
        await get(other.user.http_client)
        cookies = [each.user.http_client.cookies[COOKIE] for each in (one, other)]
        owners = [one.pages._visitors.find(cookie, 0.0) for cookie in cookies]
        return [one.pages._owns(page, owner) for owner in owners], core.app.config.socket_io_js_transports

    assert asking(test) == ([True, False], ["websocket"])


def test_a_body_in_pieces_without_end_is_cut_off(guarded):
    guard, _, one, _ = guarded
    received = []

    async def inner(scope, receive, send):
        while (message := await receive())["type"] == "http.request":
            received.append(len(message["body"]))

    async def receive():
        return {"type": "http.request", "body": bytes(1 << 12), "more_body": True}

    async def send(message):
        pass

    guard._app = inner
    headers = [(b"host", HOST.encode()), (b"cookie", f"{COOKIE}={one.token}".encode())]
    scope = {"type": "http", "method": "POST", "path": "/login", "headers": headers, "query_string": b""}
    asyncio.run(guard(scope, receive, send))
    assert sum(received) == LARGEST
    assert guard.refused == 1
