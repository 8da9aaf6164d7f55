"""`drawbar config` and `drawbar events`: what a configuration may hold."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated

import typer
from rich.padding import Padding
from rich.text import Text

from drawbar.cli.options import changing, console
from drawbar.configurations import shipped_names

if TYPE_CHECKING:
    from drawbar.report.keys import Key, Section


def config(
    name: Annotated[
        str,
        typer.Argument(
            metavar="CONFIG",
            help=f"show the values of a TOML file or shipped name: {', '.join(shipped_names())}; "
            f"without it all keys with their defaults",
        ),
    ] = "",
    changes: Annotated[list[str] | None, changing("vehicle.wheelbase=1.5")] = None,
    toml: Annotated[bool, typer.Option("--toml", help="print the complete configuration as TOML instead")] = False,
) -> None:
    """Show every key of a configuration: default or value, unit, what is allowed, and what it means."""
    from drawbar.config import load_configuration
    from drawbar.report.keys import sections

    if not name and (toml or changes):
        raise typer.BadParameter("--toml and --set need a configuration")
    configuration = load_configuration(name, changes or []) if name else None
    if toml and configuration is not None:
        typer.echo(configuration.to_toml(), nl=False)
        return
    _show(sections(configuration))


def events() -> None:
    """Show what may happen to the simulated machine: faults of the ground and of the GPS, for machine.events."""
    from drawbar.report.keys import events

    _show(events())
    console.print(
        "\ndrawbar run --set 'machine.events=[{kind=\"gps_loss\", start=30.0, duration=5.0}]'", soft_wrap=True
    )


def _show(sections: "Iterable[Section]") -> None:
    for section in sections:
        title = f"[{section.name}]" if section.name else "outside of all sections"
        console.print(Text.assemble("\n", (title, "bold cyan"), "  " if section.variant else "", section.variant))
        console.print(Padding(Text(section.meaning, "italic"), (0, 0, 0, 2), expand=False))
        for key in section.keys:
            console.print(Padding(_line(key), (0, 0, 0, 2), expand=False))
            if key.meaning:
                console.print(Padding(Text(key.meaning), (0, 0, 0, 6), expand=False))


def _line(key: "Key") -> Text:
    name = key.name.rpartition(".")[2]
    unit = f" {key.unit}" if key.unit else ""
    value = f" = {key.default}{unit}" if key.default else f"{unit} must be given"
    return Text.assemble((name, "bold"), value, (f"   ({key.allowed})" if key.allowed else "", "bright_black"))
