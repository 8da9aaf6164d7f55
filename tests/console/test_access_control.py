"""Who may reach the console: hosts, origins, cookies, roles; and the audit log."""

import asyncio
import json
import stat

import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from certificates import certificate
from console_stage import HOST, Stage, client_id, console
from nicegui import core, ui

from drawbar.console.access_control import LARGEST
from drawbar.console.passwords import load_users, save_user, verify
from drawbar.console.visitors import COOKIE, LIFE, Rank, Visitors
from drawbar.driving.messaging.console_options import ConsoleOptions
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


def test_a_page_that_does_not_exist_leads_to_the_drive_page():
    async def test(stage, browser):
        http = browser().user.http_client
        page, file = await get(http, "/set-up", accept="text/html,*/*;q=0.8"), await get(http, "/drawbar/no.css")
        return page.status_code, page.headers.get("location"), file.status_code

    assert asking(test) == (303, "/", 404)


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
        return "No operator is present" in ben.text()

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


def test_a_file_that_is_no_text_names_no_users(tmp_path):
    file = tmp_path / "users"
    file.touch(0o600)
    file.write_bytes(b"anna OPERATOR \xff\xfe")
    with pytest.raises(ConfigurationError, match="is no text"):
        load_users(file)


NO_TEXT = b"ten letters \xff".decode("utf-8", "surrogateescape")
"""as a terminal that is not set to UTF-8 hands it over"""


@pytest.mark.parametrize(
    ("name", "password"), [("a b", PASSWORD), ("", PASSWORD), ("anna", "short"), ("anna", NO_TEXT)]
)
def test_bad_names_and_short_passwords_are_not_saved(tmp_path, name, password):
    with pytest.raises(ConfigurationError):
        save_user(tmp_path / "users", name, Rank.VIEWER, password)
    assert not (tmp_path / "users").exists()


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.5.10"])
def test_others_reach_it_only_with_tls_and_passwords(tmp_path, host):
    _, file = certificate(tmp_path)
    (tmp_path / "users").touch()
    given = {}
    for name, path in (("certificate", file), ("key", tmp_path / "key.pem"), ("passwords", tmp_path / "users")):
        with pytest.raises(ConfigurationError, match=name):
            ConsoleOptions(folder="", configuration="", host=host, **given).check()
        given[name] = str(path)
    ConsoleOptions(folder="", configuration="", host=host, **given).check()
    assert ConsoleOptions(folder="", configuration="").host == "127.0.0.1"


def test_an_audit_log_that_cannot_be_written_is_refused(tmp_path):
    with pytest.raises(ConfigurationError, match=r"--audit .*: cannot be written \(No such file or directory\)"):
        ConsoleOptions(folder="", configuration="", audit=str(tmp_path / "missing" / "audit.jsonl")).check()
    ConsoleOptions(folder="", configuration="", audit=str(tmp_path / "audit.jsonl")).check()


def test_a_certificate_and_a_key_that_are_no_pair_are_refused(tmp_path):
    _, file = certificate(tmp_path)
    (tmp_path / "another").mkdir()
    certificate(tmp_path / "another")
    for given in ((tmp_path / "key.pem", file), (file, tmp_path / "another" / "key.pem"), (file, file)):
        chosen = dict(zip(("certificate", "key"), map(str, given), strict=True))
        with pytest.raises(ConfigurationError, match=r"no certificate and its own key .* are they exchanged\?"):
            ConsoleOptions(folder="", configuration="", **chosen).check()


def test_a_key_that_everybody_may_read_is_refused(tmp_path):
    _, file = certificate(tmp_path)
    chosen = {"certificate": str(file), "key": str(tmp_path / "key.pem")}
    (tmp_path / "key.pem").chmod(0o640)
    ConsoleOptions(folder="", configuration="", **chosen).check()
    (tmp_path / "key.pem").chmod(0o644)
    with pytest.raises(ConfigurationError, match=r"everybody on this computer may read it; chmod 600 .*key\.pem"):
        ConsoleOptions(folder="", configuration="", **chosen).check()


def test_each_page_belongs_to_the_browser_that_opened_it():
    async def test(stage, browser):
        one, other = browser(), browser()
        page = client_id((await get(one.user.http_client)).text)
        await get(other.user.http_client)
        cookies = [each.user.http_client.cookies[COOKIE] for each in (one, other)]
        owners = [one.pages._visitors.find(cookie, 0.0) for cookie in cookies]
        return [one.pages._owns(page, owner) for owner in owners], core.app.config.socket_io_js_transports

    assert asking(test) == ([True, False], ["websocket"])
