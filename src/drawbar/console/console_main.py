"""The console's process as a program: `python -m drawbar.console.console_main`, with its options on standard input."""

import asyncio
import contextlib
import os
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from drawbar.driving.messaging.console_options import ConsoleOptions
from drawbar.driving.processes.shutdown import run_program, starter

if TYPE_CHECKING:
    from drawbar.console.link import Link
    from drawbar.console.pages import Pages
    from drawbar.driving.messaging.endpoint import Endpoint

PERIOD = 0.1
"""between two pictures, s; a step that arrives is shown at once"""
_RECONNECT = 60.0
"""for which a page that is out of reach is kept, s"""


def main() -> int:
    """Serve the pages until told to end."""
    options = ConsoleOptions.model_validate_json(sys.stdin.buffer.read())
    # nothing of NiceGUI's own in the folder where one happens to be, and nothing that outlives the drive
    os.environ["NICEGUI_STORAGE_PATH"] = str(Path(options.folder) / "storage")
    os.environ.setdefault("MPLBACKEND", "agg")
    return _serve(options)


def _serve(options: ConsoleOptions) -> int:
    from nicegui import app, ui

    endpoint, link, pages = _build(options)
    pages.install()
    app.on_startup(lambda: _work(endpoint, link, pages))
    app.on_shutdown(endpoint.close)
    ui.run(
        host=options.host,
        port=options.port,
        title="drawbar",
        favicon="🚜",
        dark=None,
        reload=False,
        show=False,
        show_welcome_message=False,
        tailwind=False,
        reconnect_timeout=_RECONNECT,
        binding_refresh_interval=None,
        storage_secret=None,
        ws_max_size=1 << 17,
        ws_per_message_deflate=False,
        ssl_certfile=options.certificate,
        ssl_keyfile=options.key,
    )
    return 0


def _build(options: ConsoleOptions) -> "tuple[Endpoint, Link, Pages]":
    """Return the console's own socket, its end of the drive, and all pages."""
    from drawbar.config import load_configuration
    from drawbar.console.audit import Audit
    from drawbar.console.drawing import Lines, boundary, standing, tube_widths
    from drawbar.console.link import Link
    from drawbar.console.next_drive import NextDrive
    from drawbar.console.pages import Pages
    from drawbar.console.passwords import load_users
    from drawbar.driving.devices.path_frame import local_frame
    from drawbar.driving.messaging.endpoint import Endpoint
    from drawbar.driving.messaging.process_options import CONSOLE, ProcessOptions
    from drawbar.driving.operator.requests import gate_sender
    from drawbar.driving.stand_in.demonstration import without_stand_ins
    from drawbar.simulation import build_path

    options.check()
    users = load_users(Path(options.passwords)) if options.passwords else None
    drive = ProcessOptions(folder=options.folder, run=options.runs, configuration=options.configuration)
    configuration = load_configuration(options.configuration)
    path, _ = build_path(configuration)
    endpoint = Endpoint(drive.socket(CONSOLE))
    audit = Audit(Path(options.audit) if options.audit else None)
    link = Link(gate_sender(endpoint, drive), audit, time.monotonic_ns, configuration.vehicle)
    kept = without_stand_ins(configuration) if options.stand_ins else configuration
    frame, width = local_frame(configuration), configuration.path.working_width
    next_drive = NextDrive(kept, configuration, frame, fields=Path(options.fields), setup=Path(options.setup))
    ring, tubes = boundary(configuration, frame), tube_widths(configuration)
    scene = standing(configuration.vehicle, configuration.speed, width, ring, tubes)
    return endpoint, link, Pages(options, link, next_drive, scene, Lines(path, width), users, audit)


async def _work(endpoint: "Endpoint", link: "Link", pages: "Pages") -> None:
    """Receive and show the drive, until whoever started the console is gone, and with it the drive."""
    from nicegui import app

    came = asyncio.Event()

    def receive() -> None:
        before = link.version
        for data in endpoint.receive():
            link.receive(data)
        if link.version != before:
            came.set()

    asyncio.get_running_loop().add_reader(endpoint.fileno(), receive)
    parent = starter()
    while os.getppid() == parent:
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(came.wait(), PERIOD)
        came.clear()
        link.pass_time()
        pages.refresh()
    app.shutdown()


if __name__ == "__main__":
    sys.exit(run_program(main))
