"""`drawbar export`: write the controller as a C library."""

from pathlib import Path as FilePath
from typing import Annotated

import typer

from drawbar.cli.options import ConfigurationName, changing, console, written
from drawbar.export.targets import TARGETS, Precision, find_target


def export(
    configuration: ConfigurationName,
    out: Annotated[FilePath, typer.Option(parser=written, metavar="PATH", help="folder for the library")],
    targets: Annotated[
        list[str] | None,
        typer.Option("--target", metavar="TARGET", help=f"build for {', '.join(target.name for target in TARGETS)}"),
    ] = None,
    precision: Annotated[
        Precision,
        typer.Option(help="of the library's numbers; single: float, for a processor with a unit for these alone"),
    ] = Precision.DOUBLE,
    changes: Annotated[list[str] | None, changing("speed=0.8")] = None,
) -> None:
    """Write the controller as a C library that needs neither Python nor an operating system."""
    machines = [find_target(name) for name in targets or []]

    from drawbar.config import load_configuration
    from drawbar.export.export import export_library

    config = load_configuration(configuration, changes or [])
    with console.status("writing and building the library …"):
        export_library(config, out, machines, precision)
    console.print(out / "README.md", soft_wrap=True)
