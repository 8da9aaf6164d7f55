"""What a run leaves in its folder besides the log, all of it made from the log alone."""

from pathlib import Path

from drawbar.errors import DrawbarError
from drawbar.recording.log import read_log
from drawbar.report.metrics import Metrics, compute_metrics
from drawbar.report.page import render_page
from drawbar.report.path_errors import path_errors
from drawbar.report.picture import render_picture

LOG_NAME = "log.mcap"


def write_report(folder: Path) -> Metrics:
    """Read the log in a run's folder, write metrics.json, report.html and map.svg beside it.

    Returns the metrics. Works for a run that crashed or was killed. Raises DrawbarError when the log cannot
    be read or a file cannot be written.
    """
    log = read_log(folder / LOG_NAME)
    errors = path_errors(log)
    metrics = compute_metrics(log, errors)
    try:
        (folder / "metrics.json").write_bytes(metrics.to_json())
        (folder / "report.html").write_text(render_page(log, metrics, errors), encoding="utf-8")
        (folder / "map.svg").write_text(render_picture(log, errors), encoding="utf-8")
    except OSError as error:
        raise DrawbarError(
            f"{folder}: the report cannot be written ({error.strerror}); choose another folder"
        ) from error
    return metrics
