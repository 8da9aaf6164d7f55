"""A run of a few seconds by the command line."""

from collections.abc import Callable

SHORT = ("--set", "path.radii=[5.0]", "--set", "path.straight_length=1.0")
FILES = {"config.toml", "log.mcap", "metrics.json", "report.html", "map.svg"}
"""what a run leaves in its folder"""

Drawbar = Callable[..., tuple[int, str]]
