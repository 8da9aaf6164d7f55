"""Audit: who asked for what, one line of JSON each, added to a file; no password, cookie or number of a session."""

import json
import time
from pathlib import Path

from drawbar.console.visitors import Visitor


class Audit:
    """The audit log; a line that cannot be written is counted."""

    def __init__(self, path: Path | None) -> None:
        """Take the file; None: none is kept."""
        self._path = path
        self.lost = 0

    def write(self, visitor: Visitor | None, event: str, **details: object) -> None:
        """Add a line."""
        if self._path is None:
            return
        who = {"name": visitor.name, "rank": visitor.rank.name} if visitor is not None else {}
        line = {"time": time.strftime("%Y-%m-%dT%H:%M:%S%z"), "event": event} | who | details
        try:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(line, ensure_ascii=False) + "\n")
        except OSError:
            self.lost += 1
