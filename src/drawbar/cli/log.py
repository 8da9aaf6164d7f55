"""`drawbar log export`: a log for other programs."""

from collections.abc import Callable
from functools import partial
from itertools import combinations
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated

import typer

from drawbar.cli.options import RunLogFile, refuse_to_replace, warnings, written
from drawbar.cli.whole_files import write_whole
from drawbar.errors import DrawbarError

if TYPE_CHECKING:
    from drawbar.recording.log import RunLog

log = typer.Typer(help="Logs for other programs.", no_args_is_help=True)


@log.callback()
def group() -> None:
    """Write logs for other programs."""


@log.command()
def export(
    file: RunLogFile,
    csv: Annotated[
        FilePath | None, typer.Option(parser=written, metavar="PATH", help="table of all numbers of all steps")
    ] = None,
    ros2: Annotated[
        FilePath | None, typer.Option(parser=written, metavar="PATH", help="MCAP with standard ROS 2 messages")
    ] = None,
    geojson: Annotated[
        FilePath | None, typer.Option(parser=written, metavar="PATH", help="path and tracks in WGS84")
    ] = None,
) -> None:
    """Write a log's content in other formats; standard output is free for --csv /dev/stdout."""
    from drawbar.recording.log import read_log

    chosen = {"--csv": csv, "--ros2": ros2, "--geojson": geojson}
    targets = [(option, target) for option, target in chosen.items() if target is not None]
    if not targets:
        raise typer.BadParameter("give at least one of --csv FILE, --ros2 FILE, --geojson FILE")
    for option, target in targets:
        refuse_to_replace(option, target, file)
    for (first, one), (second, other) in combinations(targets, 2):
        if one.absolute() == other.absolute():
            raise DrawbarError(f"{first} {one} and {second} {other}: are one file; give each its own.")
    writers = [(target, _writer(option, file)) for option, target in targets]
    content = read_log(file)
    for shortcoming in content.shortcomings:
        warnings.print(f"{file}: {shortcoming}", style="bold yellow", soft_wrap=True)
    for target, write in writers:
        try:
            write_whole(target, partial(write, content))
        except BrokenPipeError:
            continue  # its reader, such as head, has what it wanted
        except OSError as error:
            raise DrawbarError(f"{target}: cannot be written ({error.strerror}); choose another file") from error
        if target.is_file():
            warnings.print(str(target), soft_wrap=True)


def _writer(option: str, log: FilePath) -> Callable[["RunLog", FilePath], None]:
    if option == "--csv":
        from drawbar.recording.table import write_csv

        return write_csv
    if option == "--geojson":
        from drawbar.recording.tracks import write_geojson

        return write_geojson
    from drawbar.extras import require_extra

    require_extra("--ros2", "machine")
    from drawbar.recording.ros2 import write_ros2  # imports the extra

    return partial(write_ros2, log)
