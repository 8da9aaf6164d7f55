"""`drawbar tube`: compute, print and draw the robust sets of a configuration."""

from pathlib import Path as FilePath
from typing import Annotated

import typer

from drawbar.cli.options import ConfigurationName, changing, console, written


def tube(
    configuration: ConfigurationName = "articulated",
    changes: Annotated[list[str] | None, changing("tube.nominal=propagated")] = None,
    logs: Annotated[
        list[FilePath] | None,
        typer.Option("--from-log", metavar="RUN.mcap", help="compare a recorded run with the declared bounds"),
    ] = None,
    out: Annotated[
        FilePath | None,
        typer.Option(parser=written, metavar="PATH", help="folder for the pictures; default: runs/NAME-tube"),
    ] = None,
) -> None:
    """Compute the invariant sets of both bodies and what they leave of every bound."""
    from drawbar.config import load_configuration
    from drawbar.report.tube.command import show_tubes

    config = load_configuration(configuration, changes or [])
    if not show_tubes(console, config, out or FilePath("runs") / f"{config.name}-tube", logs or []):
        raise SystemExit(1)
