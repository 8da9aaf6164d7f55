"""Hostile problems, all classes tried with drawbar and its peers: `python -m drawbar.benchmark.hostile`."""

from argparse import ArgumentParser

from drawbar.benchmark.hostile.collection import CLASSES
from drawbar.benchmark.hostile.solvers import SOLVERS
from drawbar.benchmark.hostile.table import all_verdicts, hostile_table
from drawbar.terminal import Output

PROBLEMS = 20_000


def main() -> None:
    """Try the same number of problems of each class."""
    parser = ArgumentParser(prog="python -m drawbar.benchmark.hostile", description=main.__doc__)
    parser.add_argument("problems", type=int, nargs="?", default=PROBLEMS, help="about how many in all (20000)")
    parser.add_argument("--first", type=int, default=0, help="number of each class's first problem (0): others again")
    given = parser.parse_args()
    Output().print(hostile_table(all_verdicts(-(-given.problems // len(CLASSES)), list(SOLVERS), given.first)))


main()
