"""The table of all classes: how often each solver found the truth, how often it was wrong, how often it gave up."""

from collections import Counter
from collections.abc import Iterable, Sequence

from rich.console import Group, RenderableType
from rich.progress import track
from rich.text import Text

from drawbar.benchmark.hostile.collection import CLASSES, hostile_problems
from drawbar.benchmark.hostile.solvers import SOLVERS
from drawbar.benchmark.hostile.verdict import Verdict, judge
from drawbar.terminal import FittedTable

Verdicts = dict[str, Verdict]
"""by solver"""


def verdicts(name: str, count: int, solvers: Sequence[str], first: int = 0) -> list[Verdicts]:
    """Return what came of problems `first` to `first + count` of a class, by solver."""
    return [
        {solver: judge(truth, SOLVERS[solver](truth.problem)) for solver in solvers}
        for truth in hostile_problems(name, count, first)
    ]


def all_verdicts(count: int, solvers: Sequence[str], first: int = 0) -> dict[str, list[Verdicts]]:
    """Return the verdicts of problems `first` to `first + count` of every class, by class."""
    return {name: verdicts(name, count, solvers, first) for name in track(CLASSES, "hostile problems", transient=True)}


def share_of_peers(found: Iterable[Verdicts], solver: str) -> tuple[int, int]:
    """Return how many problems a peer found the truth of, and of how many of these the solver did too."""
    known = [one[solver].right for one in found if any(one[peer].right for peer in one if peer != solver)]
    return len(known), sum(known)


def hostile_table(found: dict[str, list[Verdicts]]) -> RenderableType:
    """Return the table: for each solver, wrongly solved / wrongly infeasible / given up."""
    solvers = list(next(iter(found.values()))[0])
    count = sum(map(len, found.values()))
    columns = [(name, "") for name in ("problems", *solvers, "solved\nby a peer", "of these\nby drawbar")]
    whole = {**found, "all": [row for rows in found.values() for row in rows]}
    shown = [(name, _cells(rows, solvers)) for name, rows in whole.items()]
    title = f"{count} hostile problems: wrong solved / wrong infeasible / given up"
    return Group(Text(title, "bold"), FittedTable("class", columns, shown, title_width=len("class"), column_width=4))


def _cells(rows: list[Verdicts], solvers: Sequence[str]) -> list[str]:
    known, shared = share_of_peers(rows, solvers[0])
    by_solver = []
    for solver in solvers:
        counts = Counter(row[solver] for row in rows)
        failures = (Verdict.WRONG_SOLVED, Verdict.WRONG_INFEASIBLE, Verdict.GIVEN_UP)
        by_solver.append(" / ".join(str(counts[verdict]) for verdict in failures))
    return [str(len(rows)), *by_solver, str(known), f"{shared / known:.2%}" if known else ""]
