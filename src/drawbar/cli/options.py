"""Options and arguments that several commands share, and the console."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from json import dumps
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated

import typer
from typer.models import OptionInfo

from drawbar.configurations import shipped_names
from drawbar.errors import DrawbarError
from drawbar.terminal import Output, forget_typed
from drawbar.transports.clock import FASTEST

if TYPE_CHECKING:
    from drawbar.config import Configuration

console = Output(highlight=False, markup=False)  # names of files and lines may hold brackets
warnings = Output(stderr=True, highlight=False, markup=False)
"""standard error: what is printed beside a result that another program may read"""

ConfigurationName = Annotated[
    str, typer.Argument(metavar="CONFIG", help=f"TOML file or shipped name: {', '.join(shipped_names())}")
]


def _log_of(run: FilePath | None) -> FilePath | None:
    """Return the log of a run that is given by its folder or by the log itself."""
    from drawbar.recording.log import log_of

    return None if run is None else log_of(run)


_RUN_LOG = typer.Argument(metavar="RUN", callback=_log_of, help="folder of a run or a drive, or its log.mcap")
RunLogFile = Annotated[FilePath, _RUN_LOG]
RunLogFileIfAny = Annotated[FilePath | None, _RUN_LOG]
Jobs = Annotated[int | None, typer.Option(min=1, help="processes on this machine; default: one per core")]
Pace = Annotated[
    int, typer.Option(min=1, max=FASTEST, help="of stand-ins on this computer: so many times as fast as real time")
]
Track = Annotated[str, typer.Option(help="name of the line, where the file holds several")]
Cluster = Annotated[str, typer.Option(metavar="ADDRESS", help="of a running Dask scheduler to use instead")]


def changing(example: str) -> OptionInfo:
    """Return the option --set KEY=VALUE of a command, with an example."""
    option: OptionInfo = typer.Option("--set", metavar="KEY=VALUE", help=f"change one value, e.g. {example}")
    return option


def written(text: str) -> FilePath:
    """Return the path of what is to be written; "" would be the working directory, "-" a file of that name."""
    if not text:
        raise typer.BadParameter("is empty; name a file or folder, or leave the option out")
    if text == "-":
        raise typer.BadParameter("'-': is no name here; name a file or folder, /dev/stdout for standard output")
    return FilePath(text)


def agreed(*questions: str) -> bool:
    """Ask the operator before something is moved; return whether every answer is yes.

    What was typed before a question was asked answers none; Ctrl-C and the end of the input are a no. A program that
    answers is no operator: without a terminal nobody is asked.
    """
    try:
        agrees = is_asked() and all(_confirmed(question) for question in questions)
    except typer.Abort:
        console.print()  # the answer's line has not ended
        agrees = False
    if not agrees:
        console.print("nothing was moved")
    return agrees


def is_asked() -> bool:
    """Return whether somebody can be asked; say it where nobody can."""
    asked = sys.stdin.isatty()
    if not asked:
        console.print(
            "a person answers before something moves: run it at a terminal, without a pipe (with ssh: ssh -t)"
        )
    return asked


def _confirmed(question: str) -> bool:
    forget_typed()
    return typer.confirm(question)


def configured(source: str, path: str | None, track: str, changes: Sequence[str]) -> "Configuration":
    """Return a configuration with the line that --path (None: its own) and --track (empty: none) name, then changes.

    Raises DrawbarError for an empty path and for a track without a file, ConfigurationError as load_configuration.
    """
    from drawbar.config import load_configuration

    settings = line_changes(path, track)
    if track and not path and not load_configuration(source, changes).path.file:
        raise DrawbarError(f"--track {track}: there is no file with lines; give --path too, or leave --track out.")
    return load_configuration(source, [*settings, *changes])


def configured_devices(name: str, changes: Sequence[str] | None) -> "Configuration":
    """Return a configuration that names devices; raise ConfigurationError for one that does not."""
    from drawbar.config import load_configuration
    from drawbar.errors import ConfigurationError

    config = load_configuration(name, changes or [])
    if config.devices is None:
        raise ConfigurationError(
            f"{name} names no devices; add a section [devices] (docs/driving.md), or try `drawbar drive`, which "
            "stands in for all of them"
        )
    return config


def line_changes(path: str | None, track: str) -> list[str]:
    """Return the changes of a configuration that choose a line by --path (None: its own) and --track (empty: none)."""
    if path == "":
        raise DrawbarError("--path is empty; give a file or a field folder, or leave --path out.")
    given = (("path.file", path), ("path.track", track))
    # a JSON string is a TOML string
    return [f"{key}={dumps(text, ensure_ascii=False)}" for key, text in given if text]


@contextmanager
def compiling() -> Iterator[None]:
    """Show on the console that, and how far, something is compiled; in a file or pipe one line, where it is."""
    from drawbar.codegen import watch_compilation

    if not console.is_terminal:
        with watch_compilation(lambda done, _: None if done else console.print("compiling the control step, once …")):
            yield
        return
    text = "making the control step ready, the first time by compiling it …"
    with console.status(text) as status, watch_compilation(lambda *of: status.update(f"{text} {of[0]} of {of[1]}")):
        yield


@contextmanager
def continued_later() -> Iterator[None]:
    """Let Ctrl-C end a command that continues from its finished runs when it is given again; exit code 130."""
    try:
        yield
    except KeyboardInterrupt:
        console.print("\ninterrupted; the same command continues from the runs that are finished")
        raise SystemExit(130) from None


def refuse_to_replace(option: str, target: FilePath, given: FilePath) -> None:
    """Raise DrawbarError where a file that is to be written is one that is read, by whatever name.

    Args:
        option: that names the target.
        target: to be written.
        given: to be read.
    """
    if target.exists() and given.exists() and target.samefile(given):
        raise DrawbarError(f"{option} {target}: would overwrite {given}, which is read; choose another file.")


def one_cluster(jobs: int | None, cluster: str) -> None:
    """Raise DrawbarError where both a number of processes and a running cluster are chosen."""
    if jobs and cluster:
        raise DrawbarError(
            f"--jobs {jobs} and --cluster {cluster}: a running cluster has its own workers; leave one out."
        )
