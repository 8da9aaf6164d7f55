"""Published problems solved by drawbar and its peers: `python -m drawbar.benchmark.published [FOLDER]`."""

import sys
from pathlib import Path

from drawbar.benchmark.hostile.solvers import SOLVERS
from drawbar.benchmark.published.families import families
from drawbar.benchmark.published.files import problems_in
from drawbar.benchmark.published.results import compare, published_table
from drawbar.terminal import Output


def main() -> None:
    """Take the problems of a folder of .npz files, or the families from their definitions without one."""
    named = problems_in(Path(sys.argv[1])) if len(sys.argv) > 1 else families()
    Output().print(published_table([compare(each, list(SOLVERS)) for each in named]))


main()
