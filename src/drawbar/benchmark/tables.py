"""The tables of `drawbar bench`: what the solvers cost, with and without bounds in the way, and beside their peers."""

from collections.abc import Iterable, Sequence
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from drawbar.terminal import FittedTable

Rows = Sequence[dict[str, Any]]


def solver_table(rows: Rows, stages: int) -> RenderableType:
    """Return the table of all problems at the base horizon."""
    shown = []
    for row in _at(rows, stages):
        total = row["total_us"]
        numbers = map(_number, (row["prepare_us"], row["feedback_us"], *total.values(), row["floor_us"]))
        shown.append((row["problem"], [*numbers, f"{row['ratio_to_floor']:.2f}"]))
    columns = ("prep.", "feedb.", "total", "mean", "99 %", "max", "floor", "ratio")
    return _table(f"one sample, N = {stages}, µs, medians unless said", "problem", columns, shown)


def bounds_table(rows: Rows, stages: int) -> RenderableType:
    """Return what a feedback costs with and without bounds active."""
    shown = []
    for row in _at(rows, stages):
        free, active = row["feedback_free_us"], row["feedback_active_us"]
        ratio = f"{active['median'] / free['median']:.1f}" if free and active else ""
        shown.append((row["problem"], [f"{row['bounded_share']:.0%}", *_three(free), *_three(active), ratio]))
    columns = ("steps\nactive", *(f"{state}\n{of}" for state in ("free", "active") for of in _THREE), "active\n/ free")
    return _table(f"feedback with no bound and with bounds active, N = {stages}, µs", "problem", columns, shown)


def growth_table(rows: Rows) -> RenderableType:
    """Return the medians over the horizon."""
    shown, horizons = [], sorted({row["stages"] for row in rows})
    for name in _longest(rows):
        own = [row for row in rows if row["problem"] == name]
        medians = [row["total_us"]["median"] for row in own]
        cells = (f"{row['total_us']['median']:.2f} ({row['bounded_share']:.0%})" for row in own)
        shown.append((name, [*cells, f"{medians[-1] / medians[0]:.1f}"]))
    title = "growth with the horizon, median total, µs; in brackets: steps with bounds active"
    return _table(title, "problem", _horizon_columns(horizons), shown)


def race_table(rows: Rows, stages: int) -> RenderableType:
    """Return drawbar's quadratic program beside its peers on the same stage problems, at the base horizon."""
    shown = []
    for row in _at(rows, stages):
        others = f"{row['other_answers']}/{row['problems']}"
        shown.append((_named(row), [*_three(row["free_us"]), *_three(row["active_us"]), others]))
    columns = (*(f"{state}\n{of}" for state in ("free", "active") for of in _THREE), "other\nanswers")
    return _table(f"one stage problem from its data to its solution, N = {stages}, µs", "problem", columns, shown)


def race_growth_table(rows: Rows) -> RenderableType:
    """Return the medians of drawbar and its peers over the horizon, of problems without a bound active."""
    shown, horizons = [], sorted({row["stages"] for row in rows})
    for name in _longest(rows):
        for solver in dict.fromkeys(row["solver"] for row in rows if row["problem"] == name):
            own = [row for row in rows if row["problem"] == name and row["solver"] == solver]
            if all(row["free_us"] for row in own):
                medians = [row["free_us"]["median"] for row in own]
                shown.append((_named(own[0]), [*map(_number, medians), f"{medians[-1] / medians[0]:.1f}"]))
    title = "the same over the horizon, medians of problems without a bound active, µs"
    return _table(title, "problem", _horizon_columns(horizons), shown)


def acados_table(rows: Rows, stages: int) -> RenderableType:
    """Return drawbar's iterations beside those of acados on the same problems, by acados' quadratic solver."""
    shown, own = [], dict[str, float]()
    for row in rows:
        times = row["total_us"]
        if row["solver"] == "drawbar":
            own = times
        ratios = [f"{times[of] / own[of]:.1f}" for of in ("median", "mean", "p99")]
        rest = (
            ["", ""] if row["solver"] == "drawbar" else [f"{row['largest_difference']:.0e}", f"{row['unsolved']:.0%}"]
        )
        shown.append((_named(row), [*_three(times), *ratios, *rest]))
    columns = (
        *(f"total\n{of}" for of in _THREE),
        *(f"ratio\n{of}" for of in _THREE),
        "largest\ndifference",
        "given\nup",
    )
    title = f"one iteration, preparation and feedback, N = {stages}, µs; ratio: times drawbar's"
    return _table(title, "problem", columns, shown)


_THREE = ("median", "mean", "99 %")


def _at(rows: Rows, stages: int) -> Iterable[dict[str, Any]]:
    return (row for row in rows if row["stages"] == stages)


def _longest(rows: Rows) -> list[str]:
    """Return the problems that were measured at the longest horizon."""
    longest = max((row["stages"] for row in rows), default=0)
    return list(dict.fromkeys(row["problem"] for row in _at(rows, longest)))


def _horizon_columns(horizons: Sequence[int]) -> list[str]:
    return [*(f"N = {stages}" for stages in horizons), f"{horizons[-1]} / {horizons[0]}" if horizons else ""]


def _named(row: dict[str, Any]) -> str:
    return str(row["problem"]) if row["solver"] == "drawbar" else f"  {row['solver']}"


def _three(figure: dict[str, float] | None) -> list[str]:
    return [_number(figure[of]) for of in ("median", "mean", "p99")] if figure else [""] * 3


def _number(value: float) -> str:
    return f"{value:.2f}" if value < 10.0 else f"{value:.0f}"


def _table(title: str, first: str, columns: Sequence[str], rows: list[tuple[str, list[str]]]) -> RenderableType:
    headings = [(name, "") for name in columns]
    return Group(Text(title, "bold"), FittedTable(first, headings, rows, title_width=len(first), column_width=4))
