"""TLS: a console with a certificate and passwords is spoken to over real TLS; without both, others do not reach it."""

import http.client
import ssl
import subprocess
import urllib.parse

import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from certificates import certificate
from console_process import PROGRAM, WAIT, console_process, free_port, reaches, until

from drawbar.console.passwords import save_user
from drawbar.console.visitors import Rank
from drawbar.driving.messaging.console_options import ConsoleOptions

PASSWORD = "correct horse battery"


def ask(port, context, method, path, body=None, **headers):
    """Return the answer to one request over TLS."""
    line = http.client.HTTPSConnection("127.0.0.1", port, timeout=WAIT, context=context)
    try:
        line.request(method, path, body, headers)
        answer = line.getresponse()
        answer.text = answer.read().decode()
        return answer
    finally:
        line.close()


def test_it_logs_in_over_tls_and_says_nothing_without(tmp_path):
    _, file = certificate(tmp_path)
    users = tmp_path / "users"
    save_user(users, "anna", Rank.OPERATOR, PASSWORD)
    keys = {"certificate": str(file), "key": str(tmp_path / "key.pem"), "passwords": str(users)}
    trusting = ssl.create_default_context(cafile=str(file))
    with console_process(tmp_path, **keys) as (running, _, port):
        until(lambda: running.poll() is not None or reaches("127.0.0.1", port))
        assert ask(port, trusting, "GET", "/").getheader("location") == "/login"
        form = urllib.parse.urlencode({"name": "anna", "password": PASSWORD})
        kind = {"content-type": "application/x-www-form-urlencoded"}
        assert ask(port, trusting, "POST", "/login", form.replace("horse", "cow"), **kind).status == 403
        entered = ask(port, trusting, "POST", "/login", form, **kind)
        assert (entered.status, entered.getheader("location")) == (303, "/")
        cookie = entered.getheader("set-cookie")
        assert {"Secure", "HttpOnly", "SameSite=Strict"} <= set(cookie.split("; "))
        page = ask(port, trusting, "GET", "/", cookie=cookie.split(";")[0])
        assert page.status == 200
        assert "instruments" in page.text
        with pytest.raises(ssl.SSLCertVerificationError):  # a client that was not given the certificate
            ask(port, ssl.create_default_context(), "GET", "/login")
        plain = http.client.HTTPConnection("127.0.0.1", port, timeout=WAIT)
        plain.request("GET", "/login")
        with pytest.raises((http.client.BadStatusLine, ConnectionError)):
            plain.getresponse()
        plain.close()


def test_the_process_refuses_to_be_reached_by_others_without_tls_and_passwords(tmp_path):
    port = free_port()
    options = ConsoleOptions(folder=str(tmp_path), configuration="articulated", host="0.0.0.0", port=port)
    ended = subprocess.run(PROGRAM, input=options.model_dump_json().encode(), capture_output=True, check=False)
    assert ended.returncode != 0
    assert "without certificate and key and passwords" in ended.stderr.decode()
    assert not reaches("127.0.0.1", port)
