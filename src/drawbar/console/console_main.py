"""The console's process as a program: `python -m drawbar.console.console_main`, with its orders on standard input."""

import asyncio
import contextlib
import os
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from drawbar.driving.console_orders import ConsoleOrders
from drawbar.driving.ending import told

if TYPE_CHECKING:
    from drawbar.console.link import Link
    from drawbar.console.pages import Pages
    from drawbar.driving.mail import Mailbox

PERIOD = 0.1
"""between two pictures, s; a step that is heard is shown at once"""
_RECONNECT = 60.0
"""for which a page that is out of reach is kept, s"""


def main() -> int:
    """Serve the pages until told to end."""
    orders = ConsoleOrders.model_validate_json(sys.stdin.read())
    # nothing of NiceGUI's own in the folder where one happens to be, and nothing that outlives the drive
    os.environ["NICEGUI_STORAGE_PATH"] = str(Path(orders.folder) / "storage")
    os.environ.setdefault("MPLBACKEND", "agg")
    return _serve(orders)


def _serve(orders: ConsoleOrders) -> int:
    from nicegui import app, ui

    mailbox, link, pages = _build(orders)
    pages.install()
    app.on_startup(lambda: _work(mailbox, link, pages))
    app.on_shutdown(mailbox.close)
    ui.run(
        host=orders.host,
        port=orders.port,
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
        ssl_certfile=orders.certificate,
        ssl_keyfile=orders.key,
    )
    return 0


def _build(orders: ConsoleOrders) -> "tuple[Mailbox, Link, Pages]":
    """Return the console's own socket, its end of the drive, and all pages."""
    from drawbar.config import load_configuration
    from drawbar.console.audit import Audit
    from drawbar.console.drawing import Lines, boundary, standing, tube_widths
    from drawbar.console.link import Link
    from drawbar.console.pages import Pages
    from drawbar.console.passwords import load_users
    from drawbar.console.workshop import Workshop
    from drawbar.driving.demonstration import without_stand_ins
    from drawbar.driving.mail import Mailbox
    from drawbar.driving.operator import to_gate
    from drawbar.driving.orders import CONSOLE, Orders
    from drawbar.driving.place import local_frame
    from drawbar.simulation import build_path

    orders.check()
    users = load_users(Path(orders.passwords)) if orders.passwords else None
    drive = Orders(folder=orders.folder, run=orders.runs, configuration=orders.configuration)
    configuration = load_configuration(orders.configuration)
    path, _ = build_path(configuration)
    mailbox = Mailbox(drive.socket(CONSOLE))
    audit = Audit(Path(orders.audit) if orders.audit else None)
    mast = configuration.vehicle.masts.tractor
    link = Link(to_gate(mailbox, drive), audit, time.monotonic_ns, mast)
    kept = without_stand_ins(configuration) if orders.stand_ins else configuration
    frame, width = local_frame(configuration), configuration.path.working_width
    workshop = Workshop(kept, configuration, frame, fields=Path(orders.fields), setup=Path(orders.setup))
    ring, tubes = boundary(configuration, frame), tube_widths(configuration)
    scene = standing(configuration.vehicle, configuration.speed, width, ring, tubes)
    return mailbox, link, Pages(orders, link, workshop, scene, Lines(path, width), users, audit)


async def _work(mailbox: "Mailbox", link: "Link", pages: "Pages") -> None:
    """Hear the drive and show it, until whoever started the console is gone, and with it the drive."""
    from nicegui import app

    came = asyncio.Event()

    def hear() -> None:
        before = link.version
        for data in mailbox.receive():
            link.hear(data)
        if link.version != before:
            came.set()

    asyncio.get_running_loop().add_reader(mailbox.fileno(), hear)
    parent = os.getppid()
    while os.getppid() == parent:
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(came.wait(), PERIOD)
        came.clear()
        link.pass_time()
        pages.refresh()
    app.shutdown()


if __name__ == "__main__":
    sys.exit(told(main))
