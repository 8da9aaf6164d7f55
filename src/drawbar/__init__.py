"""drawbar: an autopilot that keeps a tractor and its trailer on the line."""

from importlib.metadata import version

__version__ = version("drawbar")
