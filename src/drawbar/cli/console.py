"""`drawbar console`: the operator's pages for a drive that is on; `drawbar console-user`: who may log in there."""

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from drawbar.cli.options import console as terminal
from drawbar.errors import ConfigurationError, HardwareError

if TYPE_CHECKING:
    from drawbar.driving.console_orders import ConsoleOrders

Host = Annotated[str, typer.Option(help="address to listen at; other than this computer's own needs TLS and passwords")]
Port = Annotated[int, typer.Option(min=0, max=65535, help="0: a free one")]
Names = Annotated[list[str] | None, typer.Option("--name", help="a host name by which browsers ask for the pages")]
Language = Annotated[Literal["en", "de"], typer.Option(help="of a browser that asks for none of these")]
Certificate = Annotated[str | None, typer.Option(help="of TLS, a PEM file")]
Key = Annotated[str | None, typer.Option(help="of the certificate, a PEM file")]
Passwords = Annotated[str | None, typer.Option(help="file of users, made by drawbar console-user")]
Audit = Annotated[str | None, typer.Option(help="file to which is added who asked for what")]


def console(
    host: Host = "127.0.0.1",
    port: Port = 8080,
    name: Names = None,
    language: Language = "en",
    certificate: Certificate = None,
    key: Key = None,
    passwords: Passwords = None,
    audit: Audit = None,
    drive: Annotated[Path | None, typer.Option(help="folder of the drive's sockets; default: the newest drive")] = None,
) -> None:
    """Serve the operator's pages for a drive that is on already; `drawbar drive --console` does both."""
    from drawbar.driving.orders import CONSOLE, ORDERS_NAME, Orders

    folder = drive or _newest_drive()
    try:
        known = Orders.model_validate_json((folder / ORDERS_NAME).read_text("utf-8"))
    except (OSError, ValueError):
        known = None
    if known is None or not _is_on(folder):
        raise HardwareError(f"{folder} is not the folder of a drive that is on; start one with drawbar drive")
    if Path(known.socket(CONSOLE)).exists():
        raise HardwareError(f"the drive in {folder} has a console already; open that one, or end it")
    orders = console_orders(
        runs=str(Path(known.run).parent),
        folder=known.folder,
        configuration=known.configuration,
        stand_ins=known.stand_ins,
        host=host,
        port=port,
        name=name,
        language=language,
        certificate=certificate,
        key=key,
        passwords=passwords,
        audit=audit,
    )
    terminal.print(f"the console is at {address(orders)}; Ctrl-C ends it, and not the drive", soft_wrap=True)
    try:
        code = subprocess.run(
            [sys.executable, "-m", "drawbar.console.console_main"], input=orders.model_dump_json().encode(), check=False
        ).returncode
    except KeyboardInterrupt:
        code = 0
    raise SystemExit(code)


def console_user(
    file: Annotated[Path, typer.Argument(help="of the users; a new one is made readable for you alone")],
    name: Annotated[str, typer.Argument(help="of the user")],
    rank: Annotated[
        Literal["viewer", "operator", "maintainer"], typer.Option(help="what the user may do")
    ] = "operator",
) -> None:
    """Add a user of the console, or give one a new password, which is asked for."""
    from drawbar.console.passwords import save_user
    from drawbar.console.visitors import Rank

    password = typer.prompt("password", hide_input=True, confirmation_prompt=True)
    save_user(file, name, Rank[rank.upper()], password)
    terminal.print(f"{file}: {name} is {rank}; a running console knows it after its next start")


def console_orders(*, host: str, port: int, name: list[str] | None, **others: str | bool | None) -> "ConsoleOrders":
    """Return a console's orders.

    Args:
        host: address to listen at.
        port: to listen at; 0: a free one.
        name: host names by which browsers ask for the pages.
        others: fields of ConsoleOrders.

    Raises:
        ConfigurationError: the console cannot or must not be started so.
    """
    from importlib.util import find_spec

    from drawbar.console.passwords import load_users
    from drawbar.driving.console_orders import ConsoleOrders
    from drawbar.extras import install_command

    missing = [name for name in ("nicegui", "pyproj", "shapefile", "shapely") if find_spec(name) is None]
    if missing:
        raise ConfigurationError(
            f"the console needs what is not installed here ({', '.join(missing)}); install it with: "
            f"{install_command('console')}"
        )
    place = {"host": host, "port": free_port(host, port), "names": tuple(name or ())}
    orders = ConsoleOrders.model_validate(others | place)
    orders.check()
    if orders.passwords is not None:
        load_users(Path(orders.passwords))
    return orders


def address(orders: "ConsoleOrders") -> str:
    """Return where a browser finds the console."""
    host = f"[{orders.host}]" if ":" in orders.host else orders.host
    return f"http{'s' if orders.certificate else ''}://{host}:{orders.port}/"


def free_port(host: str, port: int = 0) -> int:
    """Return a port that nobody uses now; 0: any.

    Raises:
        HardwareError: the address is not one of this computer, or the port is taken.
    """
    import socket

    kind = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        with socket.socket(kind, socket.SOCK_STREAM) as each:
            each.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as the server does: a port just given back
            each.bind((host, port))
            return int(each.getsockname()[1])
    except OSError as error:
        raise HardwareError(
            f"{host}:{port} cannot be listened at ({error.strerror}); give an address of this computer and a free port"
        ) from None


def _is_on(folder: Path) -> bool:
    """Return whether the gate of the drive in a folder is there; a drive that was killed leaves its folder."""
    import socket

    from drawbar.driving.orders import GATE

    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as each:
        try:
            each.connect(str(folder / GATE))
        except OSError:
            return False
    return True


def _newest_drive() -> Path:
    from drawbar.driving.orders import ORDERS_NAME

    written = Path(tempfile.gettempdir()).glob(f"drawbar-*/{ORDERS_NAME}")
    found = [each for each in written if each.is_file() and _is_on(each.parent)]
    if not found:
        raise HardwareError("no drive is on; start one with drawbar drive --console")
    return max(found, key=lambda each: each.stat().st_mtime).parent
