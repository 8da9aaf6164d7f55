"""A drive of stand-ins with its console, and browsers in front of it.

Tests wait for what is to be seen, and press again what was refused, as people do: on a busy computer pictures are late,
and what was seen too long ago is no ground to ask for anything.
"""

import os
import signal
import subprocess
import sys
import time
import urllib.request
from contextlib import contextmanager, suppress

from console_process import free_port
from patience import PATIENT

from drawbar.console import screenshots
from drawbar.console.screenshots import word

WAIT = 300.0
"""until something is seen, s; what never comes is ended by this, and by the test's own limit"""


@contextmanager
def drive_with_console(folder):
    """Drive until the end of the context; yields the address of the console."""
    port = free_port()
    surroundings = {key: value for key, value in os.environ.items() if not key.startswith(("PYTEST", "NICEGUI"))}
    arguments = ["drive", "--console", "--port", str(port), "--out", str(folder / "run")]
    changes = [word for change in PATIENT for word in ("--set", change)]
    address = f"http://127.0.0.1:{port}/"
    with (folder / "out").open("wb") as out:
        command = [sys.executable, "-m", "drawbar", *arguments, *changes]
        process = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, env=surroundings, cwd=folder)
    try:
        _await_page(address, process, folder / "out")
        yield address
    finally:
        process.send_signal(signal.SIGTERM)  # SIGINT is ignored by children of a shell's background job
        try:
            process.wait(WAIT)  # it ends its processes in order, and writes the report
        finally:
            process.kill()


def _await_page(address, process, out):
    """Wait for the page as long as the drive is on: it may have to compile first."""
    end = time.monotonic() + WAIT
    while time.monotonic() < end:
        assert process.poll() is None, out.read_text()
        with suppress(OSError):
            urllib.request.urlopen(address, timeout=WAIT).close()
            return
        time.sleep(0.2)
    raise AssertionError(out.read_text())


def new_visitor(browser):
    """Return what opens pages of one visitor."""
    context = browser.new_context(viewport={"width": 360, "height": 740}, locale="en-GB")
    context.set_default_timeout(1e3 * WAIT)
    context.route(lambda url: not url.startswith(("http://127.0.0.1:", "data:")), lambda route: route.abort())
    return context


def new_page(visitor):
    """Return a page that reaches nothing but this computer.

    `asked` holds what it asked for, `troubles` what went wrong in it.
    """
    page = visitor.new_page()
    page.asked, page.troubles = [], []
    page.on("request", lambda request: page.asked.append(request.url))
    page.on("websocket", lambda line: page.asked.append(line.url.replace("ws://", "http://")))
    page.on("pageerror", lambda error: page.troubles.append(str(error)))
    return page


def see(page, seen):
    word(page, seen).wait_for()


def press(page, name):
    page.get_by_role("button", name=name, exact=True).click()


def press_until(page, seen, *names):
    screenshots.press_until(page, seen, *names, wait=1e3 * WAIT)
