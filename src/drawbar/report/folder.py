"""Folder of a run: what a run leaves in it besides the log, all of it made from the log alone."""

import errno
import os
from dataclasses import replace
from pathlib import Path

from drawbar.driving.evaluation.engageable import read_engageable
from drawbar.errors import DrawbarError, StorageError, demand_path
from drawbar.recording.columns import read_columns
from drawbar.recording.drive_events import DriveEvent, drive_events
from drawbar.recording.drive_records import is_drive
from drawbar.recording.log import LOG_NAME
from drawbar.report.metrics import Metrics, compute_metrics
from drawbar.report.page import render_page
from drawbar.report.path_errors import estimated_path_errors, true_path_errors
from drawbar.report.picture import render_picture
from drawbar.report.shadow import compare

REPORT_NAMES = ("metrics.json", "report.html", "map.svg")
_FULL = (errno.ENOSPC, errno.EDQUOT)


def write_report(folder: str | os.PathLike[str], log_file: str | os.PathLike[str] | None = None) -> Metrics:
    """Read the log in a run's folder, or another, and write metrics.json, report.html and map.svg into the folder.

    The folder is made where it is missing, once the log has been read.

    Returns the metrics. Works for a run that crashed or was killed.

    Raises:
        DrawbarError: the log cannot be read.
        StorageError: a file cannot be written; what was there before is still there.
    """
    folder = demand_path("folder", folder)
    file = demand_path("log_file", log_file or folder / LOG_NAME)
    log = read_columns(file)
    errors = true_path_errors(log)
    metrics = compute_metrics(log, errors if log.has_truth else estimated_path_errors(log))
    events, shadow = list[DriveEvent](), None
    try:
        events = drive_events(file) if is_drive(file) else []
        shadow = compare(log, read_engageable(file)) if log.header.shadow else None
    except DrawbarError as error:  # the figures are worth a report by themselves
        metrics = replace(metrics, losses=(*metrics.losses, f"what happened cannot be told: {error}"))
    metrics = replace(metrics, shadow=None if shadow is None else shadow.metrics())
    picture = render_picture(log, errors).encode()
    contents = (metrics.to_json(), render_page(log, metrics, errors, events, shadow).encode(), picture)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in zip(REPORT_NAMES, contents, strict=True):
            _write_whole(folder / name, content)
    except OSError as error:
        again = f"free space, then `drawbar report {file}`, or " if error.errno in _FULL else ""
        raise StorageError(
            f"{folder}: the report cannot be written ({error.strerror}); the log is kept: {again}choose another "
            f"folder, `drawbar report {file} --out FOLDER`"
        ) from error
    return metrics


def _write_whole(file: Path, content: bytes) -> None:
    """Write a file that is there as a whole or not at all."""
    part = file.with_name(file.name + ".part")
    try:
        part.write_bytes(content)
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)
