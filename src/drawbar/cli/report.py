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
    show_and_write(log, out or log.parent)


def show_and_write(log: FilePath, folder: FilePath) -> None:
    """Print the figures of a run, then write its report: they are shown though the folder takes nothing."""
    from drawbar.report.console import summary
    from drawbar.report.folder import make_report

    made = make_report(log)
    console.print(summary(made.metrics))
    made.write(folder)
    console.print(f"\n{folder / 'report.html'}", soft_wrap=True)
