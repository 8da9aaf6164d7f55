"""Elements of an experiment's report, handed over by its analysis: text, tables and pictures."""

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure

from drawbar.experiment.writing import writing
from drawbar.report import style

_LOOK: dict[Any, Any] = {
    "svg.fonttype": "none",  # text stays text: small files, the reader's fonts
    "svg.hashsalt": "drawbar",  # the same picture is the same file
    "font.family": "sans-serif",
    "font.size": 9.0,
    "text.color": style.INK,
    "axes.labelcolor": style.INK,
    "axes.edgecolor": style.REFERENCE,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "grid.color": style.GRID,
    "xtick.color": style.INK,
    "ytick.color": style.INK,
    "lines.linewidth": 1.1,
    "legend.frameon": False,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Text:
    """A paragraph, in Markdown."""

    text: str

    def write(self, _folder: Path) -> None:
        """Write nothing: the text stands in the report itself."""

    def markdown(self) -> str:
        """Return the paragraph."""
        return self.text


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Rows of cells under a header; also written as CSV."""

    name: str
    """of the CSV file, without its end"""
    caption: str
    """what the rows show, with the unit"""
    header: Sequence[str]
    rows: Sequence[Sequence[str]]

    def write(self, folder: Path) -> None:
        """Write the CSV file into the folder."""
        file = folder / f"{self.name}.csv"
        with writing(file), file.open("w", encoding="utf-8", newline="") as stream:
            csv.writer(stream, lineterminator="\n").writerows([self.header, *self.rows])

    def markdown(self) -> str:
        """Return caption and table."""
        return f"{self.caption} ([CSV]({self.name}.csv))\n\n{markdown_table(self.header, self.rows)}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """A figure drawn by matplotlib, written as SVG: the same bytes for the same data."""

    name: str
    """of the SVG file, without its end"""
    caption: str
    draw: Callable[[Figure], None]
    """fills an empty figure with axes"""
    size: tuple[float, float] = (8.0, 4.0)
    """width and height, inch"""

    def write(self, folder: Path) -> None:
        """Draw, and write the SVG file into the folder."""
        with rc_context(_LOOK):
            figure = Figure(figsize=self.size, layout="constrained")
            self.draw(figure)
            with writing(file := folder / f"{self.name}.svg"):
                figure.savefig(file, metadata={"Date": None, "Creator": None})

    def markdown(self) -> str:
        """Return the picture with its caption."""
        return f"![{self.caption}]({self.name}.svg)\n\n*{self.caption}*"


def markdown_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)


Element = Text | Table | Picture
