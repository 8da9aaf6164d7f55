"""`drawbar drive`: drive a real machine, or stand-ins of all its devices on this computer."""

import time
from contextlib import ExitStack, nullcontext
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated

import typer

from drawbar.cli.console import (
    Audit,
    Certificate,
    Host,
    Key,
    Language,
    Names,
    Passwords,
    Port,
    address,
    console_orders,
    free_port,
)
from drawbar.cli.options import ConfigurationName, console

LOCAL = "127.0.0.1"

if TYPE_CHECKING:
    from drawbar.cli.interrupts import Interrupts
    from drawbar.config import Configuration
    from drawbar.driving.console_orders import ConsoleOrders
    from drawbar.driving.crew import Crew


def drive(
    configuration: ConfigurationName = "articulated",
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="change one value, e.g. speed=0.8"),
    ] = None,
    out: Annotated[FilePath | None, typer.Option(help="folder for log and report; default: a new one in runs/")] = None,
    by_hand: Annotated[
        bool, typer.Option("--by-hand", help="with stand-ins: engage by the keys, as on a machine")
    ] = False,
    shadow: Annotated[
        bool, typer.Option("--shadow", help="steer nothing: tell what would have been done beside what the driver does")
    ] = False,
    live: Annotated[
        bool, typer.Option("--live", help="show the log while it grows, to Foxglove on this computer")
    ] = False,
    live_port: Annotated[int, typer.Option(min=0, max=65535, help="of --live; 0: a free one")] = 8765,
    seconds: Annotated[float, typer.Option(min=0.0, help="end after so long, s; 0: when told to")] = 0.0,
    with_console: Annotated[
        bool, typer.Option("--console", help="serve the operator's pages, and engage there")
    ] = False,
    host: Host = "127.0.0.1",
    port: Port = 8080,
    name: Names = None,
    language: Language = "en",
    certificate: Certificate = None,
    key: Key = None,
    passwords: Passwords = None,
    audit: Audit = None,
) -> None:
    """Drive the machine that the configuration's devices name; without devices, stand-ins on this computer."""
    from drawbar.cli.interrupts import Interrupts
    from drawbar.driving.crew import Crew

    config, stand_ins = _configured(configuration, changes or [])
    orders = None
    if with_console:
        orders = console_orders(
            folder="",  # this and the next: known to the crew
            configuration="",
            runs=str(out.parent if out else "runs"),
            host=host,
            port=port,
            name=name,
            language=language,
            certificate=certificate,
            key=key,
            passwords=passwords,
            audit=audit,
        )
    shown = _shown_at(live_port) if live else None
    folder = _new_folder(out, config)
    demonstrates = stand_ins and not (by_hand or shadow or with_console)
    with Interrupts() as interrupts:
        crew = Crew(config, folder, stand_ins=stand_ins, shadow=shadow, live=shown, console=orders)
        failed = _run(crew, orders, interrupts, demonstrates=demonstrates, seconds=seconds)
        _report(folder, shadow=shadow)
    if failed:
        raise SystemExit(1)


def _configured(name: str, changes: list[str]) -> tuple["Configuration", bool]:
    """Return what to drive, its control step compiled, and whether all of its devices are stand-ins."""
    from drawbar.config import load_configuration
    from drawbar.driving.controller import Controller
    from drawbar.driving.demonstration import with_stand_ins
    from drawbar.simulation import build_path

    config = load_configuration(name, changes)
    stand_ins = config.devices is None
    if stand_ins:
        config = with_stand_ins(config)
        console.print("no [devices] are configured: driving stand-ins of all of them on this computer, in real time")
    with console.status("compiling the control step (the first time only) …"):
        Controller(config, build_path(config)[0], config.safety.fingerprint())
    return config, stand_ins


