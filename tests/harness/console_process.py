"""The console as a process of its own, in front of a socket that stands for the gate's."""

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager

from drawbar.config import load_configuration
from drawbar.driving.messaging.console_options import ConsoleOptions
from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.process_options import GATE

WAIT = 120.0
"""s; a loaded machine takes its time"""
PROGRAM = (sys.executable, "-m", "drawbar.console.console_main")


def free_port():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


@contextmanager
def console_process(folder, port=None, **options):
    """Start a console, by default at a free port; yields its process, the gate's endpoint and the port."""
    configuration = folder / "config.toml"
    configuration.write_text(load_configuration("articulated").to_toml(), "utf-8")
    port = port or free_port()
    text = ConsoleOptions(
        folder=str(folder), configuration=str(configuration), port=port, runs=str(folder), **options
    ).model_dump_json()
    gate = Endpoint(str(folder / GATE))
    surroundings = {key: value for key, value in os.environ.items() if not key.startswith(("PYTEST", "NICEGUI"))}
    (folder / "tmp").mkdir(exist_ok=True)
    surroundings["TMPDIR"] = str(folder / "tmp")
    with subprocess.Popen(PROGRAM, stdin=subprocess.PIPE, env=surroundings, cwd=folder) as running:
        running.stdin.write(text.encode())
        running.stdin.close()
        yield running, gate, port
        running.send_signal(signal.SIGTERM)
        try:
            running.wait(30)
        except subprocess.TimeoutExpired:
            running.kill()
    gate.close()
    assert not list((folder / "tmp").iterdir())


def until(condition):
    end = time.monotonic() + WAIT
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


def reaches(host, port):
    try:
        socket.create_connection((host, port), timeout=1.0).close()
    except OSError:
        return False
    return True
