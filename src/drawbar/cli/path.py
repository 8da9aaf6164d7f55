"""`drawbar path`: a configuration's path, or a recorded line made drivable, as the table that the C library takes."""

from pathlib import Path as FilePath
from typing import Annotated

import typer

from drawbar.cli.options import ConfigurationName, Track, changing, configured, console, refuse_to_replace, written
from drawbar.cli.whole_files import write_whole
from drawbar.errors import DrawbarError


def path(
    configuration: ConfigurationName,
    out: Annotated[
        FilePath, typer.Option(parser=written, metavar="PATH", help="file for the table: .csv, or .h for a C array")
    ],
    line: Annotated[
        str | None,
        typer.Option("--path", help="recorded line: AgOpenGPS field folder, CSV (x,y) or GeoJSON; default: its own"),
    ] = None,
    track: Track = "",
    changes: Annotated[list[str] | None, changing("path.extension=250")] = None,
) -> None:
    """Write a line, made drivable for a configuration's vehicle, as the path table of the C library."""
    from drawbar.export.recording import path_array, path_table
    from drawbar.recording.header import path_notes
    from drawbar.simulation import build_path

    tables = {".csv": path_table, ".h": path_array}
    write = tables.get(out.suffix.lower())
    if write is None:
        raise DrawbarError(f"--out {out}: give a file that ends with {' or '.join(tables)}.")
    config = configured(configuration, line, track, changes or [])
    if config.path.file:
        refuse_to_replace("--out", out, FilePath(config.path.file))
    driven, drivable = build_path(config)
    for note in path_notes(config, driven, drivable):
        console.print(note, soft_wrap=True)
    table = write(driven)
    try:
        write_whole(out, lambda file: file.write_text(table, "utf-8"))
    except OSError as error:
        raise DrawbarError(f"{out}: cannot be written ({error.strerror}); choose another --out file.") from error
    console.print(f"{out}: {len(driven.nodes)} nodes, {driven.length:.1f} m", soft_wrap=True)
