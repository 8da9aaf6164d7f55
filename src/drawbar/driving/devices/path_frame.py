"""Path frame: where on Earth the frame of a configuration's path lies."""

from pathlib import Path

from drawbar.config import Configuration
from drawbar.geometry import LocalFrame
from drawbar.guidance.importers.load import load_line
from drawbar.machine.hardware.devices import OriginSettings


def local_frame(configuration: Configuration) -> LocalFrame:
    """Return the frame of the path: its own where the file has one, else the one that `devices.origin` states.

    Raises:
        PathError: the line cannot be read.
    """
    settings = configuration.path
    frame = load_line(Path(settings.file), settings.track or None, settings.extension).frame if settings.file else None
    devices = configuration.devices
    return frame or (devices.origin if devices is not None else OriginSettings()).frame()
