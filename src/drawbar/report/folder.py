"""Folder of a run: what a run leaves in it besides the log, all of it made from the log alone."""

import errno
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """The report of a run, before any of it is written."""

    log_file: Path
    metrics: Metrics
    contents: Mapping[str, bytes]
    """by name of file"""

    def write(self, folder: Path) -> None:
        """Write all files into a folder, each whole or not at all; it is made where it is missing.

        Raises:
            StorageError: some cannot be written; what was there before is still there, and the others are written.
        """
        failed: dict[str, OSError] = {}
        for name, content in self.contents.items():
            try:
                folder.mkdir(parents=True, exist_ok=True)
                _write_whole(folder / name, content)
            except OSError as error:
                failed[name] = error
        if failed:
            raise self._not_written(folder, failed)

    def _not_written(self, folder: Path, failed: Mapping[str, OSError]) -> StorageError:
        """Return what to tell of files that cannot be written."""
        reasons = {error.strerror: error for error in failed.values()}
        is_full = any(error.errno in _FULL for error in reasons.values())
        again = f"free space, then `drawbar report {self.log_file}`, or " if is_full else ""
        return StorageError(
            f"{folder}: the report's {', '.join(failed)} cannot be written ({', '.join(map(str, reasons))}); the log "
            f"is kept: {again}choose another folder, `drawbar report {self.log_file} --out FOLDER`"
        )


def write_report(folder: str | os.PathLike[str], log_file: str | os.PathLike[str] | None = None) -> Metrics:
    """Read the log in a run's folder, or another, and write metrics.json, report.html and map.svg into the folder.

    The folder is made where it is missing, once the log has been read.

    Returns the metrics. Works for a run that crashed or was killed.

    Raises:
        DrawbarError: the log cannot be read.
        StorageError: a file cannot be written; what was there before is still there.
    """
    folder = demand_path("folder", folder)
    report = make_report(demand_path("log_file", log_file or folder / LOG_NAME))
    report.write(folder)
    return report.metrics


def make_report(file: Path) -> Report:
    """Make the report of a log, also of a run that crashed or was killed.

    Raises:
        DrawbarError: the log cannot be read.
    """
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
    return Report(log_file=file, metrics=metrics, contents=dict(zip(REPORT_NAMES, contents, strict=True)))


def _write_whole(file: Path, content: bytes) -> None:
    """Write a file that is there as a whole or not at all."""
    part = file.with_name(file.name + ".part")
    try:
        part.write_bytes(content)
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)
