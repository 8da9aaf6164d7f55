"""`drawbar report`: make the report of a run again from its log, whole or cut."""

from pathlib import Path as FilePath
from typing import Annotated

import typer

from drawbar.cli.options import RunLogFile, console, written


def report(
    log: RunLogFile,
    out: Annotated[
        FilePath | None,
        typer.Option(parser=written, metavar="PATH", help="folder for the report; default: beside the log"),
    ] = None,
) -> None:
    """Make report, metrics and map of a run from its log; a log that a crash or a full disk cut off will do."""
    from drawbar.report.console import summary
    from drawbar.report.folder import write_report

    folder = out or log.parent
    console.print(summary(write_report(folder, log)))
    console.print(f"\n{folder / 'report.html'}", soft_wrap=True)
