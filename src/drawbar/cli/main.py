"""The program: puts the commands together and turns every expected error into one message."""

import errno
import inspect
import sys
from collections.abc import Callable
from typing import Annotated

import typer
from rich.console import Console
from rich.text import Text

from drawbar.cli.bench import bench
from drawbar.cli.calibrate import calibrate, identify
from drawbar.cli.check import check
from drawbar.cli.config import config, events
from drawbar.cli.console import console, console_user
from drawbar.cli.drive import drive
from drawbar.cli.experiment import experiment
from drawbar.cli.export import export
from drawbar.cli.log import log
from drawbar.cli.path import path
from drawbar.cli.replay import replay
from drawbar.cli.report import report
from drawbar.cli.run import run
from drawbar.cli.stand_in import stand_in
from drawbar.cli.tube import tube
from drawbar.cli.tune import tune
from drawbar.cli.version import version_text
from drawbar.errors import DrawbarError
from drawbar.terminal import degrade_output, discard, open_what_is_closed

app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EIO)
"""what is wrong where output cannot be written; such an error names no file"""
DRIVING = (run, drive, console, check, calibrate, stand_in)
LOOKING = (report, replay, identify, config, events, tube, path, export, bench, experiment, tune)


def _paragraphs(command: Callable[..., None]) -> str:
    """Return a command's docstring with a line for each paragraph: typer breaks lines where the source does."""
    return "\n\n".join(" ".join(each.split()) for each in (inspect.getdoc(command) or "").split("\n\n"))


for command in (*DRIVING, *LOOKING):
    app.command(help=_paragraphs(command))(command)
app.command("console-user", help=_paragraphs(console_user))(console_user)
app.add_typer(log, name="log")


@app.callback(invoke_without_command=True)
def program(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="print the version")] = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", help="with --version: also Python, platform, C compiler and cache folder")
    ] = False,
) -> None:
    """An autopilot that keeps a tractor and its trailer on the line."""  # noqa: D401 -- the program's help text
    if version:
        typer.echo(version_text(verbose=verbose))
        raise typer.Exit
    if verbose:
        raise typer.BadParameter("goes with --version", param_hint="--verbose")
    if context.invoked_subcommand is None:
        context.fail("Missing command.")


def _show(error: str) -> None:
    message = Text.assemble(("error:", "bold red"), f" {error}")
    Console(stderr=True, highlight=False).print(message, soft_wrap=True)


def main() -> None:
    """Run the command line; every expected error is one message and exit code 2, an interrupt one line and 130."""
    open_what_is_closed()
    degrade_output()
    try:
        try:
            app(prog_name="drawbar")
        finally:
            sys.stdout.flush()  # what cannot be written is reported here, not when Python ends
    except DrawbarError as error:
        _show(str(error))
        sys.exit(2)
    except BrokenPipeError:  # its reader, such as head, has what it wanted
        discard(sys.__stdout__ or sys.stdout)
    except OSError as error:
        if error.filename is None and error.errno not in _FULL:
            raise
        _show(f"{error.filename or 'output cannot be written'}: {error.strerror}")
        if error.filename is None:
            discard(sys.stdout)  # what is left of it is not tried again when Python ends
        sys.exit(2)
    except SystemExit as end:
        if isinstance(end.__context__, BrokenPipeError):  # met while typer printed
            discard(sys.__stdout__ or sys.stdout)
            return
        if isinstance(end.__context__, typer.Exit) and isinstance(end.__context__.__cause__, KeyboardInterrupt):
            typer.echo("interrupted", err=True)
        raise
