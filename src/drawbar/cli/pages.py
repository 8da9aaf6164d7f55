"""Pages: how the operator's pages are served, options of `drawbar console` and `drawbar drive --console` alike."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import wraps
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from drawbar.errors import HardwareError

if TYPE_CHECKING:
    from drawbar.driving.messaging.console_options import ConsoleOptions

_HOST = typer.Option(help="address to listen at; other than this computer's own needs TLS and passwords")


@dataclass(frozen=True, slots=True, kw_only=True)
class Pages:
    """The options; each field is one."""

    host: Annotated[str, _HOST] = "127.0.0.1"
    port: Annotated[int, typer.Option(min=0, max=65535, help="0: a free one")] = 8080
    name: Annotated[list[str] | None, typer.Option(help="a host name by which browsers ask for the pages")] = None
    language: Annotated[Literal["en", "de"], typer.Option(help="of a browser that asks for none of these")] = "en"
    certificate: Annotated[str | None, typer.Option(help="of TLS, a PEM file")] = None
    key: Annotated[str | None, typer.Option(help="of the certificate, a PEM file")] = None
    passwords: Annotated[str | None, typer.Option(help="file of users, made by drawbar console-user")] = None
    audit: Annotated[str | None, typer.Option(help="file to which is added who asked for what")] = None

    def options(self, *, folder: str, configuration: str, runs: str, stand_ins: bool = False) -> "ConsoleOptions":
        """Return the options of a console that serves the pages of a drive; the arguments are as in ConsoleOptions.

        Raises:
            ConfigurationError: the console must not be started so.
            DrawbarError: what the console needs is not installed.
            HardwareError: the address is not one of this computer, or the port is taken.
        """
        from drawbar.console.passwords import load_users
        from drawbar.driving.messaging.console_options import ConsoleOptions
        from drawbar.extras import require_extra

        require_extra("the console", "console")
        given = asdict(self)
        given |= {"names": tuple(given.pop("name") or ()), "port": free_port(self.host, self.port)}
        options = ConsoleOptions(folder=folder, configuration=configuration, runs=runs, stand_ins=stand_ins, **given)
        options.check()
        if options.passwords is not None:
            load_users(Path(options.passwords))
        return options


def takes_pages(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command that has the fields of Pages as options, in place of its last parameter, `pages`."""
    options = signature(Pages).parameters
    own = [each for each in signature(command).parameters.values() if each.name != "pages"]

    @wraps(command)
    def flat(**given: Any) -> None:
        pages = Pages(**{name: given.pop(name) for name in options})
        command(**given, pages=pages)

    flat.__signature__ = signature(command).replace(parameters=[*own, *options.values()])  # type: ignore[attr-defined]
    return flat


def address(options: "ConsoleOptions") -> str:
    """Return where a browser finds the console."""
    host = f"[{options.host}]" if ":" in options.host else options.host
    return f"http{'s' if options.certificate else ''}://{host}:{options.port}/"


def free_port(host: str, port: int = 0, *, of: str = "the console") -> int:
    """Return a port that nobody uses now; 0: any.

    Args:
        host: address that is listened at.
        port: that is wanted.
        of: who is to listen, for the message.

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
            f"{of} cannot listen at {host}:{port} ({error.strerror}); give an address of this computer and a free port"
        ) from None
