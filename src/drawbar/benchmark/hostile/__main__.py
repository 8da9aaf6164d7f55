"""Hostile problems, all classes tried with drawbar and its peers: `python -m drawbar.benchmark.hostile [PROBLEMS]`."""

import sys

from drawbar.benchmark.hostile.collection import CLASSES
from drawbar.benchmark.hostile.solvers import SOLVERS
from drawbar.benchmark.hostile.table import all_verdicts, hostile_table
from drawbar.terminal import Output

PROBLEMS = 20_000


def main() -> None:
    """Try about as many problems as the first argument says, the same number of each class."""
    problems = int(sys.argv[1]) if len(sys.argv) > 1 else PROBLEMS
    Output().print(hostile_table(all_verdicts(-(-problems // len(CLASSES)), list(SOLVERS))))


main()
