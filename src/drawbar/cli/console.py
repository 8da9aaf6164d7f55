"""`drawbar console`: the operator's pages for a drive that is on; `drawbar console-user`: who may log in there."""

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Annotated, Literal

import typer

from drawbar.cli.options import console as terminal
from drawbar.cli.pages import Pages, address, takes_pages
from drawbar.errors import HardwareError


@takes_pages
def console(
    drive: Annotated[Path | None, typer.Option(help="folder of the drive's sockets; default: the newest drive")] = None,
    *,
    pages: Pages,
) -> None:
    """Serve the operator's pages for a drive that is on already; `drawbar drive --console` does both."""
    from drawbar.driving.messaging.process_options import CONSOLE, GATE, OPTIONS_NAME, ProcessOptions

    folder = drive or _newest_drive()
    try:
        known = ProcessOptions.model_validate_json((folder / OPTIONS_NAME).read_text("utf-8"))
    except (OSError, ValueError):
        known = None
    if known is None or not _is_bound(folder / GATE):
        raise HardwareError(f"{folder} is not the folder of a drive that is on; start one with drawbar drive")
    if _is_bound(Path(known.socket(CONSOLE))):
        raise HardwareError(f"the drive in {folder} has a console already; open that one, or end it")
    if known.pace != 1:
        raise HardwareError(f"the drive in {folder} has --pace {known.pace}; the console shows drives in real time")
    options = pages.options(
        folder=known.folder,
        configuration=known.configuration,
        runs=str(Path(known.run).parent),
        stand_ins=known.stand_ins,
    )
    Path(known.socket(CONSOLE)).unlink(missing_ok=True)  # of a console that was killed
    terminal.print(f"the console is at {address(options)}; Ctrl-C ends it, and not the drive", soft_wrap=True)
    try:
        code = subprocess.run(
            [sys.executable, "-m", "drawbar.console.console_main"],
            input=options.model_dump_json().encode(),
            check=False,
        ).returncode
    except KeyboardInterrupt:
        code = 0
    raise SystemExit(code)


def console_user(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="of the users; a new one is made readable for you alone")
    ],
    name: Annotated[str, typer.Argument(metavar="NAME", help="of the user")],
    rank: Annotated[
        Literal["viewer", "operator", "maintainer"], typer.Option(help="what the user may do")
    ] = "operator",
) -> None:
    """Add a user of the console, or give one a new password, which is asked for."""
    from drawbar.console.passwords import demand_name, save_user
    from drawbar.console.visitors import Rank

    demand_name(name)
    password = typer.prompt("password", hide_input=True, confirmation_prompt=True)
    save_user(file, name, Rank[rank.upper()], password)
    terminal.print(f"{file}: {name} is {rank}; a running console knows it after its next start")


def _is_bound(path: Path) -> bool:
    """Return whether a process has the socket of this path; one that was killed leaves the path."""
    import socket

    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as each:
        try:
            each.connect(str(path))
        except OSError:
            return False
    return True


def _newest_drive() -> Path:
    from drawbar.driving.messaging.process_options import GATE, OPTIONS_NAME

    written = Path(tempfile.gettempdir()).glob(f"drawbar-*/{OPTIONS_NAME}")
    found = [each for each in written if each.is_file() and _is_bound(each.parent / GATE)]
    if not found:
        raise HardwareError("no drive is on; start one with drawbar drive --console")
    return max(found, key=lambda each: each.stat().st_mtime).parent