def _run(
    crew: "Crew", orders: "ConsoleOrders | None", interrupts: "Interrupts", *, demonstrates: bool, seconds: float
) -> bool:
    """Start the processes and show the drive; return whether it failed."""
    with ExitStack() as started:
        with console.status("starting the processes …"):
            started.enter_context(crew)
        if orders is not None:
            console.print(f"the console is at {address(orders)}", soft_wrap=True)
        return _drive(crew, interrupts, demonstrates=demonstrates, seconds=seconds)


def _shown_at(port: int) -> int:
    """Return the port on which Foxglove finds the drive, and say so."""
    chosen = free_port(LOCAL, port)
    console.print(f"live: open ws://{LOCAL}:{chosen} in Foxglove", soft_wrap=True)
    return chosen


def _report(folder: FilePath, *, shadow: bool) -> None:
    """Write the report, and tell what there is to tell at the end."""
    from drawbar.driving.shadow import COMPARED, steering_differences, tell
    from drawbar.recording.columns import read_columns
    from drawbar.recording.log import LOG_NAME
    from drawbar.report.console import summary
    from drawbar.report.folder import write_report

    console.print(summary(write_report(folder)))
    if shadow:
        for difference in steering_differences(read_columns(folder / LOG_NAME, COMPARED)):
            console.print(tell(difference), soft_wrap=True)
    console.print(f"\n{folder / 'report.html'}", soft_wrap=True)


def _drive(crew: "Crew", interrupts: "Interrupts", *, demonstrates: bool, seconds: float) -> bool:
    """Show the drive until it is over; return whether it failed."""
    from rich.live import Live

    from drawbar.driving.crew import LOSSES
    from drawbar.driving.display import headline, picture
    from drawbar.driving.front_end import FrontEnd, Keyboard
    from drawbar.driving.orders import CONSOLE
    from drawbar.messages import SupervisorState

    front, end = FrontEnd(crew, demonstrates=demonstrates), time.monotonic() + (seconds or float("inf"))
    live = Live(console=console, auto_refresh=False, transient=True) if console.is_terminal else None
    told: SupervisorState | None = None
    lost: list[str] = []
    try:
        with live or nullcontext(), Keyboard() as keyboard:
            while time.monotonic() < end and not (demonstrates and front.is_over):
                front.wait(0.05)
                interrupts.heed()
                keys = keyboard.pressed()
                for key in keys:
                    front.press(key)
                if "q" in keys:
                    break
                if front.state is not None and front.state.state is not told:
                    told = front.state.state
                    console.print(headline(front.state))
                if live is not None:
                    live.update(picture(front.state, front.controller, front.refusal), refresh=True)
                lost, before = crew.ended(), lost
                spared = LOSSES if front.drove else {CONSOLE: LOSSES[CONSOLE]}  # nothing engages without a recorder
                if not spared.keys() >= set(lost):
                    console.print(f"ended: {', '.join(lost)}: {crew.words()}", style="bold red")
                    return True
                for name in set(lost).difference(before):
                    console.print(f"{LOSSES[name]}: {crew.words()}", style="bold red", soft_wrap=True)
    except KeyboardInterrupt:
        console.print("interrupted: the gate lets go of the steering")
    finally:
        front.close()
    return front.state is not None and front.state.state in (SupervisorState.FAULT, SupervisorState.ESTOP)


def _new_folder(chosen: FilePath | None, config: "Configuration") -> FilePath:
    """Return a new folder with config.toml in it."""
    from drawbar.errors import DrawbarError

    folder = chosen or FilePath("runs") / time.strftime(f"{config.name}-drive-%Y%m%d-%H%M%S")
    try:
        folder.mkdir(parents=True)
        (folder / "config.toml").write_text(config.to_toml(), "utf-8")
    except FileExistsError as error:
        raise DrawbarError(f"{folder} is there already; choose another --out folder") from error
    except OSError as error:
        raise DrawbarError(f"{folder}: cannot be written ({error.strerror}); choose another --out folder") from error
    return folder
